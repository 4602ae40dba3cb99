#include <string>
#include <vector>

#include "core/io/coordinate.h"
#include "core/io/ply_checks.h"
#include "core/io/ply_faces.h"
#include "core/io/ply_header.h"
#include "core/io/ply_source.h"
#include "core/io/ply_vertices.h"
#include "core/io/readers.h"

// Classified: fuzzed (tests/fuzz). Nothing here trusts a byte.
namespace relight {
namespace ply {
namespace {

Error cancelled()
{
    return {Fault::Cancelled, "stopped while reading vertices", {}, {}, {}};
}

/// Reads records value by value. `put(i, row)` gets what `slots` take of each: a Result<Done>.
template <class Source, class Put>
Result<Done> read_records(Source& source, const Element& element, const Slots& slots,
                          Progress& progress, const Put& put)
{
    if (element.properties.empty()) { return Done{}; }  // takes no bytes, whatever its count
    Row row{};
    for (std::uint64_t i = 0; i < element.count; ++i) {
        if (i % block == 0 && progress.stopped()) { return cancelled(); }
        source.begin_record();
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const Property& property = element.properties[p];
            std::uint64_t length = 1;
            if (property.count) {
                const std::optional<double> count = source.next(*property.count);
                if (!count) { return source.failure(); }
                if (*count < 0.0) {
                    return source.error(Fault::MalformedBody, "a list of negative length");
                }
                length = static_cast<std::uint64_t>(*count);
            }
            if (!slots[p]) {
                if (!source.skip(property.type, length)) { return source.failure(); }
                continue;
            }
            const std::optional<double> value = source.next(property.type);
            if (!value) { return source.failure(); }
            row[*slots[p]] = *value;
        }
        if (!source.end_record()) { return source.failure(); }
        Result<Done> stored = put(i, row);
        if (!stored) { return stored; }
    }
    return Done{};
}

template <class Source>
Result<Done> skip_element(Source& source, const Element& element, Progress& progress)
{
    return read_records(source, element, Slots(element.properties.size()), progress,
                        [](std::uint64_t, const Row&) -> Result<Done> { return Done{}; });
}

/// Vertices of a fixed size, column by column in blocks that stay in the cache.
template <bool Swap>
Result<Done> read_fixed_vertices(BinarySource<Swap>& source, const Element& vertex,
                                 std::size_t stride, VertexSink& sink, Mesh& mesh,
                                 Progress& progress)
{
    constexpr std::size_t block_rows = 1024;
    std::vector<Row> rows(block_rows);
    for (std::size_t first = 0; first < vertex.count; first += block_rows) {
        if (first % block == 0 && progress.stopped()) { return cancelled(); }
        const std::size_t n = std::min<std::size_t>(block_rows, vertex.count - first);
        const std::byte* column = source.data();
        for (std::size_t p = 0; p < vertex.properties.size(); ++p) {
            const Scalar type = vertex.properties[p].type;
            if (const std::optional<std::size_t> slot = sink.slots()[p]) {
                with_type(type, [&](auto zero) {
                    for (std::size_t i = 0; i < n; ++i) {
                        rows[i][*slot] =
                            static_cast<double>(load<decltype(zero), Swap>(column + i * stride));
                    }
                });
            }
            column += size_of(type);
        }
        const auto refused = sink.put(mesh, first, std::span(rows).first(n));
        source.advance((refused ? refused->row : n) * stride);
        if (refused) {
            source.begin_record();
            return source.error(refused->fault, refused->detail);
        }
    }
    return Done{};
}

template <class Source>
Result<Done> read_vertices(Source& source, const Element& vertex, VertexSink& sink, Mesh& mesh,
                           Progress& progress)
{
    sink.reserve(mesh, vertex.count);
    if constexpr (!std::is_same_v<Source, TextSource>) {
        if (const auto stride = vertex.stride()) {
            // Lists ahead of the vertices may have used up what check_counts saw.
            if (vertex.count > source.remaining() / *stride) {
                source.begin_record();
                return source.error(Fault::Truncated, "the file ends before all its vertices");
            }
            return read_fixed_vertices(source, vertex, *stride, sink, mesh, progress);
        }
    }
    const auto put = [&](std::uint64_t i, const Row& row) -> Result<Done> {
        const auto refused = sink.put(mesh, i, std::span(&row, 1));
        if (refused) { return source.error(refused->fault, refused->detail); }
        return Done{};
    };
    return read_records(source, vertex, sink.slots(), progress, put);
}

template <class Source>
Result<Done> read_faces(Source& source, const Element& face, const FaceLayout& layout, Mesh& mesh,
                        std::uint64_t vertices, Progress& progress)
{
    std::uint64_t first = 0;
    if constexpr (std::is_same_v<Source, BinarySource<false>>) {
        if (const auto stride = plain_triangle_stride(face, layout)) {
            first = take_triangles({source.data(), source.remaining()}, face, layout, mesh,
                                   vertices, progress);
            source.advance(first * *stride);
        }
    }
    return FaceReader<Source>(source, face, layout, mesh, vertices).read(first, progress);
}

/// The body, element by element in the header's order.
template <class Source>
Result<Done> read_body(Source source, const Header& header, VertexSink& sink,
                       const std::optional<FaceLayout>& layout, Mesh& mesh, Progress& progress)
{
    const std::uint64_t vertices = header.find("vertex")->count;
    for (const Element& element : header.elements) {
        Result<Done> read = Done{};
        if (element.name == "vertex") {
            read = read_vertices(source, element, sink, mesh, progress);
        } else if (element.name == "face" && layout) {
            read = read_faces(source, element, *layout, mesh, vertices, progress);
        } else {
            read = skip_element(source, element, progress);
        }
        if (!read) { return read; }
    }
    if (!source.only_blanks_follow()) {
        return source.error(Fault::MalformedBody,
                            "more bytes follow the last record that the header announces: a count, "
                            "a type or the byte order in the header is wrong");
    }
    return Done{};
}

}  // namespace
}  // namespace ply

