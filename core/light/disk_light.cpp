#include "core/light/disk_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace relight {
namespace {

using std::numbers::pi;

/// Where a place p is: h above the disk's plane, rho along e from its axis. N and F are the rim's
/// nearest and farthest points; the formulas below are those of the triangle N p F.
struct Place {
    double R, h, rho;
    Dir3 e;
    double near, far;  ///< |pN|, |pF|:  near^2, far^2 = h^2 + (rho -+ R)^2
    double S;          ///< near far
    double m;          ///< h^2 + rho^2 - R^2
    double P;          ///< S + m, by S^2 - m^2 = 4 R^2 h^2 where that would cancel

    Place(const DiskLight& light, Point3 p) : R(light.radius)
    {
        const Vec3 d = p - light.center;
        const Frame frame = frame_around(light.normal);
        const Vec3 local = frame.to_local(d);
        h = local.z;
        rho = std::sqrt(local.x * local.x + local.y * local.y);
        e = rho > 0.0 ? normalize(frame.to_world({local.x, local.y, 0.0})) : frame.x;
        near = std::sqrt(h * h + (rho - R) * (rho - R));
        far = std::sqrt(h * h + (rho + R) * (rho + R));
        S = near * far;
        m = h * h + (rho - R) * (rho + R);
        P = m > 0.0 ? S + m : 4.0 * R * R * (h * h / (S - m));
    }
};

/// The whole rim above the horizon: vector irradiance times n. Its components along -normal and
/// toward the axis, (pi/2)(1 - m/S) and (pi/2)(h/rho)((h^2 + rho^2 + R^2)/S - 1), without the
/// differences (contract section 2).
double whole(const Place& at, double n_normal, double n_e)
{
    const double sum = at.near + at.far;
    const double down = at.h / at.P, inward = 2.0 * at.rho / (sum * sum);
    return -2.0 * pi * at.R * at.R * (at.h / at.S) * (n_normal * down + n_e * inward);
}

/// The rim above the horizon, theta in (-theta0, theta0) from m1 (n's direction in the disk's
/// plane), and the chord that closes it: Lambert's contour E = -(1/2) int (x x dx) . n / |x|^2.
/// With x = x0 + R (m1 cos + m2 sin), x0 = -h normal - rho e, n = g m1 + v normal, the arc is
///   (v/2) (2 theta0 - m I0) + R g h I1,   I0 = int dtheta / |x|^2,   I1 = int cos / |x|^2.
/// |x|^2 = M - N cos(phi), phi = theta - theta_e, so I0 and the parts of I1 are elementary; they
/// are arranged to keep their digits on the axis, where N = 0.
double cut(const Place& at, double v, double g, double n_x0, double cos_e, double sin_e)
{
    const double R = at.R, h = at.h;
    const double cos0 = std::clamp(-n_x0 / (R * g), -1.0, 1.0);
    const double sin0 = std::sqrt((1.0 - cos0) * (1.0 + cos0));
    const double theta0 = std::atan2(sin0, cos0), theta_e = std::atan2(sin_e, cos_e);

    const double sum = at.near + at.far;
    const double M = 0.5 * (at.near * at.near + at.far * at.far);
    const double N = std::max(2.0 * R * at.rho, 1e-30 * R * R);  // not 0: quotients have limits
    struct End {
        double x2, G;  // |x|^2; int dphi / (M - N cos) = (phi + N G) / S
    };
    const auto end = [&](double phi) -> End {
        const double s = std::sin(0.5 * phi), c = std::cos(0.5 * phi);
        const double w = 2.0 / sum * s * c / (at.near * c * c + at.far * s * s);
        return {at.near * at.near * c * c + at.far * at.far * s * s, 2.0 * std::atan(N * w) / N};
    };
    const End from = end(-theta0 - theta_e), to = end(theta0 - theta_e);
    const double turn = 2.0 * theta0, G = to.G - from.G;
    const double I0 = (turn + N * G) / at.S;
    const double J_cos = (2.0 * N * turn / (sum * sum) + M * G) / at.S;  // int cos / (M - N cos)
    const double growth = -2.0 * N * sin_e * sin0 / from.x2;
    const double J_sin = (growth > -0.5 ? std::log1p(growth) : std::log(to.x2 / from.x2)) / N;
    const double I1 = cos_e * J_cos - sin_e * J_sin;
    const double arc = 0.5 * v * (turn - at.m * I0) + R * g * h * I1;

    // The chord lies in the horizon: what it adds is the angle between its ends.
    const double height = h / g, x2 = at.rho * sin_e, half = R * sin0;
    const double chord =
        std::atan2(2.0 * half * height, height * height + (x2 - half) * (x2 + half));
    return 0.5 * (chord - arc);
}

}  // namespace

