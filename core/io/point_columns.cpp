#include "core/io/point_columns.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/io/left_out.h"
#include "core/io/srgb_codes.h"
#include "core/io/text_scanner.h"

namespace relight {
namespace {

constexpr std::size_t slots = 9;
constexpr std::array<std::array<std::string_view, 3>, slots> known = {
    {{"x"},
     {"y"},
     {"z"},
     {"r", "red"},
     {"g", "green"},
     {"b", "blue"},
     {"nx", "normal_x", "normalx"},
     {"ny", "normal_y", "normaly"},
     {"nz", "normal_z", "normalz"}}};

constexpr std::string_view example =
    "a line of names before the rows, such as x y z r g b nx ny nz";

Error refused(Fault fault, std::string detail)
{
    return {fault, std::move(detail), {}, {}, {}};
}

std::size_t slot_named(std::string_view name)
{
    std::string plain;
    for (const char c : name) {
        if (c != '"') { plain += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
    }
    for (std::size_t slot = 0; slot < slots; ++slot) {
        const auto& names = known[slot];
        if (!plain.empty() && std::find(names.begin(), names.end(), plain) != names.end()) {
            return slot;
        }
    }
    return Columns::anything;
}

}  // namespace

void Triple::add(Vec3 row, std::uint64_t line)
{
    rows_.push_back(row);
    for (const double v : {row.x, row.y, row.z}) {
        const bool whole = v >= 0.0 && v == std::floor(v);
        whole_ = whole_ && whole;
        if (!first_no_share_ && !(v >= 0.0 && v <= 1.0)) { first_no_share_ = line; }
        if (!first_no_code_ && !(whole && v <= 255.0)) { first_no_code_ = line; }
    }
    if (!unit_or_zero_ || row == Vec3{}) { return; }
    constexpr double rounded = 0.01;  // normals of two digits are that far off
    unit_or_zero_ = std::abs(length(row) - 1.0) <= rounded;
    some_ = true;
}

std::optional<Error> Triple::give_to(Mesh& mesh)
{
    if (kind == TripleKind::Normal) {
        mesh.normals = std::move(rows_);
        return {};
    }
    if (kind != TripleKind::Color) { return {}; }
    if (!is_linear() && !is_codes()) {
        Error error =
            refused(Fault::MalformedBody,
                    "colours must all be whole numbers 0 to 255 (sRGB) or all be within 0 "
                    "to 1 (linear); with this row they are neither");
        error.line = std::max(*first_no_share_, *first_no_code_);
        return error;
    }
    const std::vector<float> table = decoded_srgb(255);
    const auto value = [&](double v) {
        return is_linear() ? static_cast<float>(v) : table[static_cast<std::size_t>(v)];
    };
    mesh.colors.reserve(rows_.size());
    for (const Vec3& row : rows_) {
        mesh.colors.push_back({value(row.x), value(row.y), value(row.z)});
    }
    return {};
}

Result<Columns> columns_named(std::span<const std::string_view> names)
{
    Columns columns;
    std::array<bool, slots> found{};
    LeftOut left_out;
    for (const std::string_view name : names) {
        const std::size_t slot = slot_named(name);
        columns.slots.push_back(slot);
        if (slot == Columns::anything) {
            left_out.add(name);
            continue;
        }
        if (found[slot]) {
            return refused(Fault::MalformedHeader, "two columns have the name " + shown(name));
        }
        found[slot] = true;
    }
    const auto all = [&](std::size_t slot) {
        return found[slot] && found[slot + 1] && found[slot + 2];
    };
    if (!all(0)) {
        return refused(
            Fault::MalformedHeader,
            "the line begins with " + shown(names.front()) +
                ", so it is neither a row of numbers nor a line of names with x, y and z");
    }
    if (all(3)) { columns.first = TripleKind::Color; }
    if (all(6)) { columns.second = TripleKind::Normal; }
    for (std::size_t& slot : columns.slots) {
        if (slot < slots && !all(slot / 3 * 3)) {
            left_out.add(known[slot][0]);
            slot = Columns::anything;
        }
    }
    if (left_out.any()) { columns.notes.push_back("columns left out: " + left_out.names()); }
    return columns;
}

Result<Columns> columns_numbered(std::size_t count)
{
    constexpr std::size_t number = Columns::number;
    using enum TripleKind;
    switch (count) {
        case 3:
            return Columns{{0, 1, 2}, Unused, Unused, {}};
        case 4:
            return Columns{{0, 1, 2, number}, Unused, Unused, {"intensity left out (column 4)"}};
        case 6:
            return Columns{{0, 1, 2, 3, 4, 5}, Either, Unused, {}};
        case 7:
            return Columns{
                {0, 1, 2, number, 3, 4, 5}, Color, Unused, {"intensity left out (column 4)"}};
        case 9:
            return Columns{{0, 1, 2, 3, 4, 5, 6, 7, 8}, Either, Either, {}};
        default:
            break;
    }
    return refused(
        Fault::MalformedBody,
        "rows of " + std::to_string(count) +
            " numbers; without names there may be 3 (x y z), 4 (and intensity), 6 (x y z "
            "and r g b or nx ny nz), 7 (x y z intensity r g b) or 9 (x y z and both "
            "triples); for others put " +
            std::string(example));
}

std::optional<Error> tell_apart(Triple& first, Triple& second)
{
    using enum TripleKind;
    if (first.kind != Either) { return {}; }
    if (second.kind != Either) {
        // Whole numbers beyond 255 are meant as colours, and will be refused as such.
        const bool color = first.is_linear() || first.is_whole();
        first.kind = first.is_unit() || !color ? Normal : Color;
        return {};
    }
    if (first.is_unit() == second.is_unit()) {
        return refused(Fault::MalformedBody,
                       std::string(first.is_unit() ? "both" : "none") +
                           " of the triples after x y z consist of unit vectors, so normals and "
                           "colours cannot be told apart; put " +
                           std::string(example));
    }
    first.kind = first.is_unit() ? Normal : Color;
    second.kind = first.is_unit() ? Color : Normal;
    return {};
}

}  // namespace relight
