#include "core/light/dome.h"

#include <algorithm>
#include <cmath>

#include "core/base/vectors.h"

// CMakeLists.txt has this file optimised for vectors.

namespace relight {
namespace {

using Lane = double[DomeLanes::most];
using Texels = int[DomeLanes::most];

/// Directions in lanes, from samples, and the texels that they lead to.
struct Directions {
    const double *u, *v;
    double *x, *y, *z;
    int* texel;
};

/// The texels that directions lead to.
void find_texels(const Dome& dome, std::size_t count, const Directions& all)
{
    in_vectors([&] {
        const double c = dome.cosine, s = dome.sine;
        const MapTables map = dome.map->tables();
        const Directions to = all;
        RELIGHT_APART
        for (std::size_t i = 0; i < count; ++i) {
            const double x = c * to.x[i] - s * to.z[i];
            const double z = c * to.z[i] + s * to.x[i];
            to.texel[i] = map.texel_at(turns_along(x, z), to.y[i]);
        }
    });
}

/// Directions and texels that the map draws: step by step over all lanes, so that many wait for
/// memory together.
void draw_from_map(const Dome& dome, std::size_t count, const Directions& all)
{
    const MapTables map = dome.map->tables();
    alignas(64) Lane ts, turns;
    alignas(64) Texels rows, blocks;
    in_vectors([&] {
        const MapTables of = map;
        const double* const v = all.v;
        RELIGHT_APART
        for (std::size_t i = 0; i < count; ++i) {
            ts[i] = v[i] * of.row_reach;
            rows[i] = of.near_row(v[i], ts[i]);
        }
    });
    for (std::size_t i = 0; i < count; ++i) { rows[i] = map.settled_row(rows[i], ts[i]); }
    in_vectors([&] {
        const MapTables of = map;
        const double* const u = all.u;
        double* const y = all.y;
        RELIGHT_APART
        for (std::size_t i = 0; i < count; ++i) {
            y[i] = of.height_in(rows[i], ts[i]);
            ts[i] = u[i] * of.block_reach[rows[i]];
            blocks[i] = of.near_block(rows[i], u[i]);
        }
    });
    in_vectors([&] {
        const MapTables of = map;
        RELIGHT_APART
        for (std::size_t i = 0; i < count; ++i) { blocks[i] = of.nearer_block(blocks[i], ts[i]); }
    });
    for (std::size_t i = 0; i < count; ++i) {
        blocks[i] = map.settled_block(rows[i], blocks[i], ts[i]);
    }
    in_vectors([&] {
        const MapTables of = map;
        int* const texel = all.texel;
        RELIGHT_APART
        for (std::size_t i = 0; i < count; ++i) {
            const MapTables::Across across = of.in_block(rows[i], blocks[i], ts[i]);
            turns[i] = across.turns;
            texel[i] = across.texel;
        }
    });
    in_vectors([&] {
        const double c = dome.cosine, s = dome.sine;
        const Directions to = all;
        RELIGHT_APART
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 w = direction_at(turns[i], to.y[i]);
            to.x[i] = c * w.x + s * w.z;
            to.z[i] = c * w.z - s * w.x;
        }
    });
}

/// Those that the sun's disc draws.
void draw_from_sun(const Dome& dome, std::size_t count, const Directions& all)
{
    in_vectors([&] {
        const SunView sun = *dome.sun;
        const Directions to = all;
        RELIGHT_APART
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 wi = sun.sample_direction({to.u[i], to.v[i]}).wi;
            to.x[i] = wi.x;
            to.y[i] = wi.y;
            to.z[i] = wi.z;
        }
    });
    if (dome.map != nullptr) { find_texels(dome, count, all); }
}

/// Those lanes that draw from one of two parts, one after the other.
class Part {
  public:
    Part(const DomeLanes& lanes, std::size_t count, double sun_share, bool of_sun)
    {
        for (std::size_t i = 0; i < count; ++i) {
            lane_[count_] = i;
            u_[count_] = lanes.u[i];
            v_[count_] = lanes.v[i];
            count_ += (lanes.pick[i] < sun_share) == of_sun ? 1 : 0;
        }
    }

    std::size_t count() const { return count_; }
    Directions directions() { return {u_, v_, x_, y_, z_, texel_}; }
    void put(DomeLanes& lanes, Texels& texels) const
    {
        for (std::size_t k = 0; k < count_; ++k) {
            const std::size_t i = lane_[k];
            lanes.x[i] = x_[k];
            lanes.y[i] = y_[k];
            lanes.z[i] = z_[k];
            texels[i] = texel_[k];
        }
    }

  private:
    std::size_t count_ = 0;
    std::size_t lane_[DomeLanes::most];
    alignas(64) Lane u_, v_, x_, y_, z_;
    alignas(64) Texels texel_;
};

/// What is seen: of the map by its texels, and of the sun.
void shine(const Dome& dome, std::size_t count, const Texels& texels, DomeLanes& lanes)
{
    auto& seen = lanes.seen;
    if (dome.map != nullptr) {
        in_vectors([&] {
            const MapTables map = dome.map->tables();
            const double of_map = 1.0 - dome.sun_share;
            RELIGHT_APART
            for (std::size_t i = 0; i < count; ++i) {
                const Rgb L = map.radiance(texels[i]);
                seen.red[i] = L.r;
                seen.green[i] = L.g;
                seen.blue[i] = L.b;
                seen.pdf[i] = of_map * (luminance(L) / map.total);
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
    alignas(64) Texels texels;
    if (dome.has_parts()) {
        for (const bool of_sun : {false, true}) {
            Part part(lanes, count, dome.sun_share, of_sun);
            (of_sun ? draw_from_sun : draw_from_map)(dome, part.count(), part.directions());
            part.put(lanes, texels);
        }
    } else {
        (dome.sun ? draw_from_sun : draw_from_map)(
            dome, count, {lanes.u, lanes.v, lanes.x, lanes.y, lanes.z, texels});
    }
    shine(dome, count, texels, lanes);
}

void look(const Dome& dome, std::size_t count, DomeLanes& lanes)
{
    alignas(64) Texels texels;
    if (dome.map != nullptr) {
        find_texels(dome, count, {lanes.u, lanes.v, lanes.x, lanes.y, lanes.z, texels});
    }
    shine(dome, count, texels, lanes);
}

}  // namespace relight
