#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/geometry/polygon.h"
#include "core/io/glb_parts.h"
#include "core/io/glb_plan.h"

namespace relight {
namespace glb {
namespace {

std::array<float, 3> as_floats(Vec3 v)
{
    return to_float(Rgb{v.x, v.y, v.z});
}

std::string json_of(Vec3 v)
{
    return '[' + decimal(v.x) + ',' + decimal(v.y) + ',' + decimal(v.z) + ']';
}

struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    void include(double x)
    {
        low = std::min(low, x);
        high = std::max(high, x);
    }
    /// Where the node stands along this axis: 0, unless the mesh is so far out that floats from the
    /// origin would move it by more than a millionth of its extent. A coordinate of the mesh: if
    /// all of them are floats, so are the differences, for they are within a factor of 2.
    double origin() const
    {
        constexpr double far_out = 16.0;  // half extents; floats err by 2^-24 of the coordinate
        const double half = 0.5 * (high - low);
        return std::abs(low + half) > far_out * half ? low : 0.0;
    }
};

/// Adds POSITION; the translation that its node needs.
Vec3 add_positions(Plan& plan, const Mesh& mesh)
{
    const std::vector<Point3>& places = mesh.positions;
    Range x, y, z;
    for (const Point3 p : places) {
        x.include(p.x);
        y.include(p.y);
        z.include(p.z);
    }
    const Point3 origin{x.origin(), y.origin(), z.origin()};
    const auto filed = [&places, origin](std::size_t i) { return as_floats(places[i] - origin); };
    // Of what is filed: g++ 12 may leave out the rounding of three doubles to float and back.
    std::array<float, 3> low = filed(0), high = low;
    for (std::size_t i = 1; i < places.size(); ++i) {
        const std::array<float, 3> p = filed(i);
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    const auto json_of_floats = [](const std::array<float, 3>& f) {
        const Rgb wide = to_double(f);
        return json_of({wide.r, wide.g, wide.b});
    };
    plan.add(vertex_data, f32, 3, places.size(), rows_piece(places.size(), filed),
             R"(,"min":)" + json_of_floats(low) + R"(,"max":)" + json_of_floats(high));
    return origin - Point3{};
}

/// glTF has unit normals or none at all.
void add_normals(Plan& plan, const LitMesh& lit, std::vector<std::string>& notes)
{
    const std::size_t count = lit.mesh.positions.size();
    const auto normal = [own = lit.normals, &mesh = lit.mesh](std::size_t i) {
        return own.empty() ? normalize(mesh.normals[i]) : own[i];
    };
    std::size_t missing = 0;
    for (std::size_t i = 0; i < count; ++i) { missing += normal(i) ? 0 : 1; }
    if (missing > 0) {
        notes.push_back("the NORMAL of " + std::to_string(missing) +
                        " vertices that have none is (0, 0, 1)");
    }
    plan.add(vertex_data, f32, 3, count, rows_piece(count, [normal](std::size_t i) {
                 const Dir3 n = normal(i);
                 return n ? as_floats(n) : std::array{0.0F, 0.0F, 1.0F};
             }));
}

/// With an alpha of 0 for points that are none, if there are any.
void add_colors(Plan& plan, const LitMesh& lit)
{
    const Mesh& mesh = lit.mesh;
    const std::size_t count = mesh.positions.size();
    const auto add = [&](auto linear) {
        if (mesh.absent.empty()) {
            return plan.add(vertex_data, f32, 3, count, rows_piece(count, std::move(linear)));
        }
        const auto with_alpha = [&mesh, linear = std::move(linear)](std::size_t i) {
            const Rgbf color = linear(i);
            const bool absent = std::binary_search(mesh.absent.begin(), mesh.absent.end(), i);
            return std::array{color[0], color[1], color[2], absent ? 0.0F : 1.0F};
        };
        return plan.add(vertex_data, f32, 4, count, rows_piece(count, with_alpha));
    };
    if (!lit.color.empty()) {
        add(LinearColors(lit.color));
    } else {
        add([&mesh](std::size_t i) {
            Rgbf color = mesh.colors[i];  // glTF ends at 1
            for (float& band : color) { band = std::clamp(band, 0.0F, 1.0F); }
            return color;
        });
    }
}

/// Adds all attributes; the JSON object that names them.
std::string add_attributes(Plan& plan, const LitMesh& lit, Vec3& translation,
                           std::vector<std::string>& notes)
{
    const Mesh& mesh = lit.mesh;
    const std::size_t count = mesh.positions.size();
    std::string names = R"({"POSITION":0)";
    std::size_t next = 1;
    const auto name = [&](const std::string& attribute) {
        names += ",\"" + attribute + "\":" + std::to_string(next++);
    };
    translation = add_positions(plan, mesh);
    if (!lit.normals.empty() || !mesh.normals.empty()) {
        add_normals(plan, lit, notes);
        name("NORMAL");
    }
    // glTF's v runs down the picture; that of PLY, OBJ and OFF runs up.
    const bool down = mesh.format == "glb" || mesh.format == "gltf";
    int set = 0;
    for (const std::vector<Uv>* uvs : {&mesh.uvs, &mesh.uvs_1}) {
        if (uvs->empty()) { continue; }
        plan.add(vertex_data, f32, 2, count, rows_piece(count, [uvs, down](std::size_t i) {
                     return down ? (*uvs)[i] : Uv{(*uvs)[i][0], 1.0F - (*uvs)[i][1]};
                 }));
        name("TEXCOORD_" + std::to_string(set++));
    }
    if (!mesh.corner_uvs.empty()) {
        notes.emplace_back(
            "texture coordinates are left out: they differ between the faces at a vertex, glTF has "
            "one each vertex, and the vertices stay the file's");
    }
    if (!lit.color.empty() || !mesh.colors.empty()) {
        add_colors(plan, lit);
        name("COLOR_0");
    }
    for (const Quantity3& q : attributes_of(lit.quantities)) {
        plan.add(vertex_data, f32, q.components, count, span_piece(q.values));
        name(q.name);
    }
    return names + '}';
}

/// Corners of the triangles of each material, in the order of the faces.
std::vector<std::vector<std::uint32_t>> triangles_by_material(const Mesh& mesh)
{
    std::vector<std::vector<std::uint32_t>> groups(std::max<std::size_t>(1, mesh.materials.size()));
    std::vector<Triangle> triangles;
    for (std::size_t f = 0; f < mesh.faces.count(); ++f) {
        const std::size_t begin = mesh.faces.begin(f);
        triangles.clear();
        triangulate(mesh.positions,
                    std::span(mesh.faces.indices).subspan(begin, mesh.faces.end(f) - begin),
                    triangles);
        auto& group = groups[mesh.face_materials.empty() ? 0 : mesh.face_materials[f]];
        for (const Triangle& t : triangles) { group.insert(group.end(), t.begin(), t.end()); }
    }
    return groups;
}

/// `corners`: an array, or a span of one that stays.
template <class Corners>
std::size_t add_indices(Plan& plan, Corners corners, std::size_t vertices)
{
    const std::size_t count = corners.size();
    if (vertices <= 0xFFFF) {  // 0xFFFF itself is no index: it restarts a strip
        return plan.add(index_data, u16, 1, count,
                        rows_piece(count, [all = std::move(corners)](std::size_t i) {
                            return std::array{static_cast<std::uint16_t>(all[i])};
                        }));
    }
    const std::uint64_t bytes = count * sizeof(std::uint32_t);
    return plan.add(index_data, u32, 1, count,
                    {bytes, [all = std::move(corners)](BlockOut& out) {
                         span_piece(std::span<const std::uint32_t>(all)).write(out);
                     }});
}

/// One material each of the mesh's, or the one: the colours as they are, from both sides.
std::string materials_of(const Mesh& mesh)
{
    std::string json;
    const std::string look =
        std::string(R"("pbrMetallicRoughness":{"metallicFactor":0},"doubleSided":true,)") +
        (mesh.absent.empty() ? "" : R"("alphaMode":"MASK",)") +
        R"("extensions":{"KHR_materials_unlit":{}}})";
    for (const std::string& name : mesh.materials) {
        json += (json.empty() ? "{" : ",{") + ("\"name\":" + quoted(name) + ',') + look;
    }
    return json.empty() ? '{' + look : json;
}

}  // namespace
}  // namespace glb

Encoding encode_glb(const LitMesh& lit)
{
    const Mesh& mesh = lit.mesh;
    glb::Plan plan;
    Vec3 translation;
    std::vector<std::string> notes = lit.comments;
    const std::string attributes = glb::add_attributes(plan, lit, translation, notes);

    std::string primitives;
    const auto add_triangles = [&](std::size_t material, auto corners) {
        if (corners.empty()) { return; }
        const std::size_t indices =
            glb::add_indices(plan, std::move(corners), mesh.positions.size());
        primitives += (primitives.empty() ? "{" : ",{") + (R"("attributes":)" + attributes) +
                      R"(,"indices":)" + std::to_string(indices) + R"(,"material":)" +
                      std::to_string(material) + '}';
    };
    if (mesh.faces.count() == 0) {
        primitives = R"({"attributes":)" + attributes + R"(,"material":0,"mode":0})";
    } else if (mesh.faces.offsets.empty() && mesh.materials.size() <= 1) {
        add_triangles(0, std::span(mesh.faces.indices));
    } else {
        auto groups = glb::triangles_by_material(mesh);
        for (std::size_t m = 0; m < groups.size(); ++m) { add_triangles(m, std::move(groups[m])); }
    }
    std::string extras;
    for (const std::string& note : notes) {
        extras += (extras.empty() ? "" : ",") + glb::quoted(note);
    }
    if (!extras.empty()) { extras = R"(,"extras":{"relight":[)" + extras + "]}"; }
    const std::string moved =
        translation == Vec3{} ? "" : R"(,"translation":)" + glb::json_of(translation);
    return std::move(plan).encoded(R"({"asset":{"version":"2.0","generator":"Relight")" + extras +
                                   R"(},"extensionsUsed":["KHR_materials_unlit"],"scene":0,)" +
                                   R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)" + moved +
                                   R"(}],"meshes":[{"primitives":[)" + primitives +
                                   R"(]}],"materials":[)" + glb::materials_of(mesh) + "]");
}

}  // namespace relight
