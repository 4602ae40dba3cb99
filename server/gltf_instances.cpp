#include "server/gltf_instances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace relight::gltf_answer {
namespace {

constexpr std::string_view ask_otherwise =
    "; ask for another format (\"ply\", \"vtp\", \"npz\"), or send the file with its instances as "
    "nodes";

std::string base64_decoded(std::string_view uri)
{
    const std::size_t comma = uri.find(',');
    if (!uri.starts_with("data:") || comma == std::string_view::npos) { throw Mismatch{}; }
    constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<std::uint8_t, 256> value{};
    for (std::size_t i = 0; i < digits.size(); ++i) {
        value[static_cast<unsigned char>(digits[i])] = static_cast<std::uint8_t>(i);
    }
    std::string bytes;
    std::uint32_t bits = 0;
    unsigned held = 0;
    for (const char c : uri.substr(comma + 1)) {
        if (c == '=') { break; }
        bits = bits << 6U | value[static_cast<unsigned char>(c)];
        held += 6;
        if (held >= 8) {
            held -= 8;
            bytes += static_cast<char>(bits >> held & 0xFFU);
        }
    }
    return bytes;
}

/// Component types that instances may have.
enum : std::uint64_t { i8 = 5120, i16 = 5122, f32 = 5126 };

std::size_t size_of(std::uint64_t type)
{
    switch (type) {
        case i8:
            return 1;
        case i16:
            return 2;
        case f32:
            return 4;
        default:
            throw Mismatch{};
    }
}

template <class T>
T load(const char* at)
{
    T number{};
    std::memcpy(&number, at, sizeof(number));
    return number;
}

/// A number as filed; integers are normalized: n / (2^(bits - 1) - 1), at least -1.
double component(std::uint64_t type, const char* at)
{
    if (type == i8) { return std::max(load<std::int8_t>(at) / 127.0, -1.0); }
    if (type == i16) { return std::max(load<std::int16_t>(at) / 32767.0, -1.0); }
    const double number = static_cast<double>(load<float>(at));
    if (!std::isfinite(number)) { throw Mismatch{}; }
    return number;
}

}  // namespace

std::uint64_t whole(const Json& number)
{
    constexpr std::uint64_t largest = 1ULL << 53U;  // of doubles; sums of a few never run over
    if (number.is_number_unsigned()) {
        const auto value = number.get<std::uint64_t>();
        return value <= largest ? value : throw Mismatch{};
    }
    if (!number.is_number_float()) { throw Mismatch{}; }
    const auto value = number.get<double>();
    if (!(value >= 0.0 && value <= static_cast<double>(largest)) || std::floor(value) != value) {
        throw Mismatch{};
    }
    return static_cast<std::uint64_t>(value);
}

const Json& element(const Json& root, std::string_view key, std::uint64_t index)
{
    return root.at(std::string(key)).at(index);
}

std::string_view InstanceReader::buffer(std::uint64_t index)
{
    const Json& json = element(root_, "buffers", index);
    const auto uri = json.find("uri");
    if (uri == json.end()) { return index == 0 ? binary_ : std::string_view(); }
    const auto [at, is_new] = decoded_.try_emplace(index);
    if (is_new) { at->second = base64_decoded(uri->get_ref<const std::string&>()); }
    return at->second;
}

std::vector<double> InstanceReader::rows(std::uint64_t accessor, std::size_t components,
                                         std::size_t count)
{
    const Json& json = element(root_, "accessors", accessor);
    if (json.contains("sparse")) {
        throw Declined{"the transforms of the file's instances are a sparse accessor" +
                       std::string(ask_otherwise)};
    }
    if (whole(json.at("count")) != count ||
        json.at("type").get_ref<const std::string&>() != "VEC" + std::to_string(components)) {
        throw Mismatch{};
    }
    std::vector<double> numbers(components * count);
    if (!json.contains("bufferView")) { return numbers; }  // zeros, by the specification
    const Json& view = element(root_, "bufferViews", whole(json["bufferView"]));
    if (view.contains("extensions")) {
        throw Declined{"the transforms of the file's instances are compressed" +
                       std::string(ask_otherwise)};
    }
    const std::uint64_t type = whole(json.at("componentType"));
    const std::size_t size = size_of(type);
    const std::size_t stride =
        view.contains("byteStride") ? whole(view["byteStride"]) : size * components;
    const std::string_view bytes = buffer(whole(view.at("buffer")));
    const std::uint64_t first = (view.contains("byteOffset") ? whole(view["byteOffset"]) : 0) +
                                (json.contains("byteOffset") ? whole(json["byteOffset"]) : 0);
    constexpr std::uint64_t longest_stride = 252;  // and no sum below runs over
    if (stride > longest_stride || first > bytes.size()) { throw Mismatch{}; }
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const std::size_t at = first + i / components * stride + i % components * size;
        if (at + size > bytes.size()) { throw Mismatch{}; }
        numbers[i] = component(type, bytes.data() + at);
    }
    return numbers;
}

std::vector<Json> InstanceReader::nodes(const Json& extension, std::size_t count)
{
    std::vector<Json> nodes(count, Json::object());
    const Json& attributes = extension.at("attributes");
    struct Part {
        const char *attribute, *member;
        std::size_t components;
    };
    for (const Part& part : {Part{"TRANSLATION", "translation", 3}, Part{"ROTATION", "rotation", 4},
                             Part{"SCALE", "scale", 3}}) {
        const auto accessor = attributes.find(part.attribute);
        if (accessor == attributes.end()) { continue; }
        const std::vector<double> all = rows(whole(*accessor), part.components, count);
        for (std::size_t i = 0; i < count; ++i) {
            const auto begin = all.begin() + static_cast<std::ptrdiff_t>(part.components * i);
            std::vector<double> row(begin, begin + static_cast<std::ptrdiff_t>(part.components));
            if (part.components == 4) {  // nodes want unit quaternions: integers are nearly that
                const double norm =
                    std::hypot(std::hypot(row[0], row[1]), std::hypot(row[2], row[3]));
                if (!(norm > 0.0)) { continue; }
                for (double& x : row) { x /= norm; }
            }
            nodes[i][part.member] = row;
        }
    }
    return nodes;
}

}  // namespace relight::gltf_answer
