#pragma once

#include <array>
#include <cmath>
#include <span>

#include "core/base/sobol.h"
#include "core/base/vectors.h"
#include "core/light/light_sample.h"
#include "core/light/triangle.h"

namespace relight {

/// A flat rectangle (or parallelogram). Power is its radiance L; it shines toward u x v.
struct RectLight {
    Point3 center;
    Vec3 edge_u, edge_v;  ///< whole edges, scene units: corners are center +- u/2 +- v/2
    bool two_sided = false;
};

/// Of one side [scene units squared]. Flux is pi L A, twice that of a two-sided one.
double area(const RectLight& light);

/// E at p facing n from radiance 1 [sr].   Test: Polygon.ARectangle*
double irradiance(const RectLight& light, Point3 p, Dir3 n);

/// The same at many places at once, in vectors: within 1e-12, but where the coordinates' own
/// roundings are more.   Test: RectLanes.*
void irradiance(const RectLight& light, std::span<const Point3> p, std::span<const Dir3> n,
                std::span<double> E);

/// Directions to a rectangle, uniform in the solid angle of the whole, from what depends on the
/// place alone.
struct RectDirections {
    std::array<SphericalTriangle, 2> halves;
    double whole = 0.0;     ///< solid angle; 0: nothing is to be seen
    Vec3 normal;            ///< any length
    double height = 0.0;    ///< above the plane, times that length
    double farthest = 0.0;  ///< corner's distance

    bool is_seen() const { return whole > 0.0; }
    /// Without a branch; where something is seen.
    LightSample sample_direction(Sample2 s) const { return toward(corner(s.u), s); }
    /// Its two steps: of the half that u chooses, the corner that cuts off what u is within it.
    /// Points that are well apart stay so.
    Vec3 corner(double u) const
    {
        const double at = u * whole;
        const Mask other = where(at >= halves[0].solid_angle);
        const SphericalTriangle half = chosen(other);
        const double rest = at - choose(other, halves[0].solid_angle, 0.0);
        const double most = half.solid_angle * below_one;
        return half.corner(rest < most ? rest : most);
    }
    LightSample toward(Vec3 corner, Sample2 s) const
    {
        const Vec3 wi = chosen(where(s.u * whole >= halves[0].solid_angle)).toward(corner, s.v);
        const double distance = height / std::abs(dot(wi, normal));
        // No farther than the farthest corner, whatever the rounding of a grazing direction.
        return {unit_already(wi), distance <= farthest ? distance : farthest, Rgb::grey(1.0),
                1.0 / whole};
    }
    SphericalTriangle chosen(Mask other) const
    {
        const SphericalTriangle &a = halves[0], &b = halves[1];
        SphericalTriangle half;
        half.solid_angle = choose(other, b.solid_angle, a.solid_angle);
        half.A = {a.A.x, a.A.y, a.A.z};  // shared; g++ 12 makes no vectors of a copied struct
        half.B = choose(other, b.B, a.B);
        half.T = choose(other, b.T, a.T);
        half.sum = choose(other, b.sum, a.sum);
        half.sine = choose(other, b.sine, a.sine);
        half.b_dot_t = choose(other, b.b_dot_t, a.b_dot_t);
        return half;
    }

    static constexpr double below_one = 1.0 - 0x1p-33;
};

/// Those of many places, in vectors. They are RectView's within 1e-8 of the density, and 1e-6 of
/// the light's apparent width; where it draws by area or lifts the place, `whole` is negative, and
/// it is RectView that draws. Test: RectLanes.*
void directions(const RectLight& light, std::span<const Point3> p, std::span<RectDirections> seen);

/// The rectangle as a place sees it. Drawn uniformly in the solid angle of the whole, that is of
/// its two triangles; "no direction" from behind, in its plane, or without area.
class RectView {
  public:
    RectView(const RectLight& light, Point3 p);

    /// Small halves are drawn by area, by other steps.
    bool by_area() const { return halves_[0].by_area || halves_[1].by_area; }
    LightSample sample(Sample2 s) const;
    LightSample look(Dir3 wi) const;

    /// What sample() gives where not by_area() and something is seen: without a branch.
    bool is_seen() const { return directions_.is_seen(); }
    LightSample sample_direction(Sample2 s) const { return directions_.sample_direction(s); }
    Vec3 corner(double u) const { return directions_.corner(u); }
    LightSample toward(Vec3 corner, Sample2 s) const { return directions_.toward(corner, s); }

  private:
    std::array<TriangleView, 2> halves_;
    RectDirections directions_;  ///< of by_area() only what is whole
};

LightSample sample(const RectLight& light, Point3 p, Sample2 s);
LightSample look(const RectLight& light, Point3 p, Dir3 wi);

}  // namespace relight
