#include "server/inline_rows.h"

#include <cmath>
#include <limits>

#include "core/geometry/mesh.h"
#include "server/json_text.h"

namespace relight {

Bulk bulk_named(std::string_view name)
{
    if (name == "positions") { return Bulk::Positions; }
    if (name == "faces") { return Bulk::Faces; }
    if (name == "normals") { return Bulk::Normals; }
    if (name == "colors") { return Bulk::Colors; }
    return Bulk::None;
}

std::optional<Error> InlineRows::begin_row()
{
    if (in_row_) {
        return make_error(Fault::WrongType, "found an array; a number belongs here", place());
    }
    in_row_ = true;
    column_ = 0;
    return {};
}

std::optional<Error> InlineRows::number(double x)
{
    if (!in_row_) {
        return make_error(
            Fault::WrongType,
            "found " + decimal(x) + "; each row is an array of 3 numbers: [[x,y,z], …]", place());
    }
    if (column_ >= 3) { return wrong_length("more than 3"); }
    if (auto error = check(x)) { return error; }
    values_[column_++] = x;
    return {};
}

std::optional<Error> InlineRows::end()
{
    if (!in_row_) {
        kind_ = Bulk::None;
        return {};
    }
    if (column_ != 3) { return wrong_length(std::to_string(column_)); }
    in_row_ = false;
    if (auto error = store()) { return error; }
    ++row_;
    return {};
}

Error InlineRows::wrong_type(std::string_view found) const
{
    return make_error(
        Fault::WrongType,
        "found " + std::string(found) +
            (in_row_ ? "; a number belongs here" : "; each row is an array of 3 numbers"),
        place());
}

Error InlineRows::wrong_length(const std::string& found) const
{
    const std::string what = kind_ == Bulk::Faces
                                 ? " corners; inline faces are triangles of 3 indices"
                                 : " numbers; a row has exactly 3";
    return make_error(Fault::WrongLength, "found " + found + what, pointer_step(row_));
}

std::optional<Error> InlineRows::check(double x) const
{
    switch (kind_) {
        case Bulk::Positions:
            if (std::abs(x) > largest_coordinate) {
                return make_error(
                    Fault::CoordinateTooLarge,
                    "found " + decimal(x) + "; coordinates lie within ±1e15 length units", place());
            }
            break;
        case Bulk::Faces:
            if (x != std::floor(x)) {
                return make_error(Fault::WrongType,
                                  "found " + decimal(x) +
                                      "; a face holds whole numbers, the indices of "
                                      "its vertices from 0",
                                  place());
            }
            if (x < 0 || x >= std::numeric_limits<std::uint32_t>::max()) {
                return make_error(Fault::IndexOutOfRange,
                                  "found " + decimal(x) + "; indices count the positions from 0",
                                  place());
            }
            break;
        case Bulk::Colors:
            if (x < 0 || x > 1) {
                return make_error(Fault::OutOfRange,
                                  "found " + decimal(x) + "; colours are linear Rec.709 in 0..1",
                                  place());
            }
            break;
        case Bulk::Normals:
        case Bulk::None:
            break;
    }
    return {};
}

std::optional<Error> InlineRows::store()
{
    const auto [x, y, z] = values_;
    switch (kind_) {
        case Bulk::Positions:
            if (row_ >= max_vertices_) {
                return make_error(Fault::TooManyVertices, "more than " +
                                                              std::to_string(max_vertices_) +
                                                              " vertices (limit --max-vertices)");
            }
            arrays_.positions.push_back({x, y, z});
            break;
        case Bulk::Faces:
            if (row_ >= max_faces_) {
                return make_error(Fault::TooManyFaces, "more than " + std::to_string(max_faces_) +
                                                           " faces (limit --max-faces)");
            }
            for (const double index : values_) {
                arrays_.faces.push_back(static_cast<std::uint32_t>(index));
            }
            break;
        case Bulk::Normals:
            if (!normalize({x, y, z})) {
                return make_error(Fault::ZeroDirection,
                                  "found [0,0,0]; a normal needs a length (it need not be 1)",
                                  pointer_step(row_));
            }
            arrays_.normals.push_back({x, y, z});
            break;
        case Bulk::Colors:
            arrays_.colors.push_back(to_float(Rgb{x, y, z}));
            break;
        case Bulk::None:
            break;
    }
    return {};
}

}  // namespace relight
