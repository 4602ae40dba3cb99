#include "core/io/ply_columns.h"

#include <array>
#include <cassert>
#include <cstring>
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

std::array<float, 3> as_floats(Vec3 v)
{
    return to_float(Rgb{v.x, v.y, v.z});
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
    return column(Scalar::F32, names,
                  [&mesh](std::size_t i) { return as_floats(filed_position(mesh, i) - Point3{}); });
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
        columns.push_back(column(Scalar::F32, {"nx", "ny", "nz"},
                                 [n = lit.normals](std::size_t i) { return as_floats(n[i]); }));
    } else if (!mesh.normals.empty()) {
        columns.push_back(column(Scalar::F32, {"nx", "ny", "nz"},
                                 [&mesh](std::size_t i) { return as_floats(mesh.normals[i]); }));
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
