#include <array>
#include <cassert>
#include <cstdint>
#include <set>

#include "core/io/filed.h"
#include "core/io/text_out.h"
#include "core/io/writers.h"

namespace relight {
namespace {

constexpr std::uint32_t none = 0xFFFFFFFF;

void append_comment(std::string& out, const std::string& text)
{
    // Some readers go on behind a backslash at a line's end, comment or not.
    out += "# " + one_line(text) + (text.ends_with('\\') ? " \n" : "\n");
}

void append_head(std::string& out, const LitMesh& lit)
{
    for (const std::string& comment : lit.comments) { append_comment(out, comment); }
    if (!lit.color.empty()) {
        append_comment(out, "v x y z r g b: sRGB, code / 255");
    } else if (!lit.mesh.colors.empty()) {
        append_comment(out, "v x y z r g b: linear");
    }
    if (!lit.mesh.absent.empty()) {
        append_comment(out, std::to_string(lit.mesh.absent.size()) +
                                " points are absent: they stand where another one does");
    }
}

/// code / 255 of every code, as it is written.
std::array<std::string, 256> shares_of_255()
{
    std::array<std::string, 256> shares;
    for (std::size_t code = 0; code < shares.size(); ++code) {
        TextOut{shares[code]}.number(static_cast<float>(code) / 255.0F);
    }
    return shares;
}

void append_positions(TextOut text, const LitMesh& lit)
{
    const Mesh& mesh = lit.mesh;
    const std::array<std::string, 256> shares = shares_of_255();
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Point3 p = mesh.positions[i];
        text.out += "v ";
        for (const double x : {p.x, p.y, p.z}) {
            if (mesh.double_positions) {
                text.number(x);
            } else {
                text.number(static_cast<float>(x));
            }
        }
        if (!lit.color.empty()) {
            for (const unsigned char code : lit.color[i]) { text.out += shares[code]; }
        } else if (!mesh.colors.empty()) {
            for (const float band : mesh.colors[i]) { text.number(band); }
        }
        text.end_record();
    }
}

bool append_normals(TextOut text, const LitMesh& lit)
{
    const auto append = [&](Vec3 n) {
        text.out += "vn ";
        for (const float x : to_float(Rgb{n.x, n.y, n.z})) { text.number(x); }
        text.end_record();
    };
    if (!lit.normals.empty()) {
        for (const Dir3& n : lit.normals) { append(n); }
    } else {
        for (const Vec3& n : lit.mesh.normals) { append(n); }
    }
    return !lit.normals.empty() || !lit.mesh.normals.empty();
}

/// Writes the vt lines; the number of each corner's, or nothing if there are none.
std::vector<std::uint32_t> append_uvs(TextOut text, const Mesh& mesh)
{
    const std::vector<std::uint32_t>& indices = mesh.faces.indices;
    const FiledUv filed_uv(mesh);
    const auto append = [&](Uv uv) {
        text.out += "vt ";
        for (const float x : filed_uv(uv)) { text.number(x); }
        text.end_record();
    };
    if (mesh.corner_uvs.empty()) {
        for (const Uv& uv : mesh.uvs) { append(uv); }
        return mesh.uvs.empty() ? std::vector<std::uint32_t>() : indices;
    }
    // A corner takes the vt of the one before it at its vertex, if that says the same.
    std::vector<std::uint32_t> uv_of(indices.size()), before(mesh.positions.size(), none);
    std::vector<std::uint32_t> corner_of;  // of each vt, the first
    for (std::uint32_t c = 0; c < indices.size(); ++c) {
        std::uint32_t& last = before[indices[c]];
        if (last == none || mesh.corner_uvs[corner_of[last]] != mesh.corner_uvs[c]) {
            last = static_cast<std::uint32_t>(corner_of.size());
            corner_of.push_back(c);
            append(mesh.corner_uvs[c]);
        }
        uv_of[c] = last;
    }
    return uv_of;
}

/// Names that usemtl can say, each once: glTF may give several materials the same.
std::vector<std::string> usemtl_names(const Mesh& mesh)
{
    std::vector<std::string> names;
    std::set<std::string> taken;
    for (const std::string& material : mesh.materials) {
        std::string name = one_line(material);
        while (name.starts_with(' ')) { name.erase(0, 1); }
        while (name.ends_with(' ')) { name.pop_back(); }
        if (name.ends_with('\\')) { name.back() = '_'; }  // would go on behind the line's end
        while (!taken.insert(name).second) { name += "_" + std::to_string(names.size()); }
        names.push_back(std::move(name));
    }
    return names;
}

void append_faces(TextOut text, const Mesh& mesh, const std::vector<std::uint32_t>& uv_of,
                  bool normals)
{
    const std::vector<std::string> names = usemtl_names(mesh);
    const char after_vertex = uv_of.empty() && !normals ? ' ' : '/';
    std::uint32_t worn = none;
    for (std::size_t f = 0; f < mesh.faces.count(); ++f) {
        if (!mesh.face_materials.empty() && mesh.face_materials[f] != worn) {
            worn = mesh.face_materials[f];
            text.out += "usemtl " + names[worn] + "\n";
        }
        text.out += "f ";
        for (std::size_t c = mesh.faces.begin(f); c < mesh.faces.end(f); ++c) {
            const std::uint64_t vertex = mesh.faces.indices[c];
            text.number(vertex + 1, after_vertex);
            if (!uv_of.empty()) { text.number(std::uint64_t{uv_of[c]} + 1, normals ? '/' : ' '); }
            if (!normals) { continue; }
            if (uv_of.empty()) { text.out += '/'; }
            text.number(vertex + 1);
        }
        text.end_record();
    }
}

}  // namespace

std::string write_obj(const LitMesh& lit)
{
    const Mesh& mesh = lit.mesh;
    assert(lit.color.empty() || lit.color.size() == mesh.positions.size());
    std::string out;
    // A guess: digits vary.
    out.reserve(64 * mesh.positions.size() + 8 * mesh.faces.indices.size());
    append_head(out, lit);
    append_positions({out}, lit);
    // In a cloud nothing can name a vt; as many vn as v are understood.
    const bool cloud = mesh.faces.count() == 0;
    const std::vector<std::uint32_t> uv_of =
        cloud ? std::vector<std::uint32_t>() : append_uvs({out}, mesh);
    const bool normals = append_normals({out}, lit);
    append_faces({out}, mesh, uv_of, normals);
    return out;
}

}  // namespace relight
