#include "core/light/dome.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/vectors.h"
#include "core/base/warp.h"

// CMakeLists.txt has this file optimised for vectors.

namespace relight {

namespace {

using Lane = double[DomeLanes::most];
using Texels = std::array<std::size_t, DomeLanes::most>;

/// How far about the pole of the map the directions lead, 0 to 1: with y, to which texel.
void find_turns(const Dome& dome, std::size_t count, const DomeLanes& lanes, Lane& turns)
{
    in_vectors([&] {
        const double c = dome.cosine, s = dome.sine;
        RELIGHT_APART
        for (std::size_t i = 0; i < count; ++i) {
            const double x = c * lanes.x[i] - s * lanes.z[i];
            const double z = c * lanes.z[i] + s * lanes.x[i];
            turns[i] = 0.5 + std::copysign(warp::angle_above(std::abs(z), x), z) *
                                 (0.5 / std::numbers::pi);
        }
    });
}

/// What is seen: of the map by its texels, and of the sun.
void shine(const Dome& dome, std::size_t count, const Texels& texels, DomeLanes& lanes)
{
    auto& seen = lanes.seen;
    if (dome.map != nullptr) {
        const std::vector<Rgbf>& pixels = dome.map->image().pixels;
        for (std::size_t i = 0; i < count; ++i) {
            const Rgb L = to_double(pixels[texels[i]]);
            seen.red[i] = L.r;
            seen.green[i] = L.g;
            seen.blue[i] = L.b;
        }
        in_vectors([&] {
            const double of_map = 1.0 - dome.sun_share, total = dome.map->luminance_integral();
            RELIGHT_APART
            for (std::size_t i = 0; i < count; ++i) {
                seen.pdf[i] = of_map * (luminance(seen.L(i)) / total);
            }
        });
    } else {
        for (double* band : {seen.red, seen.green, seen.blue, seen.pdf}) {
            std::fill_n(band, count, 0.0);
        }
    }
    if (!dome.sun) { return; }
    in_vectors([&] {
        const Vec3 axis = dome.toward_sun;
        const double height = dome.sun->height(), pdf = dome.sun_pdf;
        const Rgb L = dome.L_sun;
        RELIGHT_APART
        for (std::size_t i = 0; i < count; ++i) {  // as SunView::look() has it
            const Vec3 aside = Vec3{lanes.x[i], lanes.y[i], lanes.z[i]} - axis;
            const Mask is_beside = where(0.5 * dot(aside, aside) > height);
            seen.red[i] += choose(is_beside, 0.0, L.r);
            seen.green[i] += choose(is_beside, 0.0, L.g);
            seen.blue[i] += choose(is_beside, 0.0, L.b);
            seen.pdf[i] += choose(is_beside, 0.0, pdf);
        }
    });
}

bool is_of_map(const Dome& dome, double pick)
{
    return dome.has_parts() ? !(pick < dome.sun_share) : dome.map != nullptr;
}

/// Of a texel that is drawn, and of its row, what EnvironmentMap::Cell has, and the row's edges.
struct Cells {
    alignas(64) Lane column, along, width, top, bottom, down, height;
};

/// What is asked of memory in one step stays in the nearest cache until the next.
constexpr std::size_t fetched_together = 128;

/// Lanes [begin, end): no more than those.
void draw_texels(const Dome& dome, std::size_t begin, std::size_t end, const DomeLanes& lanes,
                 Cells& cells, Texels& texels)
{
    const EnvironmentMap* const map = dome.map;
    std::array<EnvironmentMap::Cell, fetched_together> rows;
    std::array<std::size_t, fetched_together> guides;
    for (std::size_t i = begin; i < end; ++i) {
        if (!is_of_map(dome, lanes.pick[i])) { continue; }
        rows[i - begin] = map->draw_row(lanes.v[i]);
        guides[i - begin] = map->guide_of_column(rows[i - begin].index, lanes.u[i]);
        map->fetch_guide(guides[i - begin]);
    }
    for (std::size_t i = begin; i < end; ++i) {
        if (!is_of_map(dome, lanes.pick[i])) { continue; }
        map->fetch_sums(rows[i - begin].index, guides[i - begin]);
    }
    for (std::size_t i = begin; i < end; ++i) {
        cells.column[i] = cells.along[i] = cells.top[i] = cells.bottom[i] = cells.down[i] = 0.0;
        cells.width[i] = cells.height[i] = 1.0;
        if (!is_of_map(dome, lanes.pick[i])) { continue; }
        const EnvironmentMap::Cell& row = rows[i - begin];
        const EnvironmentMap::Cell cell = map->draw_column(row.index, lanes.u[i]);
        cells.column[i] = static_cast<double>(cell.index);
        cells.along[i] = cell.within;
        cells.width[i] = cell.size;
        cells.top[i] = map->upper_edge(row.index);
        cells.bottom[i] = map->upper_edge(row.index + 1);
        cells.down[i] = row.within;
        cells.height[i] = row.size;
        texels[i] = row.index * static_cast<std::size_t>(map->image().width) + cell.index;
        map->fetch(texels[i]);
    }
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
        dome.sun_share = dome.map != nullptr ? 0.5 : 1.0;
        dome.toward_sun = -light.sun.travel;
        const LightSample disc = dome.sun->look(dome.toward_sun);
        dome.L_sun = light.sun_E_perp * disc.L;
        dome.sun_pdf = dome.sun_share * disc.pdf;
    }
    return dome;
}

void sample(const Dome& dome, std::size_t count, DomeLanes& lanes)
{
    const EnvironmentMap* const map = dome.map;
    Texels texels;
    Cells cells;
    for (std::size_t begin = 0; begin < count; begin += fetched_together) {
        draw_texels(dome, begin, std::min(count, begin + fetched_together), lanes, cells, texels);
    }
    in_vectors([&] {
        const double c = dome.cosine, s = dome.sine;
        const int columns = map != nullptr ? map->image().width : 1;
        RELIGHT_APART
        for (std::size_t i = 0; i < count; ++i) {
            const EnvironmentMap::Cell across_it{0, cells.along[i], cells.width[i]},
                down_it{0, cells.down[i], cells.height[i]};
            const double turns = (cells.column[i] + across_it.fraction()) / columns - 0.5;
            const warp::SineCosine phi = warp::sine_cosine_of_turns(turns);
            const double top = cells.top[i], bottom = cells.bottom[i];
            const double y = top + down_it.fraction() * (bottom - top);
            const double across = std::sqrt(std::max(0.0, (1.0 - y) * (1.0 + y)));
            const double x = across * phi.cosine, z = across * phi.sine;
            lanes.x[i] = c * x + s * z;
            lanes.y[i] = y;
            lanes.z[i] = c * z - s * x;
        }
    });
    if (dome.sun) {
        in_vectors([&] {
            const SunView sun = *dome.sun;
            const Mask is_alone = where(!dome.has_parts());
            const double share = dome.sun_share;
            RELIGHT_APART
            for (std::size_t i = 0; i < count; ++i) {
                const Vec3 wi = sun.sample_direction({lanes.u[i], lanes.v[i]}).wi;
                const Mask is_of_sun = is_alone | where(lanes.pick[i] < share);
                lanes.x[i] = choose(is_of_sun, wi.x, lanes.x[i]);
                lanes.y[i] = choose(is_of_sun, wi.y, lanes.y[i]);
                lanes.z[i] = choose(is_of_sun, wi.z, lanes.z[i]);
            }
        });
        alignas(64) Lane turns;
        if (dome.has_parts()) { find_turns(dome, count, lanes, turns); }
        for (std::size_t i = 0; dome.has_parts() && i < count; ++i) {
            if (is_of_map(dome, lanes.pick[i])) { continue; }
            texels[i] = map->texel_at(turns[i], lanes.y[i]);
        }
    }
    shine(dome, count, texels, lanes);
}

void look(const Dome& dome, std::size_t count, DomeLanes& lanes)
{
    Texels texels;
    if (dome.map != nullptr) {
        alignas(64) Lane turns;
        find_turns(dome, count, lanes, turns);
        for (std::size_t i = 0; i < count; ++i) {
            texels[i] = dome.map->texel_at(turns[i], lanes.y[i]);
            dome.map->fetch(texels[i]);
        }
    }
    shine(dome, count, texels, lanes);
}

}  // namespace relight
