#include <array>
#include <bit>
#include <cctype>
#include <cstdint>
#include <unordered_set>
#include <utility>

#include "core/io/filed.h"
#include "core/io/writers.h"
#include "core/io/zip_writer.h"

namespace relight {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written by memcpy");
static_assert(sizeof(Point3) == 3 * sizeof(double) && sizeof(Rgb8) == 3);

/// One array as it will lie in the archive.
struct Array {
    std::string name;
    std::string_view type;  // NumPy's: "<f4"
    std::size_t rows{};
    std::size_t columns{};  // 0: one-dimensional
    Piece data;
};

/// The head of a .npy file, version 1.0: padded so that the data starts at a multiple of 64.
std::string npy_head(const Array& array)
{
    std::string shape = std::to_string(array.rows);
    shape += ',';
    if (array.columns > 0) { shape += std::to_string(array.columns); }
    std::string dict = "{'descr': '";
    dict += array.type;
    dict += "', 'fortran_order': False, 'shape': (" + shape + "), }";
    constexpr std::size_t preamble = 10;
    dict.append(63 - (preamble + dict.size()) % 64, ' ');
    dict += '\n';
    std::string head("\x93NUMPY\x01\x00", 8);
    head += static_cast<char>(dict.size() & 0xffU);
    head += static_cast<char>(dict.size() >> 8U);
    return head + dict;
}

/// The positions, with NaN for absent points.
Piece positions_of(const Mesh& mesh)
{
    if (mesh.absent.empty()) { return span_piece(std::span(mesh.positions)); }
    return rows_piece(mesh.positions.size(), [&mesh](std::size_t i) {
        const Point3 p = filed_position(mesh, i);
        return std::array{p.x, p.y, p.z};
    });
}

/// A name that is one file wherever an archive is unpacked.
std::string file_name(std::string_view name, std::unordered_set<std::string>& taken)
{
    std::string safe;
    for (const char c : name.substr(0, 1000)) {
        const bool bad = static_cast<unsigned char>(c) < ' ' || c == '\x7f' ||
                         std::string_view("/\\:*?\"<>|").find(c) != std::string_view::npos;
        safe += bad ? '_' : c;
    }
    while (!taken.insert(safe).second) { safe += '_'; }
    return safe;
}

Piece floats_of(std::span<const Dir3> normals)
{
    return rows_piece(normals.size(), [normals](std::size_t i) {
        const Dir3& n = normals[i];
        return to_float({n.x(), n.y(), n.z()});
    });
}

}  // namespace

Encoding encode_npz(const LitMesh& lit)
{
    const Mesh& mesh = lit.mesh;
    const std::size_t vertices = mesh.positions.size();
    const std::span indices(mesh.faces.indices), offsets(mesh.faces.offsets);

    std::vector<Array> arrays;
    arrays.push_back({"positions", "<f8", vertices, 3, positions_of(mesh)});
    if (offsets.empty()) {
        arrays.push_back({"faces", "<i4", mesh.faces.count(), 3, span_piece(indices)});
    } else {
        arrays.push_back({"faces", "<i4", indices.size(), 0, span_piece(indices)});
        arrays.push_back({"face_offsets", "<i4", offsets.size(), 0, span_piece(offsets)});
    }
    if (!lit.normals.empty()) {
        arrays.push_back({"normal", "<f4", vertices, 3, floats_of(lit.normals)});
    }
    if (!lit.color.empty()) {
        arrays.push_back({"color", "|u1", vertices, 3, span_piece(lit.color)});
    }
    std::unordered_set<std::string> taken;
    for (const Array& array : arrays) { taken.insert(array.name); }
    for (const Quantity3& q : lit.quantities) {
        const std::size_t columns = q.components == 1 ? 0 : static_cast<std::size_t>(q.components);
        arrays.push_back(
            {file_name(q.name, taken), "<f4", vertices, columns, span_piece(q.values)});
    }

    std::vector<ZipFile> files;
    for (Array& array : arrays) {
        const std::string head = npy_head(array);
        files.push_back(
            {array.name + ".npy",
             {head.size() + array.data.bytes, [head, data = std::move(array.data)](BlockOut& out) {
                  out.bytes(head);
                  data.write(out);
              }}});
    }
    return encode_zip(std::move(files));
}

}  // namespace relight
