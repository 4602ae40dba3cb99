#include "core/transport/gather.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/warp.h"

namespace relight {

Rgb Response::value(Vec3 wi) const
{
    if (two_sided_) { wi.z = std::abs(wi.z); }
    if (!(wi.z > 0.0)) { return {}; }
    return material_ == nullptr ? Rgb::grey(wi.z) : f(*material_, wi, wo_, color_).value * wi.z;
}

double Response::pdf(Vec3 wi) const
{
    if (two_sided_) { wi.z = std::abs(wi.z); }
    const double above = material_ == nullptr ? warp::cosine_hemisphere_pdf(wi.z)
                                              : relight::pdf(*material_, wi, wo_, color_);
    return two_sided_ ? 0.5 * above : above;
}

Vec3 Response::sample(Sample2 s, Sample2 pick) const
{
    Vec3 wi = material_ == nullptr ? warp::cosine_hemisphere(s)
                                   : relight::sample(*material_, wo_, color_, s, pick.u).wi;
    if (two_sided_) { wi.z = std::copysign(wi.z, pick.v - 0.5); }
    return wi;
}

bool is_found_by_light_alone(const Source& source)
{
    return std::holds_alternative<MeshLight>(source.light.shape) &&
           (!source.shadowed() || source.scene.transport.max_distance.has_value());
}

void gather_direct(const Source& source, const Receiver& receiver, const LightView& view,
                   const Response& response, const Sequence& sequence, unsigned begin, unsigned end,
                   Rgb& lit, Unblocked* seen, RayQueue& queue)
{
    const LightShape& shape = source.light.shape;
    const auto* faces = std::get_if<MeshLight>(&shape);
    const bool shadowed = source.shadowed();
    const bool response_only = is_even_sky(shape);
    const bool light_only = faces != nullptr && is_found_by_light_alone(source);
    const bool parts = faces != nullptr || std::holds_alternative<SkyLight>(shape);
    const double share = light_only || response_only ? 1.0 : 0.5;  // of the points, each way
    const auto density = [&](double by_light, double by_response) {
        return (response_only ? 0.0 : share * by_light) + (light_only ? 0.0 : share * by_response);
    };
    const auto deposit = [&](const LightSample& there, Rgb value) {
        if (is_black(value)) { return; }
        if (seen != nullptr) { seen->total += luminance(value); }
        const Deposit one{&lit, value, seen != nullptr ? &seen->open : nullptr};
        if (!shadowed) { return one.give(); }
        queue.ask(ray_toward(source, receiver, there), one);
    };
    for (unsigned point = begin; point < end; ++point) {
        // Each way takes the points of its sequence in their order: its own net.
        const unsigned i = light_only || response_only ? point : point / 2;
        if (!response_only && (light_only || point % 2 == 0)) {
            const double pick = parts ? sequence.at(i, light_pick).u : 0.0;
            const LightSample there = sample(view, sequence.at(i, light_pair), pick);
            if (!there.wi) { continue; }
            const Vec3 wi = receiver.frame.to_local(there.wi);
            const Rgb value = there.L * response.value(wi);
            if (is_black(value)) { continue; }
            deposit(there, ratio(value, density(there.pdf, light_only ? 0.0 : response.pdf(wi))));
            continue;
        }
        const Vec3 local =
            response.sample(sequence.at(i, response_pair),
                            response.picks() ? sequence.at(i, response_pick) : Sample2{});
        const double by_response = response.pdf(local);
        const Dir3 wi = normalize(receiver.frame.to_world(local));
        if (!(by_response > 0.0) || !wi) { continue; }
        const LightSample there =
            faces == nullptr ? look(view, wi)
                             : faces->table->look_along(ray_start(receiver, wi), receiver.p, wi);
        if (is_black(there.L)) { continue; }
        deposit(there, ratio(there.L * response.value(local), density(there.pdf, by_response)));
    }
}

}  // namespace relight
