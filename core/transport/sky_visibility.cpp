#include <array>
#include <numbers>

#include "core/base/warp.h"
#include "core/transport/column.h"

namespace relight {
namespace {

constexpr std::size_t coefficients = 9;
constexpr std::size_t enough_rays = 8192;          // traced together
constexpr std::uint64_t sky_number = 1ULL << 32U;  // no light's number

/// Real spherical harmonics up to degree 2.   Sloan 2008, app. A2
std::array<double, coefficients> harmonics(Vec3 w)
{
    return {0.28209479177387814,
            0.4886025119029199 * w.y,
            0.4886025119029199 * w.z,
            0.4886025119029199 * w.x,
            1.0925484305920792 * w.x * w.y,
            1.0925484305920792 * w.y * w.z,
            0.31539156525252005 * (3.0 * w.z * w.z - 1.0),
            1.0925484305920792 * w.x * w.z,
            0.5462742152960396 * (w.x * w.x - w.y * w.y)};
}

/// int cos Y_lm over the hemisphere of n = A_l Y_lm(n), A = pi, 2 pi / 3, pi / 4.
std::array<double, coefficients> open_transfer(Dir3 n)
{
    constexpr double pi = std::numbers::pi;
    auto T = harmonics(n);
    for (std::size_t k = 0; k < coefficients; ++k) {
        T[k] *= k == 0 ? pi : k < 4 ? 2.0 * pi / 3.0 : pi / 4.0;
    }
    return T;
}

}  // namespace

SkyVisibility sky_visibility(const Stage& stage, const Scene& scene, bool sh, std::size_t begin,
                             std::size_t end)
{
    const std::size_t count = end - begin;
    SkyVisibility sky;
    sky.ambient_occlusion.resize(count);
    if (sh) { sky.sh.resize(count * coefficients); }
    const unsigned samples = budget_of(scene.transport.samples).samples();
    std::vector<ShadowRay> rays;
    std::vector<std::uint8_t> blocked;
    const auto write_sh = [&](std::size_t i, const std::array<double, coefficients>& T) {
        for (std::size_t k = 0; k < coefficients; ++k) {
            sky.sh[i * coefficients + k] = static_cast<float>(T[k]);
        }
    };
    std::vector<std::size_t> asking;
    const auto settle = [&] {
        blocked.assign(rays.size(), 0);
        stage.bvh->occluded(rays, blocked);
        sky.rays += rays.size();
        for (std::size_t a = 0; a < asking.size(); ++a) {
            double open = 0.0;
            std::array<double, coefficients> T{};
            for (std::size_t r = a * samples; r < (a + 1) * samples; ++r) {
                if (blocked[r] != 0) { continue; }
                open += 1.0;
                if (!sh) { continue; }
                const auto Y = harmonics(rays[r].direction);
                for (std::size_t k = 0; k < coefficients; ++k) {
                    T[k] += Y[k] * std::numbers::pi / samples;
                }
            }
            sky.ambient_occlusion[asking[a]] = static_cast<float>(open / samples);
            if (sh) { write_sh(asking[a], T); }
        }
        rays.clear();
        asking.clear();
    };
    for (std::size_t v = begin; v < end; ++v) {
        const Receiver receiver = vertex_receiver(stage, v);
        if (!receiver.frame.n) { continue; }
        if (stage.bvh->open_above(receiver.p, receiver.frame.n, receiver.clear.offset)) {
            sky.ambient_occlusion[v - begin] = 1.0F;
            if (sh) { write_sh(v - begin, open_transfer(receiver.frame.n)); }
            continue;
        }
        asking.push_back(v - begin);
        const Sequence sequence(scene.transport.seed, key_of(receiver), sky_number, 0);
        for (unsigned i = 0; i < samples; ++i) {
            const Vec3 local = warp::cosine_hemisphere(sequence.at(i, 0));
            rays.push_back(shadow_ray(*stage.bvh, receiver,
                                      normalize(receiver.frame.to_world(local)),
                                      std::numeric_limits<double>::infinity(), scene.transport));
        }
        if (rays.size() >= enough_rays) { settle(); }
    }
    settle();
    return sky;
}

}  // namespace relight
