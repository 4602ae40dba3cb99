#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/camera.h"
#include "core/base/result.h"
#include "core/geometry/mesh.h"
#include "core/geometry/surface.h"
#include "core/io/sink.h"

namespace relight {

/// One array of the answer: V values of `components` floats each, named as in the answer.
struct Quantity3 {
    std::string name;               ///< "irradiance", "radiance", "visibility_key", "per_light_key"
    int components = 3;             ///< 3: suffixes _r _g _b (PLY), or 1
    std::span<const float> values;  ///< V * components
};

/// A lit mesh, ready to be written. What an Encoding was made of must outlive it: the mesh, and
/// what the spans show; the LitMesh itself need not.
/// Texture coordinates that came as glTF are turned over where v grows upward: everywhere but in
/// glTF. Absent points are NaN in PLY, NPZ and VTP; OBJ and OFF know no such thing and write their
/// placeholder. Where there are comments, one counts them.
struct LitMesh {
    const Mesh& mesh;
    std::span<const Dir3>
        normals;  ///< V: written when asked for, or when the file brought normals; else empty
    std::span<const Rgb8> color;  ///< V sRGB bytes, or empty: then the file's own colours are kept
    std::vector<Quantity3> quantities;
    std::vector<std::string> comments;  ///< units, transfer, exposure: a line each
};

enum class PlyEncoding { BinaryLittleEndian, Ascii };

/// PLY with everything the mesh brought (faces as filed with their material_index, normals,
/// colours, texture coordinates as s t, or a list texcoord a face) and the asked-for quantities as
/// float vertex properties, named in [A-Za-z0-9_]. Positions are double where float would lose.
/// Filed normals and colours are kept where `lit` has none of its own: colours as uchar if 8-bit
/// codes say them exactly, else as linear floats.
Encoding encode_ply(const LitMesh& lit, PlyEncoding encoding = PlyEncoding::BinaryLittleEndian);

/// NumPy's .npz (stored, not compressed): each quantity float32 (V,3) or (V,), `color` uint8 (V,3),
/// `normal` float32 (V,3), `positions` float64 (V,3), `faces` int32 (F,3) triangles as filed or
/// `faces`+`face_offsets` for polygons. The same input gives the same bytes.
Encoding encode_npz(const LitMesh& lit);

/// Wavefront OBJ: v x y z [r g b], vt, vn, faces as filed under their usemtl. A vertex has one
/// normal and, but for corner_uvs, one vt; in a cloud, none. Colour alone of what a LitMesh holds:
/// quantities have no place in it. Asked-for colour is sRGB / 255, the common extension; filed
/// colours are linear, as read_obj takes them; a comment says which.
Encoding encode_obj(const LitMesh& lit);

/// Geomview OFF, ascii: [ST][C][N]OFF with faces as filed, colours as 0..255 and an alpha of 255.
/// Colours that are no 8-bit codes are linear, with a point. Colour alone.
Encoding encode_off(const LitMesh& lit);

/// VTK's XML PolyData, raw appended binary: faces as Polys (vertices of a cloud as Verts), arrays
/// Normals, TCoords, "color" (uchar; filed colours that are no 8-bit codes: "color_linear", float)
/// and each quantity by its name, as far as XML takes it. Comments are an array of the field data.
/// VTK writes it, and so it is held whole.
Encoding encode_vtp(const LitMesh& lit);

/// glTF 2.0 as GLB, from nothing but the mesh: one node; a primitive a material group (points for a
/// cloud), unlit white materials, so that viewers show the colours as they are; COLOR_0 is linear
/// float (with an alpha of 0 for absent points), quantities are _IRRADIANCE, _PER_LIGHT_KEY … .
/// Positions relative to the node's translation where the mesh is so far out that float would lose.
/// Comments, and what had to be left out, are asset.extras.relight. No bytes beyond 4 GiB, the most
/// that a GLB holds.
Encoding encode_glb(const LitMesh& lit);

/// The LAS file that a cloud came as, with its colours replaced by `color` (16 bits: code * 257);
/// a point format without R G B becomes the one that has it. All else stays.
/// Errors: those of read_las.
Result<Encoding> encode_las(std::span<const std::byte> file, std::span<const Rgb8> color);

/// Radiance .hdr (RGBE, run-length encoded), linear Rec.709, row 0 on top. Within 1/256 of each
/// pixel's largest band, from 2^-128 (below is black) to 255/256 2^127 (brighter is cut).
std::string write_hdr(int width, int height, std::span<const Rgbf> pixels,
                      std::span<const std::string> comments);

/// Baseline JPEG (JFIF) of 8-bit sRGB pixels, quality 1..100, row 0 on top, at most 65500 a side.
std::string write_jpeg(int width, int height, std::span<const Rgb8> pixels, int quality = 92);

/// PNG of 8-bit RGB (or RGBA if alpha is given) pixels, row 0 on top, tagged sRGB.
std::string write_png(int width, int height, std::span<const Rgb8> pixels,
                      std::span<const unsigned char> alpha = {});

/// A plane of an EXR picture: 1 or 3 floats a pixel.
struct ExrLayer {
    std::string name;    ///< "" for the picture itself (R G B), else "standard_error" …
    int components = 3;  ///< 3: suffixes R G B; 1: suffix Y, or A for the name "A"
    std::span<const float> values;  ///< width * height * components, row 0 on top
};

/// OpenEXR, 32-bit float, ZIP-compressed, one part, layers as channels "name.R" …; linear Rec.709.
/// `comments` become string attributes "comment_0" …. The same input gives the same bytes.
std::string write_exr(int width, int height, std::span<const ExrLayer> layers,
                      std::span<const std::string> comments);

/// [[r,g,b],…] or [v,…] with the fewest digits that read back exactly, appended to `out`.
void write_json(BlockOut& out, std::span<const float> values, int components);
void append_json(std::string& text, std::span<const float> values, int components);

}  // namespace relight
