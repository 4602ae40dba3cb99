// Relighting from columns: E, its error, and what a Lambertian surface sends out, in one pass.
#include <numbers>

#include "core/shade/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/shade/sum.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
//
#include "core/shade/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relight::kernel::HWY_NAMESPACE {
namespace {

/// The `bands` values of each vertex from v on.
HWY_INLINE Vector read(const float* values, unsigned bands, std::size_t v, std::size_t left)
{
    if (bands == 3) { return read_rows(values + 3 * v, left); }
    const Double one = read(values + v, left);
    return {one, one, one};
}

/// Above 0 where the vertices are seen.
HWY_INLINE Double facing(const View& view, std::size_t v, std::size_t left)
{
    const Viewer& viewer = view.viewer;
    // Along the normal every vertex is seen that has E.
    if (viewer.place == Viewer::Place::AlongNormal) { return all(1.0); }
    Vector to_viewer = all(viewer.at);
    if (viewer.place == Viewer::Place::Point) {
        to_viewer = to_viewer - read_rows(view.positions + 3 * v, left);
    }
    const Double cosine = dot(read_rows(view.normals + 3 * v, left), to_viewer);
    return viewer.two_sided ? hn::Abs(cosine) : cosine;
}

HWY_INLINE void add_at(const Sums& sums, std::size_t begin, std::size_t v, std::size_t left)
{
    const Doubles d;
    const Double zero = hn::Zero(d);
    Vector E{zero, zero, zero}, variance = E, L = E, rho = E;
    if (sums.radiance != nullptr) {
        const std::size_t i = v - begin;  // rho is a block's, whole vectors long
        rho = {hn::LoadU(d, sums.rho[0] + i), hn::LoadU(d, sums.rho[1] + i),
               hn::LoadU(d, sums.rho[2] + i)};
    }
    const Double inv_pi = all(std::numbers::inv_pi);
    for (std::size_t l = 0; l < sums.count; ++l) {
        const Summand& light = sums.lights[l];
        const Vector power = all(light.power);
        Vector one = read(light.E, light.E_bands, v, left);
        if (light.bounced != nullptr) { one = one + read_rows(light.bounced + 3 * v, left); }
        one = one * power;
        if (light.per_light != nullptr) { write_rows(one, light.per_light + 3 * v, left); }
        E = E + one;
        if (sums.radiance != nullptr) { L = L + rho * one * inv_pi; }
        if (sums.error != nullptr && light.error != nullptr) {
            const Vector error = read(light.error, light.error_bands, v, left) * power;
            variance = variance + error * error;  // lights draw independent samples
        }
    }
    if (sums.E != nullptr) { write_rows(E, sums.E + 3 * v, left); }
    if (sums.radiance != nullptr) {
        const auto seen = facing(*sums.view, v, left) > zero;
        write_rows(where(seen, L), sums.radiance + 3 * v, left);
    }
    if (sums.error != nullptr) {
        write_rows({hn::Sqrt(variance.x), hn::Sqrt(variance.y), hn::Sqrt(variance.z)},
                   sums.error + 3 * v, left);
    }
}

void add(const Sums& sums, std::size_t begin, std::size_t end)
{
    const std::size_t lanes = hn::Lanes(Doubles());
    std::size_t v = begin;
    for (; v + lanes <= end; v += lanes) { add_at(sums, begin, v, lanes); }
    if (v < end) { add_at(sums, begin, v, end - v); }
}

bool is_faced(const View& view, std::size_t v)
{
    return hn::GetLane(facing(view, v, 1)) > 0.0;
}

}  // namespace
}  // namespace relight::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relight::kernel {

HWY_EXPORT(add);
HWY_EXPORT(is_faced);

void add_columns(const Sums& sums, std::size_t begin, std::size_t end)
{
    HWY_DYNAMIC_DISPATCH(add)(sums, begin, end);
}

bool is_seen(const View& view, std::size_t vertex)
{
    return HWY_DYNAMIC_DISPATCH(is_faced)(view, vertex);
}

}  // namespace relight::kernel
#endif
