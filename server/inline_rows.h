#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/json_tree.h"

namespace relight {

/// The arrays of a mesh that go past the tree.
enum class Bulk { None, Positions, Faces, Normals, Colors };
Bulk bulk_named(std::string_view name);

/// Rows of three numbers, straight into their array. Errors carry the place within it.
class InlineRows {
  public:
    InlineRows(InlineArrays& arrays, std::uint64_t max_vertices, std::uint64_t max_faces)
        : arrays_(arrays), max_vertices_(max_vertices), max_faces_(max_faces)
    {
    }

    void open(Bulk kind)
    {
        kind_ = kind;
        in_row_ = false;
        row_ = 0;
    }
    bool is_open() const { return kind_ != Bulk::None; }
    std::string place() const
    {
        return pointer_step(row_) + (in_row_ ? pointer_step(column_) : "");
    }

    std::optional<Error> begin_row();
    std::optional<Error> number(double x);
    std::optional<Error> end();  ///< of the row, or of the whole array when no row is open
    Error wrong_type(std::string_view found) const;

  private:
    Error wrong_length(const std::string& found) const;
    std::optional<Error> check(double x) const;
    std::optional<Error> store();

    InlineArrays& arrays_;
    std::uint64_t max_vertices_, max_faces_;
    Bulk kind_ = Bulk::None;
    bool in_row_ = false;
    std::size_t row_ = 0, column_ = 0;
    std::array<double, 3> values_{};
};

}  // namespace relight