double area(const DiskLight& light)
{
    return pi * light.radius * light.radius;
}

double irradiance(const DiskLight& light, Point3 p, Dir3 n)
{
    const Place at(light, p);
    if (!(at.R > 0.0 && at.h > 0.0)) { return 0.0; }
    const double v = dot(n, light.normal);
    const Vec3 in_plane = Vec3(n) - Vec3(light.normal) * v;
    const double g = length(in_plane);
    const double n_x0 = dot(n, light.center - p);  // height of the centre above the horizon
    if (n_x0 <= -at.R * g) { return 0.0; }
    double E = 0.0;
    if (n_x0 >= at.R * g) {
        E = whole(at, v, dot(n, at.e));
    } else {
        const Dir3 m1 = normalize(in_plane);
        E = cut(at, v, g, n_x0, dot(at.e, m1), dot(at.e, cross(light.normal, m1)));
    }
    return std::min(std::max(0.0, E), pi);
}

DiskView::DiskView(const DiskLight& light, Point3 p)
{
    const Place at(light, p);
    if (!(at.R > 0.0 && at.h > 0.0)) { return; }
    const Vec3 n = light.normal, e = at.e;
    const double sum = at.near + at.far;
    const Vec3 axis = normalize({2.0 * at.P * at.rho / (sum * sum), at.h, 0.0});
    frame_.n = normalize(-(e * axis.x) - n * axis.y);
    frame_.x = normalize(n * axis.x - e * axis.y);
    frame_.y = normalize(cross(frame_.n, frame_.x));
    normal_ = n;
    height_ = at.h;
    farthest_ = at.far;
    const double D = std::sqrt(2.0 * at.P);
    per_a2_ = at.P / (2.0 * at.R * at.h) * (at.P / (2.0 * at.R * at.h));
    per_b2_ = 0.5 * at.P / (at.R * at.R);
    // sqrt(1 + a^2) = 2 sqrt(S) / D, sqrt(1 + b^2) = (near + far) / D
    const double stretch_x = at.h * sum / D, stretch_y = std::sqrt(at.S);
    stretch_x_ = stretch_x / std::max(stretch_x, stretch_y);  // their quotient alone matters
    stretch_y_ = stretch_y / std::max(stretch_x, stretch_y);
    const double density = stretch_y * sum / at.R * D / at.R / (8.0 * pi * at.h);
    const bool in_range = density > 0.0 && is_finite(2.0 * density) && is_finite(per_a2_) &&
                          is_finite(per_b2_);  // of double
    if (in_range && frame_.n && frame_.x) { density_ = density; }
}

LightSample DiskView::look(Dir3 wi) const
{
    if (!is_seen()) { return {}; }
    const Vec3 w = frame_.to_local(wi);
    if (!(w.z > 0.0) || w.x * w.x * per_a2_ + w.y * w.y * per_b2_ > w.z * w.z) { return {}; }
    return seen(wi, std::sqrt(1.0 + rim2(w.x, w.y)));
}

LightSample sample(const DiskLight& light, Point3 p, Sample2 s)
{
    return DiskView(light, p).sample(s);
}

LightSample look(const DiskLight& light, Point3 p, Dir3 wi)
{
    return DiskView(light, p).look(wi);
}

}  // namespace relight
