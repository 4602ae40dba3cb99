#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>

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
void write_with_point(TextOut text, float value)
{
    text.number(value);
    constexpr std::size_t longest = 32;
    std::array<char, longest> digits;
    const auto end = std::to_chars(digits.begin(), digits.end(), value).ptr;
    if (std::string_view(digits.begin(), end).find_first_of(".e") == std::string_view::npos) {
        text.out.back() = '.';
        text.out.bytes("0 ");
    }
}

void write_head(TextOut text, const LitMesh& lit, const Colors& colors)
{
    const Mesh& mesh = lit.mesh;
    std::string head;
    if (!mesh.uvs.empty()) { head += "ST"; }
    if (colors.any()) { head += "C"; }
    if (!lit.normals.empty() || !mesh.normals.empty()) { head += "N"; }
    head += "OFF\n";
    for (const std::string& comment : lit.comments) { head += "# " + one_line(comment) + "\n"; }
    if (!mesh.absent.empty()) {
        head += "# " + std::to_string(mesh.absent.size()) +
                " points are absent: they stand where another one does\n";
    }
    text.out.bytes(head);
    text.number(mesh.positions.size());
    text.number(mesh.faces.count());
    text.number(0);  // edges, which nobody counts
    text.end_record();
}

void write_vertices(TextOut text, const LitMesh& lit, const Colors& colors)
{
    const Mesh& mesh = lit.mesh;
    const FiledUv filed_uv(mesh);
    for (std::size_t i = 0; i < mesh.positions.size() && text.open(); ++i) {
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
            for (const float band : colors.linear[i]) { write_with_point(text, band); }
            text.number(1);
        }
        if (!mesh.uvs.empty()) {
            for (const float x : filed_uv(mesh.uvs[i])) { text.number(x); }
        }
        text.end_record();
    }
}

void write_faces(TextOut text, const Faces& faces)
{
    for (std::size_t f = 0; f < faces.count() && text.open(); ++f) {
        text.number(faces.end(f) - faces.begin(f));
        for (std::size_t c = faces.begin(f); c < faces.end(f); ++c) {
            text.number(faces.indices[c]);
        }
        text.end_record();
    }
}

}  // namespace

Encoding encode_off(const LitMesh& lit)
{
    assert(lit.color.empty() || lit.color.size() == lit.mesh.positions.size());
    return {0, [lit, colors = colors_of(lit)](const Sink& sink) {
                BlockOut out(sink);
                write_head({out}, lit, colors);
                write_vertices({out}, lit, colors);
                write_faces({out}, lit.mesh.faces);
                return out.flush();
            }};
}

}  // namespace relight
