#include <algorithm>
#include <cstdint>
#include <cstring>

#include "core/io/filed.h"
#include "core/io/ply_columns.h"
#include "core/io/ply_source.h"
#include "core/io/text_out.h"
#include "core/io/writers.h"

namespace relight {
namespace ply {
namespace {

/// How faces are written.
struct FaceShape {
    Scalar count = Scalar::U8;  // of the lists' lengths
    bool uvs = false;           // texcoord, u v a corner
    bool materials = false;     // material_index
};

FaceShape shape_of(const Mesh& mesh)
{
    FaceShape shape{Scalar::U8, !mesh.corner_uvs.empty(), !mesh.face_materials.empty()};
    std::size_t longest = 3;
    for (std::size_t f = 0; !mesh.faces.offsets.empty() && f < mesh.faces.count(); ++f) {
        longest = std::max(longest, mesh.faces.end(f) - mesh.faces.begin(f));
    }
    if ((shape.uvs ? 2 : 1) * longest > 255) { shape.count = Scalar::U32; }
    return shape;
}

/// A comment stays one line, whatever its text holds.
void append_comment(std::string& out, std::string_view text)
{
    out += "comment " + one_line(text) + "\n";
}

std::string header_of(const LitMesh& lit, const std::vector<Column>& columns,
                      const FaceShape& faces, PlyEncoding encoding)
{
    const Mesh& mesh = lit.mesh;
    std::string out = "ply\nformat ";
    out += encoding == PlyEncoding::Ascii ? "ascii 1.0\n" : "binary_little_endian 1.0\n";
    for (const std::string& comment : lit.comments) { append_comment(out, comment); }
    if (!mesh.absent.empty()) {
        append_comment(out, std::to_string(mesh.absent.size()) + " points are absent: nan");
    }
    for (std::size_t m = 0; faces.materials && m < mesh.materials.size(); ++m) {
        append_comment(out, "material " + std::to_string(m) + " " + mesh.materials[m]);
    }
    out += "element vertex " + std::to_string(mesh.positions.size()) + "\n";
    for (const Column& column : columns) {
        for (const std::string& name : column.names) {
            out += "property ";
            out += name_of(column.type);
            out += " " + name + "\n";
        }
    }
    if (mesh.faces.count() > 0) {
        const std::string list = "property list " + std::string(name_of(faces.count));
        out += "element face " + std::to_string(mesh.faces.count()) + "\n";
        out += list + " int vertex_indices\n";
        if (faces.uvs) { out += list + " float texcoord\n"; }
        if (faces.materials) { out += "property int material_index\n"; }
    }
    return out + "end_header\n";
}

std::size_t stride_of(const std::vector<Column>& columns)
{
    std::size_t stride = 0;
    for (const Column& column : columns) { stride += column.size(); }
    return stride;
}

/// Vertices [first, first + n) as binary records at `out`.
void fill_rows(const std::vector<Column>& columns, std::size_t first, std::size_t n, char* out,
               std::size_t stride)
{
    for (const Column& column : columns) {
        column.fill(first, n, out, stride);
        out += column.size();
    }
}

/// Calls body(first, n) for blocks of vertices whose rows stay in the nearest cache, though each
/// column walks over them anew, until it says false.
template <class Body>
void for_rows(std::size_t count, std::size_t stride, Body body)
{
    constexpr std::size_t block = std::size_t{1} << 14;
    const std::size_t rows =
        std::clamp<std::size_t>(block / std::max<std::size_t>(stride, 1), 1, 1024);
    for (std::size_t first = 0; first < count; first += rows) {
        if (!body(first, std::min(rows, count - first))) { return; }
    }
}

void write_vertices(BlockOut& out, std::size_t count, const std::vector<Column>& columns)
{
    const std::size_t stride = stride_of(columns);
    for_rows(count, stride, [&](std::size_t first, std::size_t n) {
        fill_rows(columns, first, n, out.room(n * stride), stride);
        return out.open();
    });
}

void write_lines(TextOut out, std::size_t count, const std::vector<Column>& columns)
{
    const std::size_t stride = stride_of(columns);
    std::vector<char> rows;
    for_rows(count, stride, [&](std::size_t first, std::size_t n) {
        rows.resize(n * stride);
        fill_rows(columns, first, n, rows.data(), stride);
        const auto* at = reinterpret_cast<const std::byte*>(rows.data());
        for (std::size_t i = 0; i < n; ++i) {
            for (const Column& column : columns) {
                for (std::size_t k = 0; k < column.names.size(); ++k, at += size_of(column.type)) {
                    with_type(column.type,
                              [&](auto zero) { out.number(load<decltype(zero), false>(at)); });
                }
            }
            out.end_record();
        }
        return out.open();
    });
}

/// Numbers as bytes, for the same loop as text.
struct BinaryOut {
    BlockOut& out;

