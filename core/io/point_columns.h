#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/mesh.h"

namespace relight {

enum class TripleKind { Unused, Color, Normal, Either };

/// Three columns beside x y z, kept as numbers until the whole file has shown what they are.
class Triple {
  public:
    TripleKind kind = TripleKind::Unused;

    void add(Vec3 row, std::uint64_t line);

    /// Every row is of length 1 within a hundredth, or zero as for a point without a normal; not
    /// all are zero.
    bool is_unit() const { return unit_or_zero_ && some_; }
    bool is_linear() const { return !first_no_share_; }  ///< every value within 0..1
    bool is_codes() const { return !first_no_code_; }    ///< every value a whole number, 0..255
    bool is_whole() const { return whole_; }             ///< … a whole number, 0 or more

    /// Hands the rows over to the mesh as what `kind` says. Colours none of which is above 1 are
    /// linear, and 8-bit sRGB codes otherwise. Error: MalformedBody for colours that are neither.
    std::optional<Error> give_to(Mesh& mesh);

  private:
    std::vector<Vec3> rows_;
    bool unit_or_zero_ = true, some_ = false, whole_ = true;
    std::optional<std::uint64_t> first_no_share_, first_no_code_;  // lines
};

/// What the columns of a table of points hold.
struct Columns {
    /// Of each column its place among x y z, the first triple and the second; `number`: only to be
    /// a number; `anything`: not even that.
    std::vector<std::size_t> slots;
    TripleKind first = TripleKind::Unused, second = TripleKind::Unused;
    std::vector<std::string> notes;

    static constexpr std::size_t number = 9, anything = 10;
};

/// By the names of the columns, in any order and case: x y z, r g b (red green blue), nx ny nz
/// (normal_x …); others are left out. Error: MalformedHeader.
Result<Columns> columns_named(std::span<const std::string_view> names);

/// By their number alone: 3, 4, 6, 7 or 9, as read_xyz says. Error: MalformedBody.
Result<Columns> columns_numbered(std::size_t count);

/// Decides what stands in triples that can be either, for all rows have been seen. Error:
/// MalformedBody.
std::optional<Error> tell_apart(Triple& first, Triple& second);

}  // namespace relight
