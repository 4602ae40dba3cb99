#include "core/shade/shining.h"

#include <algorithm>

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

void set(double (&rows)[3][block_size], std::size_t i, Vec3 value)
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
      scene_(scene),
      first_(first),
      view_{reinterpret_cast<const double*>(stage.mesh->positions.data() + first),
            reinterpret_cast<const double*>(stage.surface->normals.data() + first),
            viewer_of(scene)}
{
    for (std::size_t l = 0; l < transport.columns.size(); ++l) {
        if (transport.columns[l] == nullptr) { continue; }
        const Light& light = scene.lights[l];
        kernel::Share share;
        copy(share.power, vec(light.power));
        const Column* drawn = transport.drawn.empty() ? nullptr : transport.drawn[l].get();
        if (drawn != nullptr && !drawn->Lo.empty()) { share.Lo = drawn->Lo.data(); }
        if (is_delta(light.shape)) {
            share.E = transport.columns[l]->E.data();
            share.source = source_of(light.shape);
        }
        shares_.push_back(share);
        lights_.push_back(l);
    }
}

void Shining::fill_rho(Block& block, const Material& material, std::size_t begin,
                       std::size_t count) const
{
    const Base base = std::visit(BaseOf{}, material);
    if (!base.from_vertex) {
        const auto is_there = [&] {
            return Rgb{block.rho[0][0], block.rho[1][0], block.rho[2][0]} == base.color;
        };
        if (count <= block.of_one_rho && is_there()) { return; }
        fill_all(block.rho, count, vec(base.color));
        block.of_one_rho = count;
        return;
    }
    block.of_one_rho = 0;
    for (std::size_t i = 0; i < count; ++i) {
        set(block.rho, i, vec(vertex_color(stage_, first_ + begin + i)));
    }
}

void Shining::fill(Block& block, const Material& material, const kernel::Reflector& reflector,
                   std::size_t begin, std::size_t count) const
{
    fill_rho(block, material, begin, count);
    if (count > block.dark) { fill_all(block.L, count, {}); }
    block.dark = std::max(block.dark, count);
    if (emission(material) != Rgb{}) {
        block.dark = 0;
        for (std::size_t i = 0; i < count; ++i) {
            set(block.L, i, vec(own(material, first_ + begin + i)));
        }
    }
    if (!reflector.anisotropic) { return; }
    for (std::size_t i = 0; i < count; ++i) {
        const Frame frame = shading_frame(*stage_.surface, first_ + begin + i);
        set(block.x, i, frame.x);
        set(block.y, i, frame.y);
    }
}

kernel::Task Shining::task(const kernel::Reflector& reflector,
                           std::span<const kernel::Share> shares, float* radiance) const
{
    const bool along = view_.viewer.place == kernel::Viewer::Place::AlongNormal;
    return {&reflector, &view_, along && view_.viewer.two_sided, shares, radiance};
}

/// Seen fronts alone shine.
Rgb Shining::own(const Material& material, std::size_t vertex) const
{
    const auto seen = seen_vertex(stage_, scene_, vertex);
    const bool front = seen && dot(seen->receiver.frame.n, stage_.surface->normals[vertex]) > 0.0;
    return front ? emission(material, seen->wo.z) : Rgb{};
}

}  // namespace relight
