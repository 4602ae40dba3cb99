#include <array>
#include <cassert>
#include <charconv>
#include <cstdint>
#include <set>

#include "core/io/filed.h"
#include "core/io/text_out.h"
#include "core/io/writers.h"

namespace relight {
namespace {

constexpr std::uint32_t none = 0xFFFFFFFF;

void write_comment(BlockOut& out, const std::string& text)
{
    // Some readers go on behind a backslash at a line's end, comment or not.
    out.bytes("# " + one_line(text) + (text.ends_with('\\') ? " \n" : "\n"));
}

void write_head(BlockOut& out, const LitMesh& lit)
{
    for (const std::string& comment : lit.comments) { write_comment(out, comment); }
    if (!lit.color.empty()) {
        write_comment(out, "v x y z r g b: sRGB, code / 255");
    } else if (!lit.mesh.colors.empty()) {
        write_comment(out, "v x y z r g b: linear");
    }
    if (!lit.mesh.absent.empty()) {
        write_comment(out, std::to_string(lit.mesh.absent.size()) +
                               " points are absent: they stand where another one does");
    }
}

/// code / 255 of every code, as it is written.
std::array<std::string, 256> shares_of_255()
{
    std::array<std::string, 256> shares;
    for (std::size_t code = 0; code < shares.size(); ++code) {
        char digits[32];
        const float share = static_cast<float>(code) / 255.0F;
        shares[code].assign(digits, std::to_chars(digits, digits + sizeof(digits), share).ptr) +=
            ' ';
    }
    return shares;
}

void write_positions(TextOut text, const LitMesh& lit)
{
    const Mesh& mesh = lit.mesh;
    const std::array<std::string, 256> shares = shares_of_255();
    for (std::size_t i = 0; i < mesh.positions.size() && text.open(); ++i) {
        const Point3 p = mesh.positions[i];
        text.out.bytes("v ");
        for (const double x : {p.x, p.y, p.z}) {
            if (mesh.double_positions) {
                text.number(x);
            } else {
                text.number(static_cast<float>(x));
            }
        }
        if (!lit.color.empty()) {
            for (const unsigned char code : lit.color[i]) { text.out.bytes(shares[code]); }
        } else if (!mesh.colors.empty()) {
            for (const float band : mesh.colors[i]) { text.number(band); }
        }
        text.end_record();
    }
}

bool write_normals(TextOut text, const LitMesh& lit)
{
    const auto write = [&](Vec3 n) {
        text.out.bytes("vn ");
        for (const float x : to_float(Rgb{n.x, n.y, n.z})) { text.number(x); }
        text.end_record();
    };
    const std::size_t count = lit.normals.empty() ? lit.mesh.normals.size() : lit.normals.size();
    for (std::size_t i = 0; i < count && text.open(); ++i) {
        write(lit.normals.empty() ? lit.mesh.normals[i] : Vec3(lit.normals[i]));
    }
    return !lit.normals.empty() || !lit.mesh.normals.empty();
}

/// Writes the vt lines; the number of each corner's, or nothing if there are none.
std::vector<std::uint32_t> write_uvs(TextOut text, const Mesh& mesh)
{
    const std::vector<std::uint32_t>& indices = mesh.faces.indices;
    const FiledUv filed_uv(mesh);
    const auto write = [&](Uv uv) {
        text.out.bytes("vt ");
        for (const float x : filed_uv(uv)) { text.number(x); }
        text.end_record();
    };
    if (mesh.corner_uvs.empty()) {
        for (std::size_t i = 0; i < mesh.uvs.size() && text.open(); ++i) { write(mesh.uvs[i]); }
        return mesh.uvs.empty() ? std::vector<std::uint32_t>() : indices;
    }
    // A corner takes the vt of the one before it at its vertex, if that says the same.
    std::vector<std::uint32_t> uv_of(indices.size()), before(mesh.positions.size(), none);
    std::vector<std::uint32_t> corner_of;  // of each vt, the first
    for (std::uint32_t c = 0; c < indices.size() && text.open(); ++c) {
        std::uint32_t& last = before[indices[c]];
        if (last == none || mesh.corner_uvs[corner_of[last]] != mesh.corner_uvs[c]) {
            last = static_cast<std::uint32_t>(corner_of.size());
            corner_of.push_back(c);
            write(mesh.corner_uvs[c]);
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

void write_faces(TextOut text, const Mesh& mesh, const std::vector<std::uint32_t>& uv_of,
                 bool normals)
{
    const std::vector<std::string> names = usemtl_names(mesh);
    const char after_vertex = uv_of.empty() && !normals ? ' ' : '/';
    std::uint32_t worn = none;
    for (std::size_t f = 0; f < mesh.faces.count() && text.open(); ++f) {
        if (!mesh.face_materials.empty() && mesh.face_materials[f] != worn) {
            worn = mesh.face_materials[f];
            text.out.bytes("usemtl " + names[worn] + "\n");
        }
        text.out.bytes("f ");
        for (std::size_t c = mesh.faces.begin(f); c < mesh.faces.end(f); ++c) {
            const std::uint64_t vertex = mesh.faces.indices[c];
            text.number(vertex + 1, after_vertex);
            if (!uv_of.empty()) { text.number(std::uint64_t{uv_of[c]} + 1, normals ? '/' : ' '); }
            if (!normals) { continue; }
            if (uv_of.empty()) { text.out.bytes("/"); }
            text.number(vertex + 1);
        }
        text.end_record();
    }
}

}  // namespace

Encoding encode_obj(const LitMesh& lit)
{
    assert(lit.color.empty() || lit.color.size() == lit.mesh.positions.size());
    return {0, [lit](const Sink& sink) {
                const Mesh& mesh = lit.mesh;
                BlockOut out(sink);
                write_head(out, lit);
                write_positions({out}, lit);
                // In a cloud nothing can name a vt; as many vn as v are understood.
                const bool cloud = mesh.faces.count() == 0;
                const std::vector<std::uint32_t> uv_of =
                    cloud ? std::vector<std::uint32_t>() : write_uvs({out}, mesh);
                const bool normals = write_normals({out}, lit);
                write_faces({out}, mesh, uv_of, normals);
                return out.flush();
            }};
}

}  // namespace relight
