#include "core/io/ply_vertices.h"

#include <cmath>
#include <limits>

#include "core/geometry/precision.h"
#include "core/io/coordinate.h"
#include "core/io/ply_checks.h"
#include "core/io/readers.h"
#include "core/io/srgb_codes.h"
#include "core/io/text_scanner.h"

namespace relight::ply {
namespace {

using Names = std::span<const std::string_view>;

constexpr std::string_view position_names[] = {"x", "y", "z"};
constexpr std::string_view normal_names[] = {"nx", "ny", "nz"};
constexpr std::string_view color_names[][3] = {
    {"red", "green", "blue"}, {"r", "g", "b"}, {"diffuse_red", "diffuse_green", "diffuse_blue"}};
constexpr std::string_view uv_names[][2] = {
    {"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}};

/// Largest code of an unsigned type of 8 or 16 bits, which stands for 1.
std::optional<std::size_t> full_scale(Scalar type)
{
    if (type == Scalar::U8) { return 255; }
    if (type == Scalar::U16) { return 65535; }
    return {};
}

VertexSink::Refusal refusal(std::size_t index, std::size_t row, const Row& values)
{
    const std::string place = "vertex " + std::to_string(index);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(values[axis])) {
            return {row, Fault::NonFiniteCoordinate,
                    place + " has a coordinate " + "xyz"[axis] + " that is not a finite number"};
        }
    }
    return {row, Fault::CoordinateTooLarge,
            place + " has a coordinate beyond 1e15; move or scale the mesh"};
}

}  // namespace

bool VertexSink::bind(const Element& vertex, Names names, std::size_t slot)
{
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::optional<std::size_t> place = vertex.find(names[i]);
        if (!place || vertex.properties[*place].count) { return false; }
        places.push_back(*place);
    }
    for (std::size_t i = 0; i < places.size(); ++i) { slots_[places[i]] = slot + i; }
    return true;
}

void VertexSink::bind_colors(const Element& vertex)
{
    for (const Names names : color_names) {
        const std::optional<std::size_t> red = vertex.find(names[0]);
        if (!red) { continue; }
        const Scalar type = vertex.properties[*red].type;
        const std::optional<std::size_t> largest = full_scale(type);
        bool same = largest || !is_integer(type);
        for (std::size_t i = 1; i < 3; ++i) {
            const std::optional<std::size_t> other = vertex.find(names[i]);
            same = same && other && vertex.properties[*other].type == type;
        }
        if (!same) {
            notes_.emplace_back(
                "colours left out: they need three channels of one type among "
                "uchar, ushort (sRGB) and float, double (linear)");
            continue;
        }
        colors_ = bind(vertex, names, color_slot);
        if (colors_ && largest) { color_table_ = decoded_srgb(*largest); }
        if (colors_) { return; }
    }
}

void VertexSink::bind_uvs(const Element& vertex)
{
    for (const Names names : uv_names) {
        uvs_ = bind(vertex, names, uv_slot);
        if (!uvs_) { continue; }
        const Scalar type = vertex.properties[*vertex.find(names[0])].type;
        if (const auto largest = full_scale(type)) {
            uv_scale_ = 1.0 / static_cast<double>(*largest);
        }
        return;
    }
}

Result<VertexSink> VertexSink::of(const Element& vertex)
{
    VertexSink sink;
    sink.slots_.resize(vertex.properties.size());
    if (!sink.bind(vertex, position_names, position_slot)) {
        return Error{Fault::MalformedHeader,
                     "the vertex element needs the scalar properties x, y and z",
                     {},
                     {},
                     {}};
    }
    sink.normals_ = sink.bind(vertex, normal_names, normal_slot);
    sink.bind_colors(vertex);
    sink.bind_uvs(vertex);
    std::vector<bool> used;
    for (std::size_t i = 0; i < sink.slots_.size(); ++i) {
        const std::optional<std::size_t> slot = sink.slots_[i];
        used.push_back(slot.has_value());
        const Scalar type = vertex.properties[i].type;
        const bool wide = type == Scalar::F64 || type == Scalar::I32 || type == Scalar::U32;
        if (slot && *slot < normal_slot && wide) { sink.float_positions_ = false; }
    }
    if (auto note = skipped_note(vertex, used)) { sink.notes_.push_back(std::move(*note)); }
    return sink;
}

void VertexSink::reserve(Mesh& mesh, std::size_t count) const
{
    mesh.positions.reserve(count);
    if (normals_) { mesh.normals.reserve(count); }
    if (colors_) { mesh.colors.reserve(count); }
    if (uvs_) { mesh.uvs.reserve(count); }
}

void VertexSink::resize(Mesh& mesh, std::size_t count) const
{
    mesh.positions.resize(count);
    if (normals_) { mesh.normals.resize(count); }
    if (colors_) { mesh.colors.resize(count); }
    if (uvs_) { mesh.uvs.resize(count); }
}

/// A normal, colour or texture coordinate that is no float is no reason to refuse a scan, but must
/// not come out of it either.
float VertexSink::finite_or_zero(double value)
{
    if (std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max())) {
        return static_cast<float>(value);
    }
    ++non_finite_;
    return 0.0F;
}

std::optional<VertexSink::Refusal> VertexSink::put(Mesh& mesh, std::size_t first,
                                                   std::span<const Row> rows)
{
    resize(mesh, first + rows.size());  // no more than this: the zeros are still in the cache
    bool good = true;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        mesh.positions[first + i] = {rows[i][0], rows[i][1], rows[i][2]};
        good = good & is_placed(mesh.positions[first + i]);
    }
    for (std::size_t i = 0; !good && i < rows.size(); ++i) {
        const Point3 p = mesh.positions[first + i];
        if (is_placed(p)) { continue; }
        if (!absent_allowed_ || !is_absent(p)) { return refusal(first + i, i, rows[i]); }
        mesh.absent.push_back(static_cast<std::uint32_t>(first + i));
    }
    for (std::size_t i = 0; normals_ && i < rows.size(); ++i) {
        const Vec3 n{rows[i][normal_slot], rows[i][normal_slot + 1], rows[i][normal_slot + 2]};
        mesh.normals[first + i] = is_finite(n) ? n : Vec3{};
        if (!is_finite(n)) { ++non_finite_; }
    }
    for (std::size_t i = 0; colors_ && i < rows.size(); ++i) {
        for (std::size_t band = 0; band < 3; ++band) {
            const double value = rows[i][color_slot + band];
            mesh.colors[first + i][band] = color_table_.empty()
                                               ? finite_or_zero(value)
                                               : color_table_[static_cast<std::size_t>(value)];
        }
    }
    for (std::size_t i = 0; uvs_ && i < rows.size(); ++i) {
        mesh.uvs[first + i] = {finite_or_zero(rows[i][uv_slot] * uv_scale_),
                               finite_or_zero(rows[i][uv_slot + 1] * uv_scale_)};
    }
    return {};
}

void VertexSink::finish(Mesh& mesh, Encoding encoding) const
{
    if (!float_positions_) {
        mesh.double_positions = float_loses(mesh.positions);
    } else if (encoding == Encoding::Ascii) {
        mesh.double_positions = float_loses_text(mesh.positions);
    }
    mesh.notes.insert(mesh.notes.end(), notes_.begin(), notes_.end());
    if (non_finite_ > 0) {
        mesh.notes.push_back(std::to_string(non_finite_) +
                             " normals, colour or texture values were not finite: read as 0");
    }
}

}  // namespace relight::ply
