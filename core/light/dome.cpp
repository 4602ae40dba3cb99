#include "core/light/dome.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/vectors.h"
#include "core/base/warp.h"

// CMakeLists.txt has this file optimised for vectors.

namespace relight {

namespace {

/// Whole vectors of lanes.
std::size_t whole(std::size_t lanes)
{
    constexpr std::size_t vector = 16;
    return (lanes + vector - 1) / vector * vector;
}

}  // namespace

Dome dome_of(const EnvironmentLight& light)
{
    Dome dome;
    if (light.map->luminance_integral() > 0.0) { dome.map = light.map.get(); }
    dome.cosine = std::cos(light.rotation);
    dome.sine = std::sin(light.rotation);
    return dome;
}

Dome dome_of(const SkyLight& light)
{
    Dome dome;
    if (light.dome && light.dome->luminance_integral() > 0.0) { dome.map = light.dome.get(); }
    if (luminance(light.sun_E_perp) > 0.0) {
        dome.sun.emplace(light.sun);
        dome.E_perp = light.sun_E_perp;
        dome.sun_share = dome.map != nullptr ? 0.5 : 1.0;
    }
    return dome;
}

void sample(const Dome& dome, std::size_t count, DomeLanes& lanes)
{
    const EnvironmentMap* const map = dome.map;
    std::array<EnvironmentMap::Cell, DomeLanes::most> rows;
    std::array<std::size_t, DomeLanes::most> guides;
    alignas(64) double turns[DomeLanes::most], height[DomeLanes::most];
    const auto is_of_map = [&](std::size_t i) {
        return map != nullptr && !(lanes.pick[i] < dome.sun_share);
    };
    for (std::size_t i = 0; i < count; ++i) {
        if (!is_of_map(i)) { continue; }
        rows[i] = map->draw_row(lanes.v[i]);
        guides[i] = map->guide_of_column(rows[i].index, lanes.u[i]);
        map->fetch_guide(guides[i]);
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (is_of_map(i)) { map->fetch_sums(rows[i].index, guides[i]); }
    }
    for (std::size_t i = 0; i < count; ++i) {
        turns[i] = height[i] = 0.0;
        if (!is_of_map(i)) { continue; }
        const EnvironmentMap::Cell column = map->draw_column(rows[i].index, lanes.u[i]);
        turns[i] = map->turns(column.index, column.fraction);
        height[i] = map->height(rows[i]);
    }
    const std::size_t all = whole(count);
    std::fill(turns + count, turns + all, 0.0);
    std::fill(height + count, height + all, 0.0);
    in_vectors([&] {
        const double c = dome.cosine, s = dome.sine;
        RELIGHT_APART
        for (std::size_t i = 0; i < all; ++i) {
            const warp::SineCosine phi = warp::sine_cosine_of_turns(turns[i]);
            const double y = height[i];
            const double across = std::sqrt(std::max(0.0, (1.0 - y) * (1.0 + y)));
            const double x = across * phi.cosine, z = across * phi.sine;
            lanes.x[i] = c * x + s * z;
            lanes.y[i] = y;
            lanes.z[i] = c * z - s * x;
        }
    });
    for (std::size_t i = 0; dome.sun && i < count; ++i) {
        if (is_of_map(i)) { continue; }
        const Dir3 wi = dome.sun->sample_direction({lanes.u[i], lanes.v[i]}).wi;
        lanes.x[i] = wi.x();
        lanes.y[i] = wi.y();
        lanes.z[i] = wi.z();
    }
}

void look(const Dome& dome, std::size_t count, DomeLanes& lanes)
{
    const EnvironmentMap* const map = dome.map;
    const double of_map = 1.0 - dome.sun_share;
    if (map != nullptr) {
        alignas(64) double turns[DomeLanes::most];
        const std::size_t all = whole(count);
        std::fill(lanes.x + count, lanes.x + all, 0.0);
        std::fill(lanes.z + count, lanes.z + all, 0.0);
        std::array<std::size_t, DomeLanes::most> texels;
        in_vectors([&] {
            const double c = dome.cosine, s = dome.sine;
            RELIGHT_APART
            for (std::size_t i = 0; i < all; ++i) {
                const double x = c * lanes.x[i] - s * lanes.z[i];
                const double z = c * lanes.z[i] + s * lanes.x[i];
                turns[i] = 0.5 + std::copysign(warp::angle_above(std::abs(z), x), z) *
                                     (0.5 / std::numbers::pi);
            }
        });
        for (std::size_t i = 0; i < count; ++i) {
            texels[i] = map->texel_at(turns[i], lanes.y[i]);
            map->fetch(texels[i]);
        }
        for (std::size_t i = 0; i < count; ++i) {
            const EnvironmentMap::Seen seen = map->seen(texels[i], {});
            lanes.L[i] = seen.L;
            lanes.pdf[i] = of_map * seen.pdf;
        }
    } else {
        std::fill_n(lanes.L, count, Rgb{});
        std::fill_n(lanes.pdf, count, 0.0);
    }
    for (std::size_t i = 0; dome.sun && i < count; ++i) {
        const LightSample disc = dome.sun->look(unit_already({lanes.x[i], lanes.y[i], lanes.z[i]}));
        lanes.L[i] += dome.E_perp * disc.L;
        lanes.pdf[i] += dome.sun_share * disc.pdf;
    }
}

}  // namespace relight
