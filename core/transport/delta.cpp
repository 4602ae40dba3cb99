#include <algorithm>
#include <limits>
#include <memory>

#include "core/transport/column.h"
#include "core/transport/delta_rays.h"

namespace relight {
namespace {

DeltaGeometry geometry_of(const Source& source)
{
    const TransportOptions& options = source.scene.transport;
    const Bvh& bvh = *source.stage.bvh;
    DeltaGeometry light;
    if (const auto* sun = std::get_if<DirectionalLight>(&source.light.shape)) {
        light.distant = true;
        light.wi = -sun->travel;
    } else if (const auto* point = std::get_if<PointLight>(&source.light.shape)) {
        light.place = point->position;
    } else if (const auto* spot = std::get_if<SpotLight>(&source.light.shape)) {
        light.place = spot->position;
    } else if (const auto* web = std::get_if<IesLight>(&source.light.shape)) {
        light.place = web->position;
    }
    light.two_sided = options.two_sided;
    light.length_unit_m = source.scene.length_unit_m;
    light.reach = options.max_distance.value_or(std::numeric_limits<double>::infinity());
    light.box = bvh.box();
    light.clearance = bvh.clearance();
    return light;
}

void take(const Stage& stage, Vertices vertices, DeltaBlock& block)
{
    const Surface& surface = *stage.surface;
    block.count = vertices.size();
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const std::size_t v = vertices[i];
        const Point3& p = stage.mesh->positions[v];
        const Dir3& n = surface.normals[v];
        block.p_x[i] = p.x;
        block.p_y[i] = p.y;
        block.p_z[i] = p.z;
        block.n_x[i] = n.x();
        block.n_y[i] = n.y();
        block.n_z[i] = n.z();
        block.spacing[i] = static_cast<double>(surface.spacing[v]);
    }
}

/// light_up() one by one, and its reference.
std::size_t light_up_plainly(const Source& source, Vertices vertices, DeltaBlock& block,
                             ShadowStream* rays)
{
    const Stage& stage = source.stage;
    const TransportOptions& options = source.scene.transport;
    std::size_t count = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Receiver receiver = vertex_receiver(stage, vertices[i]);
        const Arrival arrival = arrive(source.light.shape, receiver.p);
        const double cos_n = dot(receiver.frame.n, arrival.wi);
        const double cos_i = options.two_sided ? std::abs(cos_n) : cos_n;
        const bool faces = cos_i > 0.0;  // behind the surface: no light, no ray
        block.faces[i] = faces ? 1.0F : 0.0F;
        block.E[i] =
            faces ? static_cast<float>(cos_i * per_unit_m2(arrival, source.scene.length_unit_m))
                  : 0.0F;
        if (rays == nullptr) { continue; }
        if (faces) {
            rays->put(shadow_ray(*stage.bvh, receiver, arrival.wi, arrival.distance, options));
            ++count;
        } else {
            rays->pass_over();
        }
    }
    return count;
}

}  // namespace

void fill_delta(const Source& source, Vertices vertices, Column& column)
{
    const LightShape& shape = source.light.shape;
    const DeltaGeometry light = geometry_of(source);
    const auto* point = std::get_if<PointLight>(&shape);
    const bool inverse_square = light.distant || (point != nullptr && !point->range);
    ShadowStream stream(*source.stage.bvh);
    ShadowStream* rays = source.shadowed() ? &stream : nullptr;
    DeltaBlock block;
    for (std::size_t begin = 0; begin < vertices.size(); begin += DeltaBlock::capacity) {
        const Vertices some =
            vertices.subspan(begin, std::min(DeltaBlock::capacity, vertices.size() - begin));
        take(source.stage, some, block);
        if (is_moderate(light, block)) {
            for (std::size_t i = 0; !inverse_square && i < some.size(); ++i) {
                block.per_unit[i] = arrive(shape, source.stage.mesh->positions[some[i]]).per_unit;
            }
            column.rays += light_up(light, inverse_square, block, rays);
        } else {
            column.rays += light_up_plainly(source, some, block, rays);
        }
        const auto blocked = stream.trace();
        for (std::size_t i = 0; i < blocked.size(); ++i) {
            if (blocked[i] != 0) { block.E[i] = block.faces[i] = 0.0F; }
        }
        std::copy_n(block.E.begin(), some.size(), &column.E[begin]);
        std::copy_n(block.faces.begin(), some.size(), &column.visible.share[begin]);
    }
}

}  // namespace relight
