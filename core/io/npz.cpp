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
    std::string_view bytes;
};

template <class T>
std::string_view bytes_of(std::span<const T> values)
{
    return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

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

/// The positions with NaN for absent points; empty if there are none such.
std::vector<Point3> with_absent(const Mesh& mesh)
{
    std::vector<Point3> out;
    for (std::size_t i = 0; !mesh.absent.empty() && i < mesh.positions.size(); ++i) {
        out.push_back(filed_position(mesh, i));
    }
    return out;
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

std::vector<std::array<float, 3>> as_floats(std::span<const Dir3> normals)
{
    std::vector<std::array<float, 3>> out;
    out.reserve(normals.size());
    for (const Dir3& n : normals) { out.push_back(to_float({n.x(), n.y(), n.z()})); }
    return out;
}

}  // namespace

std::string write_npz(const LitMesh& lit)
{
    const Mesh& mesh = lit.mesh;
    const std::size_t vertices = mesh.positions.size();
    const std::vector<std::array<float, 3>> normals = as_floats(lit.normals);
    const std::vector<Point3> filed = with_absent(mesh);
    const std::span positions(filed.empty() ? mesh.positions : filed);
    const std::vector<std::uint32_t>& indices = mesh.faces.indices;

    std::vector<Array> arrays;
    arrays.push_back({"positions", "<f8", vertices, 3, bytes_of(positions)});
    if (mesh.faces.offsets.empty()) {
        arrays.push_back({"faces", "<i4", mesh.faces.count(), 3, bytes_of(std::span(indices))});
    } else {
        const std::vector<std::uint32_t>& offsets = mesh.faces.offsets;
        arrays.push_back({"faces", "<i4", indices.size(), 0, bytes_of(std::span(indices))});
        arrays.push_back({"face_offsets", "<i4", offsets.size(), 0, bytes_of(std::span(offsets))});
    }
    if (!normals.empty()) {
        arrays.push_back({"normal", "<f4", vertices, 3, bytes_of(std::span(normals))});
    }
    if (!lit.color.empty()) {
        arrays.push_back({"color", "|u1", vertices, 3, bytes_of(lit.color)});
    }
    std::unordered_set<std::string> taken;
    for (const Array& array : arrays) { taken.insert(array.name); }
    for (const Quantity3& q : lit.quantities) {
        const std::size_t columns = q.components == 1 ? 0 : static_cast<std::size_t>(q.components);
        arrays.push_back({file_name(q.name, taken), "<f4", vertices, columns, bytes_of(q.values)});
    }

    std::size_t expected = 1024;
    for (const Array& array : arrays) {
        expected += array.bytes.size() + 2 * array.name.size() + 512;
    }
    ZipWriter zip(expected);
    for (const Array& array : arrays) {
        const std::string head = npy_head(array);
        zip.open(array.name + ".npy", head.size() + array.bytes.size());
        zip.bytes() += head;
        zip.bytes() += array.bytes;
        zip.close();
    }
    return std::move(zip).finish();
}

}  // namespace relight
