#include "core/io/ply_columns.h"

#include <array>
#include <cassert>
#include <cstring>
#include <span>
#include <type_traits>
#include <unordered_set>

#include "core/io/filed.h"
#include "core/io/pieces.h"
#include "core/io/srgb_codes.h"

namespace relight::ply {
namespace {

/// A column of value(i), an array of as many numbers as there are names.
template <class Value>
Column column(Scalar type, std::vector<std::string> names, Value value)
{
    assert(names.size() * size_of(type) == sizeof(value(0)));
    return {type, std::move(names),
            [value](std::size_t first, std::size_t n, char* out, std::size_t stride) {
                fill_rows(value, first, n, out, stride);
            }};
}

/// Names with nothing but [A-Za-z0-9_], each once.
class Names {
  public:
    std::vector<std::string> of(const Quantity3& quantity)
    {
        if (quantity.components == 1) { return {unique(quantity.name)}; }
        return {unique(quantity.name + "_r"), unique(quantity.name + "_g"),
                unique(quantity.name + "_b")};
    }

  private:
    std::string unique(std::string name)
    {
        for (char& c : name) {
            const bool good = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                              (c >= '0' && c <= '9') || c == '_';
            if (!good) { c = '_'; }
        }
        while (!taken_.insert(name).second) { name += '_'; }
        return name;
    }

    std::unordered_set<std::string> taken_{"x",   "y",     "z",    "nx", "ny", "nz",
                                           "red", "green", "blue", "s",  "t"};
};

/// Points or directions as floats. Two numbers are rounded by one instruction, and what comes next
/// is fetched ahead: the columns of a record take turns, and the processor's own foresight begins
/// anew with each.
template <class T>
Column float_column(std::vector<std::string> names, std::span<const T> vectors)
{
    static_assert(sizeof(T) == sizeof(Vec3) && std::is_trivially_copyable_v<T>);
    return {Scalar::F32, std::move(names),
            [vectors](std::size_t first, std::size_t n, char* out, std::size_t stride) {
                using Doubles [[gnu::vector_size(16)]] = double;
                using Floats [[gnu::vector_size(8)]] = float;
                constexpr std::size_t ahead = 2048;  // bytes
                for (std::size_t i = first; i < first + n; ++i, out += stride) {
                    const char* at = reinterpret_cast<const char*>(&vectors[i]);
                    __builtin_prefetch(at + ahead);
                    Doubles xy;
                    double z;
                    std::memcpy(&xy, at, sizeof xy);
                    std::memcpy(&z, at + sizeof xy, sizeof z);
                    const auto floats = __builtin_convertvector(xy, Floats);
                    const auto last = static_cast<float>(z);
                    std::memcpy(out, &floats, sizeof floats);
                    std::memcpy(out + sizeof floats, &last, sizeof last);
                }
            }};
}

Column position_column(const Mesh& mesh)
{
    const std::vector<std::string> names = {"x", "y", "z"};
    if (mesh.double_positions) {
        return column(Scalar::F64, names, [&mesh](std::size_t i) {
            const Point3 p = filed_position(mesh, i);
            return std::array{p.x, p.y, p.z};
        });
    }
    if (mesh.absent.empty()) { return float_column(names, std::span(mesh.positions)); }
    return column(Scalar::F32, names, [&mesh](std::size_t i) {
        const Point3 p = filed_position(mesh, i);
        return to_float(Rgb{p.x, p.y, p.z});
    });
}

Column color_column(const LitMesh& lit)
{
    const std::vector<std::string> names = {"red", "green", "blue"};
    if (!lit.color.empty()) {
        return column(Scalar::U8, names, [color = lit.color](std::size_t i) { return color[i]; });
    }
    std::vector<Rgb8> codes = codes_of(lit.mesh.colors);
    if (!codes.empty()) {
        return column(Scalar::U8, names,
                      [codes = std::move(codes)](std::size_t i) { return codes[i]; });
    }
    return column(Scalar::F32, names, [&mesh = lit.mesh](std::size_t i) { return mesh.colors[i]; });
}

}  // namespace

std::vector<Column> columns_of(const LitMesh& lit)
{
    const Mesh& mesh = lit.mesh;
    std::vector<Column> columns;
    columns.push_back(position_column(mesh));
    if (!lit.normals.empty()) {
        columns.push_back(float_column({"nx", "ny", "nz"}, lit.normals));
    } else if (!mesh.normals.empty()) {
        columns.push_back(float_column({"nx", "ny", "nz"}, std::span(mesh.normals)));
    }
    if (!mesh.uvs.empty()) {
        columns.push_back(column(
            Scalar::F32, {"s", "t"},
            [&mesh, filed_uv = FiledUv(mesh)](std::size_t i) { return filed_uv(mesh.uvs[i]); }));
    }
    if (!lit.color.empty() || !mesh.colors.empty()) { columns.push_back(color_column(lit)); }
    Names names;
    for (const Quantity3& q : lit.quantities) {
        assert(q.components == 1 || q.components == 3);
        assert(q.values.size() == mesh.positions.size() * static_cast<std::size_t>(q.components));
        if (q.components == 1) {
            columns.push_back(column(Scalar::F32, names.of(q), [values = q.values](std::size_t i) {
                return std::array{values[i]};
            }));
        } else {
            columns.push_back(column(Scalar::F32, names.of(q), [values = q.values](std::size_t i) {
                return std::array{values[3 * i], values[3 * i + 1], values[3 * i + 2]};
            }));
        }
    }
    return columns;
}

}  // namespace relight::ply
