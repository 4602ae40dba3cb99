#include <algorithm>
#include <array>
#include <numbers>

#include "core/base/warp.h"
#include "core/transport/column.h"

namespace relight {
namespace {

constexpr std::size_t coefficients = 9;
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

Column sky_visibility(const Stage& stage, const Scene& scene, bool sh, Vertices vertices)
{
    const std::size_t count = vertices.size();
    Column sky;
    sky.ambient_occlusion.resize(count);
    if (sh) { sky.sh.resize(count * coefficients); }
    const unsigned samples = budget_of(scene.transport.samples).samples();
    const std::vector<Lanes> lanes = lanes_of(1, 0, samples);
    std::vector<std::array<double, coefficients>> T(sh ? count : 0);
    std::vector<Receiver> receivers;
    std::vector<std::size_t> asking;  // places in the column
    for (std::size_t at = 0; at < count; ++at) {
        const Receiver receiver = vertex_receiver(stage, vertices[at]);
        if (!receiver.frame.n) { continue; }
        if (stage.bvh->open_above(receiver.p, receiver.frame.n, receiver.clear.offset)) {
            sky.ambient_occlusion[at] = static_cast<float>(samples);
            if (sh) { T[at] = open_transfer(receiver.frame.n); }
            continue;
        }
        receivers.push_back(receiver);
        asking.push_back(at);
    }
    ShadowStream stream(*stage.bvh);
    Brought E;
    std::vector<Asker<CosineView>> askers;
    std::array<Vec3, ShadowStream::capacity> wi;
    const std::size_t together = askers_a_stream(lanes[0]);
    for (std::size_t begin = 0; begin < receivers.size(); begin += together) {
        const std::size_t end = std::min(receivers.size(), begin + together);
        askers.clear();
        for (std::size_t a = begin; a < end; ++a) {
            askers.push_back({CosineView(receivers[a].frame, false),
                              &receivers[a],
                              {scene.transport.seed, key_of(receivers[a]), sky_number, 0}});
        }
        for (const Lanes& some : lanes) {
            draw<CosineView>(askers, *stage.bvh, scene.transport, 0, some, stream, E);
            const RayFields& fields = stream.fields();
            for (std::size_t slot = 0; sh && slot < stream.size(); ++slot) {
                wi[slot] = {fields.direction_x[slot], fields.direction_y[slot],
                            fields.direction_z[slot]};
            }
            const auto blocked = stream.trace();
            for (std::size_t slot = 0; slot < blocked.size(); ++slot) {
                sky.rays += E[slot] > 0.0 ? 1 : 0;
                if (blocked[slot] != 0) { continue; }
                const std::size_t at = asking[begin + slot / some.count];
                sky.ambient_occlusion[at] += 1.0F;  // exact: samples are far fewer than 2^24
                if (!sh) { continue; }
                const auto Y = harmonics(wi[slot]);
                for (std::size_t k = 0; k < coefficients; ++k) {
                    T[at][k] += Y[k] * std::numbers::pi / samples;
                }
            }
        }
    }
    for (float& open : sky.ambient_occlusion) { open /= static_cast<float>(samples); }
    for (std::size_t i = 0; i < sky.sh.size(); ++i) {
        sky.sh[i] = static_cast<float>(T[i / coefficients][i % coefficients]);
    }
    return sky;
}

}  // namespace relight
