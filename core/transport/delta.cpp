#include <algorithm>
#include <bit>
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
void light_up_plainly(const Source& source, std::span<const std::uint32_t> vertices,
                      RayFields::Field<float>& E, ShadowStream* rays)
{
    const Stage& stage = source.stage;
    const TransportOptions& options = source.scene.transport;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Receiver receiver = vertex_receiver(stage, vertices[i]);
        const Arrival arrival = arrive(source.light.shape, receiver.p);
        const double cos_n = dot(receiver.frame.n, arrival.wi);
        const double cos_i = options.two_sided ? std::abs(cos_n) : cos_n;
        const bool faces = cos_i > 0.0;  // behind the surface: no light, no ray
        E[i] = faces ? static_cast<float>(cos_i * per_unit_m2(arrival, source.scene.length_unit_m))
                     : -0.0F;
        if (rays != nullptr && faces) {
            rays->put(shadow_ray(*stage.bvh, receiver, arrival.wi, arrival.distance, options));
        }
    }
}

}  // namespace

std::uint64_t fill_delta(const Source& source, Vertices vertices, std::size_t first_id,
                         std::span<float> E)
{
    const LightShape& shape = source.light.shape;
    const DeltaGeometry light = geometry_of(source);
    const auto* point = std::get_if<PointLight>(&shape);
    const bool inverse_square = light.distant || (point != nullptr && !point->range);
    ShadowStream stream(*source.stage.bvh);
    ShadowStream* rays = source.shadowed() ? &stream : nullptr;
    RayFields::Field<double> per_unit;
    RayFields::Field<float> open;
    std::uint64_t traced = 0;
    constexpr std::size_t block = ShadowStream::capacity;
    for (std::size_t begin = 0; begin < vertices.size(); begin += block) {
        const std::size_t first = vertices.first + begin;
        const auto ids = vertices.ids.subspan(begin, std::min(block, vertices.size() - begin));
        for (std::size_t i = 0; !inverse_square && i < ids.size(); ++i) {
            per_unit[i] = arrive(shape, vertices.fields->p(first + i)).per_unit;
        }
        if (!light_up(light, *vertices.fields, first, ids.size(),
                      inverse_square ? nullptr : &per_unit, open, rays)) {
            light_up_plainly(source, ids, open, rays);
        }
        const auto blocked = stream.trace();
        traced += blocked.size();
        // What faces the light has an answer, in order. In integers: a branch is guessed wrong
        // here.
        const std::uint8_t none = 0;
        const std::uint8_t* next = rays == nullptr ? &none : blocked.data();
        const std::uint32_t step = rays == nullptr ? 0 : 1;
        for (std::size_t i = 0; i < ids.size(); ++i) {
            const auto bits = std::bit_cast<std::uint32_t>(open[i]);
            const std::uint32_t faces = ~bits >> 31U;
            const std::uint32_t hidden = faces & *next;
            E[ids[i] - first_id] = std::bit_cast<float>((bits & (hidden - 1U)) | hidden << 31U);
            next += faces & step;
        }
    }
    return traced;
}

}  // namespace relight
