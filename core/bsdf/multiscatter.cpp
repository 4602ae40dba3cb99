#include "core/bsdf/multiscatter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;

/// Nodes and weights of Gauss-Legendre on [-1, 1]: roots of P_n by Newton's method.
struct Gauss {
    static constexpr int n = 24;
    std::array<double, n> x{}, w{};

    Gauss()
    {
        for (std::size_t i = 0; i < n; ++i) {
            double r = std::cos(pi * (static_cast<double>(i) + 0.75) / (n + 0.5));
            double slope = 1.0;
            for (int round = 0; round < 6; ++round) {
                double p = r, below = 1.0;
                for (int k = 2; k <= n; ++k) {
                    const double next = ((2 * k - 1) * r * p - (k - 1) * below) / k;
                    below = p;
                    p = next;
                }
                slope = n * (below - r * p) / (1.0 - r * r);
                r -= p / slope;
            }
            x[i] = r;
            w[i] = 2.0 / ((1.0 - r * r) * slope * slope);
        }
    }
};
const Gauss& gauss()
{
    static const Gauss rule;
    return rule;
}

}  // namespace

double directional_albedo(const Mirror& f, Vec3 wo, double alpha_x, double alpha_y)
{
    // Over facets h = (x, y, 1) / sqrt(1 + x^2 + y^2) of slopes x = alpha_x rho cos(psi) and
    // y = alpha_y rho sin(psi): dwi = 4 (wo.h) dh, dh = h_z^3 dx dy, dx dy = alpha_x alpha_y rho
    // drho dpsi. The facets that mirror wo to above the surface fill a disk of slopes,
    //   cos_o (x^2 + y^2) - 2 (wo_x x + wo_y y) < cos_o,
    // about the origin; each ray from there leaves it at rho = R(psi). In ln(rho / (R - rho)) the
    // integrand is smooth and vanishes at both ends, however narrow the lobe: equal steps do.
    constexpr double step = 0.3, reach = 8.0;
    const double co = wo.z;
    const double ax = alpha_x * wo.x, ay = alpha_y * wo.y;
    const double A = std::hypot(ax, ay);
    const double ahead = A > 0.0 ? std::atan2(ay, ax) : 0.0;
    const auto along_ray = [&](double psi, double facing) {  // facing = A cos(psi - ahead)
        const double x = alpha_x * std::cos(psi), y = alpha_y * std::sin(psi);
        const double s2 = x * x + y * y;
        const double root = std::sqrt(facing * facing + co * co * s2);
        const double R = facing > 0.0 ? (facing + root) / (co * s2) : co / (root - facing);
        double sum = 0.0;
        const double start = -reach - std::log1p(R);
        const int points = static_cast<int>(std::ceil((reach - start) / step));
        for (int i = 0; i < points; ++i) {
            const double t = start + i * step;
            const double rho = R / (1.0 + std::exp(-t));
            const double left = R / (1.0 + std::exp(t));  // R - rho
            const double hz2 = 1.0 / (1.0 + s2 * rho * rho);
            const double hz = std::sqrt(hz2);
            const Vec3 h{x * rho * hz, y * rho * hz, hz};
            const double cos_d = dot(wo, h);
            const Vec3 wi = 2.0 * cos_d * h - wo;
            if (cos_d <= 0.0 || wi.z <= 0.0) { continue; }  // rounding at the rim
            sum += f(wi, wo) * wi.z * cos_d * hz * hz2 * rho * rho * (left / R);
        }
        return sum * step;
    };
    // About the two rays across wo, facing = 0, it turns within the angle cos_o / sin_o: nodes
    // crowd there. Between those rays, on either side, lie the facets that face wo and those that
    // do not.
    const double crowd = std::max(1e-3, std::asinh(0.5 * pi * std::hypot(wo.x, wo.y) / wo.z));
    const bool symmetric = alpha_x == alpha_y;  // about the plane of wo
    double sum = 0.0;
    for (std::size_t i = 0; i < Gauss::n; ++i) {
        const double t = crowd * gauss().x[i];
        const double past = 0.5 * pi * std::sinh(t) / std::sinh(crowd);  // the ray across [rad]
        const double weight = gauss().w[i] * std::cosh(t);
        const double facing = -A * std::sin(past);
        const double left = along_ray(ahead + 0.5 * pi + past, facing);
        const double right = symmetric ? left : along_ray(ahead - 0.5 * pi - past, facing);
        sum += weight * (left + right);
    }
    return sum * 0.5 * pi * crowd / std::sinh(crowd) * 4.0 * alpha_x * alpha_y;
}

