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

/// light_up() one by one, and its reference.
std::size_t light_up_plainly(const Source& source, std::span<const std::uint32_t> vertices,
                             RayFields::Field<float>& E, ShadowStream* rays)
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
        E[i] = faces ? static_cast<float>(cos_i * per_unit_m2(arrival, source.scene.length_unit_m))
                     : -0.0F;
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
    RayFields::Field<double> per_unit;
    RayFields::Field<float> E;
    constexpr std::size_t block = ShadowStream::capacity;
    for (std::size_t begin = 0; begin < vertices.size(); begin += block) {
        const std::size_t first = vertices.first + begin;
        const std::size_t count = std::min(block, vertices.size() - begin);
        for (std::size_t i = 0; !inverse_square && i < count; ++i) {
            per_unit[i] = arrive(shape, vertices.fields->p(first + i)).per_unit;
        }
        const auto lit = light_up(light, *vertices.fields, first, count,
                                  inverse_square ? nullptr : &per_unit, E, rays);
        column.rays +=
            lit ? *lit : light_up_plainly(source, vertices.ids.subspan(begin, count), E, rays);
        const auto blocked = stream.trace();
        for (std::size_t i = 0; i < blocked.size(); ++i) { E[i] = blocked[i] != 0 ? -0.0F : E[i]; }
        std::copy_n(E.begin(), count, &column.E[begin]);
    }
}

}  // namespace relight
