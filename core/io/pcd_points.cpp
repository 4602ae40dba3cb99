#include "core/io/pcd_points.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/io/left_out.h"
#include "core/io/text_scanner.h"

namespace relight::pcd {
namespace {

static_assert(std::endian::native == std::endian::little, "bodies are read by memcpy");

constexpr std::array<std::array<std::string_view, 3>, 7> taken_names = {
    {{"x"},
     {"y"},
     {"z"},
     {"normal_x", "nx", "normalx"},
     {"normal_y", "ny", "normaly"},
     {"normal_z", "nz", "normalz"},
     {"rgb", "rgba"}}};

std::size_t slot_named(std::string_view name)
{
    std::string lower(name);
    std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    std::size_t slot = 0;
    while (slot < taken_names.size() &&
           std::find(taken_names[slot].begin(), taken_names[slot].end(), lower) ==
               taken_names[slot].end()) {
        ++slot;
    }
    return slot;
}

Error cancelled()
{
    return {Fault::Cancelled, "reading was stopped", {}, {}, {}};
}

/// Calls f with a zero of the C++ type of a field.
template <class F>
void with_type(const Field& field, F&& f)
{
    const std::size_t size = field.size;
    if (field.type == 'F') { return size == 4 ? f(float{}) : f(double{}); }
    if (field.type == 'U') {
        return size == 1   ? f(std::uint8_t{})
               : size == 2 ? f(std::uint16_t{})
               : size == 4 ? f(std::uint32_t{})
                           : f(std::uint64_t{});
    }
    return size == 1   ? f(std::int8_t{})
           : size == 2 ? f(std::int16_t{})
           : size == 4 ? f(std::int32_t{})
                       : f(std::int64_t{});
}

template <class T>
T load(const std::byte* at)
{
    T value;
    std::memcpy(&value, at, sizeof(T));
    return value;
}

constexpr double Point3::*axes[] = {&Point3::x, &Point3::y, &Point3::z};
constexpr double Vec3::*parts[] = {&Vec3::x, &Vec3::y, &Vec3::z};

/// A number of a text body; nothing if it is none.
std::optional<double> real(std::string_view word)
{
    using Limits = std::numeric_limits<double>;
    const Number<double> number = parse_real(word);
    switch (number.kind) {
        case NumberKind::Ok:
            return number.value;
        case NumberKind::Malformed:
            return {};
        case NumberKind::OutOfRange:
            return Limits::max();
        case NumberKind::NonFinite:
            break;
    }
    return says_nan(word) ? Limits::quiet_NaN() : Limits::infinity();
}

}  // namespace

Result<Taken> take(const Header& header, std::vector<std::string>& notes)
{
    Taken taken{};
    LeftOut left_out;
    for (const Field& field : header.fields) {
        const std::size_t slot = slot_named(field.name);
        const bool ours = slot < taken.size() && field.count == 1 &&
                          (slot != color_slot || field.size == 4);  // colours are packed
        if (ours && taken[slot] != nullptr) {
            return Error{Fault::MalformedHeader,
                         "FIELDS: " + shown(taken[slot]->name) + " and " + shown(field.name) +
                             " say the same",
                         {},
                         header.body_line - 1,
                         {}};
        }
        if (ours) { taken[slot] = &field; }
        if (!ours && field.name != "_") {  // padding has that name
            left_out.add(field.name);
        }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (taken[axis] == nullptr) {
            return Error{Fault::MalformedHeader,
                         std::string("FIELDS: no ") + "xyz"[axis] + " of COUNT 1",
                         {},
                         header.body_line - 1,
                         {}};
        }
    }
    if (taken[3] == nullptr || taken[4] == nullptr || taken[5] == nullptr) {
        std::fill_n(taken.begin() + normal_slot, 3, nullptr);
    }
    if (left_out.any()) { notes.push_back("fields left out: " + left_out.names()); }
    return taken;
}

std::optional<Error> read_bytes(std::span<const std::byte> body, std::size_t byte, bool by_field,
                                const Header& header, const Taken& taken, Points& points,
                                Progress& progress)
{
    constexpr std::size_t block = 1024;  // points, whose columns stay in the cache
    const auto fill = [&](const Field& field, std::size_t first, std::size_t n, const auto& put) {
        const std::byte* const at = body.data() + field.offset * (by_field ? header.points : 1);
        const std::size_t step = by_field ? field.size * field.count : header.stride;
        with_type(field, [&](auto zero) {
            for (std::size_t i = first; i < first + n; ++i) {
                put(i, load<decltype(zero)>(at + i * step));
            }
        });
    };
    Mesh& mesh = points.mesh;
    points.reserve(header.points);
    for (std::size_t first = 0; first < header.points; first += block) {
        if (progress.stopped()) { return cancelled(); }
        const std::size_t n = std::min<std::size_t>(block, header.points - first);
        points.resize(first + n);
        for (std::size_t k = 0; k < 3; ++k) {
            fill(*taken[k], first, n, [&](std::size_t i, auto value) {
                mesh.positions[i].*axes[k] = static_cast<double>(value);
            });
            if (!points.normals) { continue; }
            fill(*taken[normal_slot + k], first, n, [&](std::size_t i, auto value) {
                mesh.normals[i].*parts[k] = static_cast<double>(value);
            });
        }
        if (points.colors) {
            Field bits = *taken[color_slot];
            bits.type = 'U';
            fill(bits, first, n, [&](std::size_t i, auto value) {
                mesh.colors[i] = points.color(static_cast<std::uint32_t>(value));
            });
        }
        for (std::size_t i = first; i < first + n; ++i) {
            if (std::optional<Error> failure = points.check(i)) {
                failure->byte = by_field ? byte : byte + i * header.stride;
                return failure;
            }
        }
    }
    return {};
}

std::optional<Error> read_text(std::span<const std::byte> file, const Header& header,
                               const Taken& taken, Points& points, Progress& progress)
{
    constexpr std::size_t block = 65'536;  // points between two looks at Progress
    constexpr unsigned char none = 255;
    std::vector<unsigned char> slots(header.columns, none);
    for (std::size_t slot = 0; slot < taken.size(); ++slot) {
        if (taken[slot] != nullptr) {
            slots[taken[slot]->column] = static_cast<unsigned char>(slot);
        }
    }
    const bool float_colors = points.colors && taken[color_slot]->type == 'F';
    Mesh& mesh = points.mesh;
    points.resize(header.points);
    TextScanner scanner(file, header.body, header.body_line);
    for (std::size_t i = 0; i < header.points; ++i, scanner.next_line()) {
        if (i % block == 0 && progress.stopped()) { return cancelled(); }
        while (scanner.at_line_end() && !scanner.at_end()) { scanner.next_line(); }
        if (scanner.at_end()) {
            return scanner.error(Fault::Truncated, "the file ends after " + std::to_string(i) +
                                                       " of " + std::to_string(header.points) +
                                                       " points");
        }
        for (std::size_t column = 0; column < header.columns; ++column) {
            const std::string_view word = scanner.word();
            if (word.empty()) {
                return scanner.error(Fault::MalformedBody, "a point of " + std::to_string(column) +
                                                               " numbers; the header announces " +
                                                               std::to_string(header.columns) +
                                                               ", all on one line");
            }
            const std::size_t slot = slots[column];
            if (slot == none) { continue; }
            if (slot == color_slot && !float_colors) {
                const Number<std::int64_t> packed = parse_integer(word);
                if (!packed || packed.value < INT32_MIN || packed.value > UINT32_MAX) {
                    return scanner.error(Fault::MalformedBody,
                                         shown(word) + " is no colour packed into 32 bits");
                }
                mesh.colors[i] = points.color(static_cast<std::uint32_t>(packed.value));
                continue;
            }
            const std::optional<double> value = real(word);
            if (!value) {
                return scanner.error(Fault::MalformedBody, shown(word) + " is no number");
            }
            if (slot ==
                color_slot) {  // the bits of a float, which are lost if it is written as nan
                const bool lost = !(std::abs(*value) <= std::numeric_limits<float>::max());
                if (lost) { ++points.non_finite; }
                const float packed = lost ? 0.0F : static_cast<float>(*value);
                mesh.colors[i] = points.color(std::bit_cast<std::uint32_t>(packed));
            } else if (slot < normal_slot) {
                mesh.positions[i].*axes[slot] = *value;
            } else {
                mesh.normals[i].*parts[slot - normal_slot] = *value;
            }
        }
        if (!scanner.at_line_end()) {
            return scanner.error(Fault::MalformedBody,
                                 "more numbers than the " + std::to_string(header.columns) +
                                     " of a point; each needs a line of its own");
        }
        if (std::optional<Error> failure = points.check(i)) {
            failure->line = scanner.line();
            return failure;
        }
    }
    if (!scanner.word_on_any_line().empty()) {
        return scanner.error(
            Fault::MalformedBody,
            "more lines than the " + std::to_string(header.points) + " points of the header");
    }
    return {};
}

}  // namespace relight::pcd