Result<Mesh> read_ply(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
{
    const Result<ply::Header> header = ply::read_header(file);
    if (!header) { return header.error(); }
    const auto refuse = [&](Fault fault, std::string detail) {
        return Error{fault, std::move(detail), {}, header->body_line - 1, {}};
    };
    const ply::Element* const vertex = header->find("vertex");
    if (vertex == nullptr) { return refuse(Fault::MalformedHeader, "no vertex element"); }
    const ply::Element* const strips = header->find("tristrips");
    if (strips != nullptr && strips->count > 0) {
        return refuse(Fault::MalformedHeader,
                      "triangle strips are not read; write the faces as an element face with a "
                      "list vertex_indices");
    }
    Result<ply::VertexSink> sink = ply::VertexSink::of(*vertex);
    if (!sink) { return refuse(sink.error().fault, sink.error().detail); }
    std::optional<ply::FaceLayout> layout;  // stays empty without faces: a point cloud
    const ply::Element* const face = header->find("face");
    if (face != nullptr && face->count > 0) {
        const Result<ply::FaceLayout> found = ply::layout_of(*face);
        if (!found) { return refuse(found.error().fault, found.error().detail); }
        layout = *found;
    } else {
        sink->allow_absent();
    }
    const Result<Done> counts = ply::check_counts(*header, file.size(), limits);
    if (!counts) { return counts.error(); }
    if (vertex->count == 0) { return refuse(Fault::NoGeometry, "the file has no vertices"); }

    Mesh mesh;
    mesh.format = "ply";
    mesh.notes = ply::skipped_notes(*header);
    const auto read = [&](auto source) {
        return ply::read_body(std::move(source), *header, *sink, layout, mesh, progress);
    };
    using ply::Encoding;
    const Result<Done> body = header->encoding == Encoding::Ascii
                                  ? read(ply::TextSource(file, *header))
                              : header->encoding == Encoding::BinaryLittleEndian
                                  ? read(ply::BinarySource<false>(file, *header))
                                  : read(ply::BinarySource<true>(file, *header));
    if (!body) { return body.error(); }
    if (auto failure = place_absent(mesh)) { return std::move(*failure); }
    sink->finish(mesh, header->encoding);
    return mesh;
}

}  // namespace relight
