#include "core/transport/source.h"

#include <bit>
#include <variant>

namespace relight {

std::uint64_t key_of(const Receiver& receiver)
{
    std::uint64_t key = 0;
    const Vec3 n = receiver.frame.n;
    for (const double x : {receiver.p.x, receiver.p.y, receiver.p.z, n.x, n.y, n.z}) {
        key = sobol::mix(key, std::bit_cast<std::uint64_t>(x + 0.0));  // -0 is 0
    }
    return key;
}

bool is_even_sky(const LightShape& shape)
{
    const auto* sky = std::get_if<EnvironmentLight>(&shape);
    return sky != nullptr && (!sky->map || sky->map->is_even());
}

ShadowRay ray_toward(const Source& source, const Receiver& receiver, const LightSample& there)
{
    const Bvh& bvh = *source.stage.bvh;
    const bool on_mesh = std::holds_alternative<MeshLight>(source.light.shape);
    const double distance = on_mesh ? short_of_face(bvh, there.distance) : there.distance;
    return shadow_ray(bvh, receiver, there.wi, distance, source.scene.transport);
}

}  // namespace relight
