#include "core/io/fields_writer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

#include "core/io/glb_parts.h"
#include "core/io/half.h"

namespace relight {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are sent as they lie in memory");

using Floats = std::span<const float>;
using Codes = std::span<const Rgb8>;

constexpr std::array types{FieldType::Float32, FieldType::Float16, FieldType::UInt8};

/// Zeros or spaces up to the next multiple of 8.
constexpr std::uint64_t padded(std::uint64_t bytes)
{
    return (bytes + 7) / 8 * 8;
}

std::size_t size_of(FieldType type)
{
    switch (type) {
        case FieldType::Float32:
            return 4;
        case FieldType::Float16:
            return 2;
        case FieldType::UInt8:
            break;
    }
    return 1;
}

std::size_t numbers_of(const Field& field)
{
    const auto* codes = std::get_if<Codes>(&field.values);
    return codes != nullptr ? 3 * codes->size() : std::get<Floats>(field.values).size();
}

std::uint64_t bytes_of(const Field& field)
{
    return std::uint64_t{numbers_of(field)} * size_of(field.type);
}

std::string head_of(const Field& field, std::uint64_t offset)
{
    std::string json = R"({"name":)" + glb::quoted(field.name) + R"(,"type":")" +
                       std::string(name_of(field.type)) + R"(","components":)" +
                       std::to_string(field.components) + R"(,"offset":)" + std::to_string(offset) +
                       R"(,"bytes":)" + std::to_string(bytes_of(field)) + R"(,"unit":)" +
                       glb::quoted(field.unit);
    if (field.type == FieldType::Float16) {
        json += R"(,"clamped":)" + std::to_string(beyond_half(std::get<Floats>(field.values)));
    }
    return json + '}';
}

template <class T>
std::string_view as_bytes(std::span<const T> values)
{
    return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

/// round(255 x) of shares: in double, where 255 x is exact.
void to_codes(Floats shares, char* out)
{
    for (const float share : shares) {
        const double x = share > 0.0F ? std::min(static_cast<double>(share), 1.0) : 0.0;
        const double half_up = 255.0 * x + 0.5;
        *out++ = static_cast<char>(static_cast<unsigned char>(half_up));
    }
}

void write_field(BlockOut& out, const Field& field)
{
    if (const auto* codes = std::get_if<Codes>(&field.values)) {
        return out.bytes(as_bytes(*codes));
    }
    Floats values = std::get<Floats>(field.values);
    if (field.type == FieldType::Float32) { return out.bytes(as_bytes(values)); }
    constexpr std::size_t block = 4096;
    for (; !values.empty() && out.open(); values = values.subspan(std::min(block, values.size()))) {
        const Floats some = values.first(std::min(block, values.size()));
        char* const room = out.room(some.size() * size_of(field.type));
        if (field.type == FieldType::Float16) {
            to_half(some, reinterpret_cast<std::uint16_t*>(room));
        } else {
            to_codes(some, room);
        }
    }
}

}  // namespace

std::string_view name_of(FieldType type)
{
    switch (type) {
        case FieldType::Float32:
            return "float32";
        case FieldType::Float16:
            return "float16";
        case FieldType::UInt8:
            break;
    }
    return "uint8";
}

std::optional<FieldType> field_type(std::string_view name)
{
    const auto* const it = std::find_if(types.begin(), types.end(),
                                        [&](FieldType type) { return name_of(type) == name; });
    return it == types.end() ? std::nullopt : std::optional(*it);
}

Encoding encode_fields(std::size_t vertices, std::vector<Field> fields, std::string_view more)
{
    std::string head = R"({"vertices":)" + std::to_string(vertices) + R"(,"fields":[)";
    std::uint64_t arrays = 0;
    for (const Field& field : fields) {
        assert(numbers_of(field) == vertices * static_cast<std::size_t>(field.components));
        assert(std::holds_alternative<Floats>(field.values) || field.type == FieldType::UInt8);
        if (&field != &fields.front()) { head += ','; }
        head += head_of(field, arrays);
        arrays += padded(bytes_of(field));
    }
    head += ']';
    if (!more.empty()) { head.append(",").append(more); }
    head += R"(,"bytes_total":)";
    // The total counts its own digits: room for the most that there can be.
    constexpr std::size_t digits = 20;
    const std::uint64_t begin = padded(4 + head.size() + digits + 1);
    const std::uint64_t total = begin + arrays;
    head += std::to_string(total) + '}';
    head.resize(begin - 4, ' ');

    return {total, [head = std::move(head), fields = std::move(fields)](const Sink& sink) {
                BlockOut out(sink);
                out.number(static_cast<std::uint32_t>(head.size()));
                out.bytes(head);
                for (const Field& field : fields) {
                    write_field(out, field);
                    const std::uint64_t bytes = bytes_of(field);
                    out.bytes(std::string(padded(bytes) - bytes, '\0'));
                }
                return out.flush();
            }};
}

}  // namespace relight
