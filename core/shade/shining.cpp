#include "core/shade/shining.h"

#include <algorithm>
#include <cmath>

namespace relight {
namespace {

using kernel::Block;
using kernel::block_size;

// The kernels read places and directions as rows of three numbers.
static_assert(sizeof(Point3) == 3 * sizeof(double) && sizeof(Dir3) == 3 * sizeof(double));

void copy(double (&to)[3], Vec3 from)
{
    to[0] = from.x;
    to[1] = from.y;
    to[2] = from.z;
}

void fill(double (&rows)[3][block_size], std::size_t i, Vec3 value)
{
    rows[0][i] = value.x;
    rows[1][i] = value.y;
    rows[2][i] = value.z;
}
void fill_all(double (&rows)[3][block_size], std::size_t count, Vec3 value)
{
    std::fill_n(rows[0], count, value.x);
    std::fill_n(rows[1], count, value.y);
    std::fill_n(rows[2], count, value.z);
}

Vec3 vec(Rgb c)
{
    return {c.r, c.g, c.b};
}

kernel::Viewer viewer_of(const Scene& scene)
{
    using Place = kernel::Viewer::Place;
    kernel::Viewer viewer;
    viewer.two_sided = scene.transport.two_sided;
    if (const auto* direction = std::get_if<DirectionView>(&scene.view)) {
        viewer.place = Place::Direction;
        copy(viewer.at, direction->toward_viewer);
    } else if (std::holds_alternative<CameraView>(scene.view)) {
        viewer.place = Place::Point;
        copy(viewer.at, scene.camera.eye - Point3{});
    }
    return viewer;
}

/// Of a delta light.
kernel::Source source_of(const LightShape& shape)
{
    kernel::Source source;
    if (const auto* sun = std::get_if<DirectionalLight>(&shape)) {
        source.is_direction = true;
        copy(source.at, -sun->travel);
    } else if (const auto* point = std::get_if<PointLight>(&shape)) {
        copy(source.at, point->position - Point3{});
    } else if (const auto* spot = std::get_if<SpotLight>(&shape)) {
        copy(source.at, spot->position - Point3{});
    } else if (const auto* ies = std::get_if<IesLight>(&shape)) {
        copy(source.at, ies->position - Point3{});
    }
    return source;
}

/// The base colour of a model, or that it is the vertex' own.
struct Base {
    Rgb color;
    bool from_vertex = false;
};
struct BaseOf {
    template <class Diffuse>
    Base operator()(const Diffuse& m) const
    {
        return {m.albedo, m.albedo_from_vertex};
    }
    Base operator()(const Principled& m) const { return {m.base_color, m.base_color_from_vertex}; }
    Base operator()(const MetallicRoughness& m) const
    {
        return {m.base_color, m.base_color_from_vertex};
    }
};

}  // namespace

Shining::Shining(const Stage& stage, const Transport& transport, const Scene& scene,
                 std::size_t first)
    : stage_(stage),
      viewer_(viewer_of(scene)),
      both_sides_(viewer_.two_sided && viewer_.place == kernel::Viewer::Place::AlongNormal),
      first_(first)
{
    for (std::size_t l = 0; l < transport.columns.size(); ++l) {
        if (transport.columns[l] == nullptr) { continue; }
        const Light& light = scene.lights[l];
        Part part{l, transport.columns[l].get(), nullptr, is_delta(light.shape), {}, {}};
        const Column* drawn = transport.drawn.empty() ? nullptr : transport.drawn[l].get();
        if (drawn != nullptr && !drawn->Lo.empty()) { part.Lo = drawn->Lo.data(); }
        copy(part.power, vec(light.power));
        if (part.delta) { part.source = source_of(light.shape); }
        parts_.push_back(part);
    }
}

void Shining::albedo(Block& block, const Material& material, std::size_t begin,
                     std::size_t count) const
{
    block.count = count;
    fill_rho(block, material, begin);
    // Along the normal every vertex is seen that has E.
    if (viewer_.place == kernel::Viewer::Place::AlongNormal) { return; }
    look(block, begin);
    kernel::mask_rho(block);
}

void Shining::begin(Block& block, const Material& material, const kernel::Reflector& reflector,
                    std::size_t begin, std::size_t count) const
{
    block.count = count;
    look(block, begin);
    fill_rho(block, material, begin);
    if (reflector.anisotropic) { fill_axes(block, reflector.turn, begin); }
    kernel::prepare(block, reflector);
    fill_all(block.L, count, {});
    if (emission(material) == Rgb{}) { return; }
    for (std::size_t i = 0; i < count; ++i) {
        fill(block.L, i, vec(own(block, material, begin, i)));
    }
}

void Shining::add(Block& block, const kernel::Reflector& reflector, const Part& part,
                  std::size_t begin) const
{
    if (part.delta) { kernel::reflect(block, reflector, part.source, both_sides_); }
    kernel::add_light(block, part.power, part.Lo, part.delta ? part.column->E.data() : nullptr,
                      begin - first_);
}

void Shining::look(Block& block, std::size_t begin) const
{
    kernel::look(block, viewer_, reinterpret_cast<const double*>(stage_.mesh->positions.data()),
                 reinterpret_cast<const double*>(stage_.surface->normals.data()), begin);
}

/// Seen fronts alone shine.
Rgb Shining::own(const Block& block, const Material& material, std::size_t begin,
                 std::size_t i) const
{
    const Vec3 n{block.n[0][i], block.n[1][i], block.n[2][i]};
    const bool front = dot(n, stage_.surface->normals[begin + i]) > 0.0;
    return front && block.cos_o[i] > 0.0 ? emission(material, block.cos_o[i]) : Rgb{};
}

void Shining::fill_rho(Block& block, const Material& material, std::size_t begin) const
{
    const Base base = std::visit(BaseOf{}, material);
    if (!base.from_vertex) { return fill_all(block.rho, block.count, vec(base.color)); }
    for (std::size_t i = 0; i < block.count; ++i) {
        fill(block.rho, i, vec(vertex_color(stage_, begin + i)));
    }
}

/// The tangent frame on the side that is seen, turned about its normal.
void Shining::fill_axes(Block& block, double turn, std::size_t begin) const
{
    const double c = std::cos(turn), s = std::sin(turn);
    for (std::size_t i = 0; i < block.count; ++i) {
        const Frame frame = shading_frame(*stage_.surface, begin + i);
        const Vec3 n{block.n[0][i], block.n[1][i], block.n[2][i]};
        const Vec3 x = frame.x, y = dot(n, frame.n) < 0.0 ? Vec3(-frame.y) : Vec3(frame.y);
        fill(block.x, i, x * c + y * s);
        fill(block.y, i, y * c - x * s);
    }
}

}  // namespace relight
