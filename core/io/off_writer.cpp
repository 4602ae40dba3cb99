#include <algorithm>
#include <cassert>

#include "core/io/filed.h"
#include "core/io/srgb_codes.h"
#include "core/io/text_out.h"
#include "core/io/writers.h"

namespace relight {
namespace {

/// Colours as OFF holds them: all 8-bit codes, or all linear numbers with a point.
struct Colors {
    std::vector<Rgb8> codes;
    std::vector<Rgbf> linear;

    bool any() const { return !codes.empty() || !linear.empty(); }
};

Colors colors_of(const LitMesh& lit)
{
    std::vector<Rgb8> codes(lit.color.begin(), lit.color.end());
    if (codes.empty()) { codes = codes_of(lit.mesh.colors); }
    if (codes.empty()) { return {{}, lit.mesh.colors}; }
    // Integers of which none exceeds 1 are read as shares of 1: codes so dark are said otherwise.
    const bool dark = std::all_of(codes.begin(), codes.end(), [](const Rgb8& code) {
        return *std::max_element(code.begin(), code.end()) <= 1;
    });
    if (!dark) { return {std::move(codes), {}}; }
    Colors colors;
    for (const Rgb8& code : codes) { colors.linear.push_back(to_float(srgb_eotf(code))); }
    return colors;
}

/// A number that cannot be taken for an 8-bit code.
void append_with_point(TextOut text, float value)
{
    const std::size_t begin = text.out.size();
    text.number(value);
    if (text.out.find_first_of(".e", begin) == std::string::npos) {
        text.out.insert(text.out.size() - 1, ".0");
    }
}

void append_vertices(TextOut text, const LitMesh& lit, const Colors& colors)
{
    const Mesh& mesh = lit.mesh;
    const FiledUv filed_uv(mesh);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Point3 p = mesh.positions[i];
        for (const double x : {p.x, p.y, p.z}) {
            if (mesh.double_positions) {
                text.number(x);
            } else {
                text.number(static_cast<float>(x));
            }
        }
        if (!lit.normals.empty() || !mesh.normals.empty()) {
            const Vec3 n = lit.normals.empty() ? mesh.normals[i] : Vec3(lit.normals[i]);
            for (const float x : to_float(Rgb{n.x, n.y, n.z})) { text.number(x); }
        }
        if (!colors.codes.empty()) {
            for (const unsigned char code : colors.codes[i]) {
                text.number(static_cast<unsigned>(code));
            }
            text.number(255);  // alpha: some readers insist on four
        } else if (!colors.linear.empty()) {
            for (const float band : colors.linear[i]) { append_with_point(text, band); }
            text.number(1);
        }
        if (!mesh.uvs.empty()) {
            for (const float x : filed_uv(mesh.uvs[i])) { text.number(x); }
        }
        text.end_record();
    }
}

}  // namespace

std::string write_off(const LitMesh& lit)
{
    const Mesh& mesh = lit.mesh;
    assert(lit.color.empty() || lit.color.size() == mesh.positions.size());
    const Colors colors = colors_of(lit);
    std::string out;
    // A guess: digits vary.
    out.reserve(64 * mesh.positions.size() + 8 * mesh.faces.indices.size());
    if (!mesh.uvs.empty()) { out += "ST"; }
    if (colors.any()) { out += "C"; }
    if (!lit.normals.empty() || !mesh.normals.empty()) { out += "N"; }
    out += "OFF\n";
    for (const std::string& comment : lit.comments) { out += "# " + one_line(comment) + "\n"; }
    if (!mesh.absent.empty()) {
        out += "# " + std::to_string(mesh.absent.size()) +
               " points are absent: they stand where another one does\n";
    }
    TextOut text{out};
    text.number(mesh.positions.size());
    text.number(mesh.faces.count());
    text.number(0);  // edges, which nobody counts
    text.end_record();
    append_vertices(text, lit, colors);
    for (std::size_t f = 0; f < mesh.faces.count(); ++f) {
        text.number(mesh.faces.end(f) - mesh.faces.begin(f));
        for (std::size_t c = mesh.faces.begin(f); c < mesh.faces.end(f); ++c) {
            text.number(mesh.faces.indices[c]);
        }
        text.end_record();
    }
    return out;
}

}  // namespace relight