MultiscatterTable::MultiscatterTable(const Mirror& mirror, double alpha_x, double alpha_y)
    : scale_(std::min(alpha_x, alpha_y)), reach_(std::asinh(1.0 / scale_))
{
    const int turns =
        alpha_x == alpha_y ? 1 : 8;  // midpoints of a quarter turn: E repeats after it
    for (std::size_t i = 0; i < nodes; ++i) {
        constexpr double least = 1e-6;  // cosine in place of 0, where no facet has visible area
        const double c = std::clamp(cosine(static_cast<double>(i)), least, 1.0);
        const double s = std::sqrt((1.0 - c) * (1.0 + c));
        double sum = 0.0;
        for (int k = 0; k < turns; ++k) {
            const double phi = 0.5 * pi * (k + 0.5) / turns;
            const Vec3 wo{s * std::cos(phi), s * std::sin(phi), c};
            sum += directional_albedo(mirror, wo, alpha_x, alpha_y);
        }
        E_[i] = std::clamp(sum / turns, 0.0, 1.0);
    }
    constexpr int parts = 4;  // Simpson's rule on so many parts of each step of the table
    double sum = 0.0;
    for (int i = 0; i < (nodes - 1) * parts; ++i) {
        const double a = cosine(static_cast<double>(i) / parts);
        const double b = cosine(static_cast<double>(i + 1) / parts);
        const double mid = 0.5 * (a + b);
        sum += (b - a) * (E(a) * a + 4.0 * E(mid) * mid + E(b) * b) / 6.0;
    }
    E_avg_ = std::min(1.0, 2.0 * sum);
}

double MultiscatterTable::cosine(double place) const
{
    const double t = place / (nodes - 1);
    return scale_ * std::sinh(reach_ * t * t);
}

double MultiscatterTable::E(double cos_o) const
{
    const double place =
        (nodes - 1) * std::sqrt(std::asinh(std::clamp(cos_o, 0.0, 1.0) / scale_) / reach_);
    const int first = std::clamp(static_cast<int>(place) - 1, 0, nodes - 4);
    const double t = place - first;  // Lagrange's cubic through the nodes 0, 1, 2, 3
    const double* y = E_.data() + first;
    return std::clamp(
        -y[0] * (t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0 + y[1] * t * (t - 2.0) * (t - 3.0) / 2.0 -
            y[2] * t * (t - 1.0) * (t - 3.0) / 2.0 + y[3] * t * (t - 1.0) * (t - 2.0) / 6.0,
        0.0, 1.0);
}

Rgb MultiscatterTable::F_ms(Rgb F_avg) const
{
    const auto band = [&](double F) {
        const double returned = 1.0 - F * (1.0 - E_avg_);
        return returned > 0.0 ? F * F * E_avg_ / returned : 0.0;
    };
    return {band(F_avg.r), band(F_avg.g), band(F_avg.b)};
}

Rgb MultiscatterTable::f_ms(double cos_i, double cos_o, Rgb F_avg) const
{
    if (E_avg_ >= 1.0) { return {}; }  // nothing is lost
    const double lost = (1.0 - E(cos_i)) * (1.0 - E(cos_o));
    return F_ms(F_avg) * (lost / (pi * (1.0 - E_avg_)));
}

}  // namespace relight
