#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/io/glb_parts.h"

namespace relight::glb {

/// The file's JSON and its buffer, laid out before a byte of the buffer is written.
class Plan {
  public:
    /// An accessor with a view of its own. `fill` writes its count * components numbers; `more` is
    /// the rest of its JSON. Returns its index.
    std::size_t add(Target target, ComponentType type, int components, std::size_t count,
                    std::function<void(char*)> fill, const std::string& more = {})
    {
        const std::uint64_t bytes =
            count * static_cast<std::uint64_t>(components) * (type == u16 ? 2 : 4);
        if (!blocks_.empty()) {
            views_ += ',';
            accessors_ += ',';
        }
        views_ += R"({"buffer":0,"byteOffset":)" + std::to_string(size_) + R"(,"byteLength":)" +
                  std::to_string(bytes) + R"(,"target":)" + std::to_string(target) + '}';
        accessors_ += R"({"bufferView":)" + std::to_string(blocks_.size()) +
                      R"(,"componentType":)" + std::to_string(type) + R"(,"count":)" +
                      std::to_string(count) + R"(,"type":")" + std::string(type_name(components)) +
                      '"' + more + '}';
        const std::uint64_t padded = (bytes + 3) / 4 * 4;
        size_ += padded;
        blocks_.push_back({padded, std::move(fill)});
        return blocks_.size() - 1;
    }

    /// The GLB with this JSON beside the buffer's; empty if it would be too large for one.
    std::string written(const std::string& json) const
    {
        std::string out =
            begun(json + R"(,"accessors":[)" + accessors_ + R"(],"bufferViews":[)" + views_ +
                      R"(],"buffers":[{"byteLength":)" + std::to_string(size_) + "}]}",
                  size_);
        if (out.empty()) { return out; }
        for (const Block& block : blocks_) {
            const std::size_t at = out.size();
            out.resize(at + block.bytes);  // zero: the padding
            block.fill(out.data() + at);
        }
        return out;
    }

  private:
    struct Block {
        std::uint64_t bytes;
        std::function<void(char*)> fill;
    };
    std::string views_, accessors_;
    std::vector<Block> blocks_;
    std::uint64_t size_ = 0;
};

/// A `fill` of value(i), an array of numbers each.
template <class Value>
std::function<void(char*)> each(std::size_t count, Value value)
{
    return [count, value = std::move(value)](char* out) {
        for (std::size_t i = 0; i < count; ++i) {
            const auto numbers = value(i);
            std::memcpy(out, &numbers, sizeof(numbers));
            out += sizeof(numbers);
        }
    };
}

}  // namespace relight::glb
