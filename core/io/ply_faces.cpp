#include "core/io/ply_faces.h"

namespace relight::ply {

Result<FaceLayout> layout_of(const Element& face)
{
    const auto refuse = [](std::string detail) {
        return Error{Fault::MalformedHeader, std::move(detail), {}, {}, {}};
    };
    std::optional<std::size_t> corners = face.find("vertex_indices");
    if (!corners) { corners = face.find("vertex_index"); }
    if (!corners) { return refuse("the face element needs a list property vertex_indices"); }
    const Property& property = face.properties[*corners];
    if (!property.count || !is_integer(property.type)) {
        return refuse("the property " + shown(property.name) +
                      " of a face must be a list of integers");
    }
    FaceLayout layout{*corners, face.find("texcoord")};
    if (layout.corner_uvs && !face.properties[*layout.corner_uvs].count) {
        layout.corner_uvs.reset();
    }
    return layout;
}

std::optional<std::size_t> plain_triangle_stride(const Element& face, const FaceLayout& layout)
{
    std::size_t stride = 0;
    for (std::size_t i = 0; i < face.properties.size(); ++i) {
        const Property& property = face.properties[i];
        if (i == layout.corners) {
            const bool plain = property.count == Scalar::U8 &&
                               (property.type == Scalar::I32 || property.type == Scalar::U32);
            if (!plain) { return {}; }
            stride += 1 + sizeof(Triangle);
        } else {
            if (property.count) { return {}; }
            stride += size_of(property.type);
        }
    }
    return stride;
}

std::uint64_t take_triangles(std::span<const std::byte> bytes, const Element& face,
                             const FaceLayout& layout, Mesh& mesh, std::uint64_t vertices,
                             Progress& progress)
{
    const std::size_t stride = plain_triangle_stride(face, layout).value_or(0);
    if (stride == 0) { return 0; }
    std::size_t before = 0;  // scalars ahead of the list
    for (std::size_t i = 0; i < layout.corners; ++i) { before += size_of(face.properties[i].type); }

    const std::uint64_t most = std::min<std::uint64_t>(face.count, bytes.size() / stride);
    // A negative int reads as 2^31 and more: out of range as well, as long as there are fewer
    // vertices.
    const auto end = static_cast<std::uint32_t>(std::min<std::uint64_t>(vertices, 1U << 31U));
    constexpr std::uint64_t cached = 1024;  // faces whose zeros are still there when they are read
    static_assert(block % cached == 0);
    std::vector<std::uint32_t>& indices = mesh.faces.indices;
    indices.reserve(3 * most);
    const std::byte* record = bytes.data() + before;
    for (std::uint64_t f = 0; f < most;) {
        if (f % block == 0 && progress.stopped()) { return f; }
        const std::uint64_t next = std::min(most, f + cached);
        indices.resize(3 * next);
        for (std::uint32_t* out = indices.data() + 3 * f; f < next;
             ++f, record += stride, out += 3) {
            std::memcpy(out, record + 1, sizeof(Triangle));
            const bool good = std::max({out[0], out[1], out[2]}) < end;
            if (*record != std::byte{3} || !good) {
                indices.resize(3 * f);
                return f;
            }
        }
    }
    return most;
}

}  // namespace relight::ply