    template <class T>
    void number(T value)
    {
        out.number(value);
    }
    void end_record() {}
    bool open() const { return out.open(); }
};

template <class Out>
void write_faces(Out out, const Mesh& mesh, const FaceShape& shape)
{
    const auto length = [&](std::size_t n) {
        if (shape.count == Scalar::U8) { return out.number(static_cast<std::uint8_t>(n)); }
        out.number(static_cast<std::uint32_t>(n));
    };
    const FiledUv filed_uv(mesh);
    for (std::size_t f = 0; f < mesh.faces.count() && out.open(); ++f) {
        const std::size_t begin = mesh.faces.begin(f), end = mesh.faces.end(f);
        length(end - begin);
        for (std::size_t c = begin; c < end; ++c) { out.number(mesh.faces.indices[c]); }
        if (shape.uvs) {
            length(2 * (end - begin));
            for (std::size_t c = begin; c < end; ++c) {
                for (const float x : filed_uv(mesh.corner_uvs[c])) { out.number(x); }
            }
        }
        if (shape.materials) { out.number(mesh.face_materials[f]); }
        out.end_record();
    }
}

/// The common case, in blocks: a length of 3 and the indices.
void write_triangles(BlockOut& out, std::span<const std::uint32_t> indices)
{
    constexpr std::size_t faces = 1024, bytes = 1 + sizeof(Triangle);
    constexpr std::size_t ahead = 512;  // indices fetched before their turn
    for (std::size_t first = 0; first < indices.size() && out.open(); first += 3 * faces) {
        const auto triangles = indices.subspan(first, std::min(3 * faces, indices.size() - first));
        char* at = out.room(triangles.size() / 3 * bytes);
        for (std::size_t k = 0; k < triangles.size(); k += 3, at += bytes) {
            __builtin_prefetch(&triangles[k] + ahead);
            *at = 3;
            std::memcpy(at + 1, &triangles[k], sizeof(Triangle));
        }
    }
}

/// Of all faces as binary.
std::uint64_t face_bytes(const Mesh& mesh, const FaceShape& shape)
{
    const std::uint64_t faces = mesh.faces.count(), corners = mesh.faces.indices.size();
    const std::uint64_t lists = faces * size_of(shape.count);
    return lists + corners * sizeof(std::uint32_t) +
           (shape.uvs ? lists + corners * sizeof(Uv) : 0) +
           (shape.materials ? faces * sizeof(std::uint32_t) : 0);
}

}  // namespace
}  // namespace ply

Encoding encode_ply(const LitMesh& lit, PlyEncoding encoding)
{
    const Mesh& mesh = lit.mesh;
    std::vector<ply::Column> columns = ply::columns_of(lit);
    const ply::FaceShape shape = ply::shape_of(mesh);
    std::string header = ply::header_of(lit, columns, shape, encoding);
    if (encoding == PlyEncoding::Ascii) {
        return {0, [&mesh, columns = std::move(columns), header = std::move(header),
                    shape](const Sink& sink) {
                    BlockOut out(sink);
                    out.bytes(header);
                    ply::write_lines({out}, mesh.positions.size(), columns);
                    ply::write_faces(TextOut{out}, mesh, shape);
                    return out.flush();
                }};
    }
    const std::uint64_t bytes = header.size() +
                                std::uint64_t{ply::stride_of(columns)} * mesh.positions.size() +
                                ply::face_bytes(mesh, shape);
    const bool plain = mesh.faces.offsets.empty() && !shape.uvs && !shape.materials;
    return {bytes, [&mesh, columns = std::move(columns), header = std::move(header), shape,
                    plain](const Sink& sink) {
                BlockOut out(sink);
                out.bytes(header);
                ply::write_vertices(out, mesh.positions.size(), columns);
                if (plain) {
                    ply::write_triangles(out, mesh.faces.indices);
                } else {
                    ply::write_faces(ply::BinaryOut{out}, mesh, shape);
                }
                return out.flush();
            }};
}

}  // namespace relight
