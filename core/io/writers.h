#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/camera.h"
#include "core/base/result.h"
#include "core/geometry/mesh.h"
#include "core/geometry/surface.h"

namespace relight {

/// One array of the answer: V values of `components` floats each, named as in the answer.
struct Quantity3 {
    std::string name;               ///< "irradiance", "radiance", "visibility_key", "per_light_key"
    int components = 3;             ///< 3: suffixes _r _g _b (PLY), or 1
    std::span<const float> values;  ///< V * components
};

/// A lit mesh, ready to be written. Spans live as long as the call.
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
std::string write_ply(const LitMesh& lit, PlyEncoding encoding);

/// NumPy's .npz (stored, not compressed): each quantity float32 (V,3) or (V,), `color` uint8 (V,3),
/// `normal` float32 (V,3), `positions` float64 (V,3), `faces` int32 (F,3) triangles as filed or
/// `faces`+`face_offsets` for polygons. The same input gives the same bytes.
std::string write_npz(const LitMesh& lit);

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
void append_json(std::string& out, std::span<const float> values, int components);

}  // namespace relight
