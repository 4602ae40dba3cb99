#pragma once

#include <cstddef>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace relight::test {

inline std::string contents(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// What `check`, which reads bytes and says what is wrong with the answer, first says of
/// every truncation (or some 500 of a long text) and `count` random mutations of `text`: flipped,
/// removed, doubled and replaced bytes, numbers made extreme.
template <class Check>
std::string broken_promise_of_mutants(const Check& check, const std::string& text, int count,
                                      unsigned seed)
{
    for (std::size_t size = 0; size < text.size(); size += 1 + text.size() / 500) {
        // A copy of just that size, so that a sanitizer sees the first byte read beyond it.
        const std::vector<char> cut(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(size));
        const std::string broken = check(std::string_view(cut.data(), cut.size()));
        if (!broken.empty()) { return broken + " when cut to " + std::to_string(size); }
    }
    constexpr std::string_view words[] = {"4294967295", "-1",
                                          "0",          "99999999999999999999",
                                          "nan",        "1e999",
                                          "1e-999",     "\n",
                                          "\\\n",       "#",
                                          "/",          "2147483648",
                                          "\r",         "1e-9223372036854775808"};
    std::mt19937 random(seed);
    const auto below = [&](std::size_t n) { return random() % n; };
    for (int i = 0; i < count; ++i) {
        std::string mutant = text;
        for (std::size_t edits = 1 + below(4); edits > 0 && !mutant.empty(); --edits) {
            const std::size_t at = below(mutant.size());
            switch (below(5)) {
                case 0:
                    mutant[at] = static_cast<char>(random());
                    break;
                case 1:
                    mutant.erase(at, 1 + below(16));
                    break;
                case 2:
                    mutant.insert(at, mutant.substr(below(mutant.size()), 1 + below(32)));
                    break;
                case 3:
                    mutant[at] = static_cast<char>(mutant[at] ^ (1 << below(8)));
                    break;
                default:
                    mutant.insert(at, words[below(std::size(words))]);
                    break;
            }
        }
        std::string broken = check(std::string_view(mutant));
        if (!broken.empty()) {
            broken += " in mutant " + std::to_string(i) + ":\n" + mutant;
            return broken;
        }
    }
    return {};
}

}  // namespace relight::test
