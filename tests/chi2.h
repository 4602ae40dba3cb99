#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <vector>

#include "core/base/vec.h"

/// Pearson's test that a sampler of directions draws from the density it claims.
namespace relight::test {

/// Q(a, x) = Gamma(a, x) / Gamma(a), the regularised upper incomplete gamma function: its power
/// series below the mean, Legendre's continued fraction (Lentz) above.   DLMF 8.7.1, 8.9.2
inline double gamma_q(double a, double x)
{
    if (!(x > 0.0)) { return 1.0; }
    const double scale = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1.0) {
        double term = 1.0 / a, sum = term;
        for (double n = a + 1.0; term > 1e-16 * sum; n += 1.0) { sum += term *= x / n; }
        return std::clamp(1.0 - scale * sum, 0.0, 1.0);
    }
    double b = x + 1.0 - a, c = 1e300, d = 1.0 / b, h = d;
    for (int n = 1; n < 100000; ++n) {
        const double an = -n * (n - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        h *= c * d;
        if (std::abs(c * d - 1.0) < 1e-15) { break; }
    }
    return std::clamp(scale * h, 0.0, 1.0);
}

struct Chi2 {
    double p = 0.0;  ///< of a sum so large by chance; a right sampler gives any value alike
    double statistic = 0.0, degrees = 0.0;
    double integral = 0.0;  ///< of the density over the sphere, within some 1e-5
};

/// Bins of (cos theta, phi), which are in proportion to solid angle. Where a bin would hold much of
/// the mass it is halved, so that a narrow lobe is seen as well as a broad one.
template <class Pdf>
class Chi2Bins {
  public:
    Chi2Bins(Pdf pdf, double samples) : pdf_(pdf), samples_(samples) {}

    struct Place {
        double z, phi, pdf;
    };
    struct Cell {
        double z, phi, dz, dphi;  // least corner and extents

        /// Across its longer side on the sphere.
        std::array<Cell, 2> halves() const
        {
            const double mid = z + 0.5 * dz;
            const double height = std::acos(std::max(-1.0, z)) - std::acos(std::min(1.0, z + dz));
            const double width = std::sqrt(std::max(0.0, (1.0 - mid) * (1.0 + mid))) * dphi;
            if (height > width) {
                return {Cell{z, phi, 0.5 * dz, dphi}, Cell{mid, phi, 0.5 * dz, dphi}};
            }
            return {Cell{z, phi, dz, 0.5 * dphi}, Cell{z, phi + 0.5 * dphi, dz, 0.5 * dphi}};
        }
        bool holds(Place p) const  // half open, like its neighbours
        {
            return p.z >= z && p.z < z + dz && p.phi >= phi && p.phi < phi + dphi;
        }
    };

    void count(const Cell& cell, const std::vector<Place>& inside, int depth)
    {
        const double about = samples_ * refined(cell, gauss(cell), 0, 0);
        const auto observed = static_cast<double>(inside.size());
        // What was drawn decides only where the density seen so far cannot explain it: a peak
        // between the nodes of the quadrature. Otherwise the bins would depend on the draw.
        double most = observed;
        for (const Place& p : inside) {
            most = std::max(most, samples_ * p.pdf * cell.dz * cell.dphi / 4.0);
        }
        const bool unexplained = most > 10.0 + 4.0 * about;
        if (depth < 48 && (about > samples_ / 256.0 || unexplained)) {
            for (const Cell& part : cell.halves()) {
                std::vector<Place> places;
                std::copy_if(inside.begin(), inside.end(), std::back_inserter(places),
                             [&](Place p) { return part.holds(p); });
                count(part, places, depth + 1);
            }
            return;
        }
        add(observed, samples_ * refined(cell, gauss(cell), 1, 8));
    }

    void add(double observed, double expected) { bins_.push_back({expected, observed}); }

    double expected() const
    {
        double sum = 0.0;
        for (const Bin& bin : bins_) { sum += bin.expected; }
        return sum;
    }

    /// From the least upward, bins are joined to the next until they expect 5.
    Chi2 result(double integral)
    {
        std::sort(bins_.begin(), bins_.end(), [](Bin a, Bin b) { return a.expected < b.expected; });
        double statistic = 0.0, groups = 0.0;
        Bin group;
        for (const Bin& bin : bins_) {
            group = {group.expected + bin.expected, group.observed + bin.observed};
            if (group.expected < 5.0) { continue; }
            statistic += std::pow(group.observed - group.expected, 2) / group.expected;
            groups += 1.0;
            group = {};
        }
        const double degrees = std::max(1.0, groups - 1.0);
        return {groups == 0.0 ? 0.0 : gamma_q(0.5 * degrees, 0.5 * statistic), statistic, degrees,
                integral};
    }

  private:
    double at(double z, double phi) const
    {
        const double s = std::sqrt(std::max(0.0, (1.0 - z) * (1.0 + z)));
        return pdf_(Vec3{s * std::cos(phi), s * std::sin(phi), z});
    }

    /// Nine points of Gauss-Legendre.
    double gauss(const Cell& c) const
    {
        constexpr double x[] = {0.1127016653792583, 0.5, 0.8872983346207417};
        constexpr double w[] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
        double sum = 0.0;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                sum += w[i] * w[j] * at(c.z + x[i] * c.dz, c.phi + x[j] * c.dphi);
            }
        }
        return sum * c.dz * c.dphi;
    }

    /// Quartered until that changes no more than a hundredth of a sample. (Halving would do, but an
    /// edge along a row is not seen by halves of the row.)
    double refined(const Cell& c, double whole, int least, int most) const
    {
        std::array<double, 4> parts{};
        const auto part = [&](int k) {
            const bool upper = k % 2 == 1, farther = k >= 2;
            return Cell{upper ? c.z + 0.5 * c.dz : c.z, farther ? c.phi + 0.5 * c.dphi : c.phi,
                        0.5 * c.dz, 0.5 * c.dphi};
        };
        double sum = 0.0;
        for (int k = 0; k < 4; ++k) { sum += parts[static_cast<std::size_t>(k)] = gauss(part(k)); }
        if (most == 0 || (least <= 0 && samples_ * std::abs(sum - whole) < 0.01)) { return sum; }
        sum = 0.0;
        for (int k = 0; k < 4; ++k) {
            sum += refined(part(k), parts[static_cast<std::size_t>(k)], least - 1, most - 1);
        }
        return sum;
    }

    struct Bin {
        double expected = 0.0, observed = 0.0;
    };
    Pdf pdf_;
    double samples_;
    std::vector<Bin> bins_;
};

/// Draws `sample(0)` ... `sample(samples - 1)`, independent unit directions, and holds them against
/// pdf(direction) [1/sr] over the whole sphere. A sample without a direction (zero, or not a
/// number) is one that the density leaves out: 1 - its integral is expected of them. Expect p >
/// 1e-3, and of a full density an integral near 1.
template <class Sampler, class Pdf>
Chi2 chi2_directions(Sampler sample, Pdf pdf, int samples)
{
    using Bins = Chi2Bins<Pdf>;
    constexpr double turn = 2.0 * std::numbers::pi;
    constexpr int rows = 8, columns = 16;
    Bins bins(pdf, samples);
    std::vector<std::vector<typename Bins::Place>> places(rows * columns);
    double without = 0.0;
    for (int i = 0; i < samples; ++i) {
        const Vec3 w = sample(i);
        if (w == Vec3{} || !is_finite(w)) {
            without += 1.0;
            continue;
        }
        const double phi = std::atan2(w.y, w.x);
        const double z = std::clamp(w.z, -1.0, std::nextafter(1.0, 0.0));
        const double around = std::clamp(phi < 0.0 ? phi + turn : phi, 0.0, 0.999999999999 * turn);
        // z + 1 may round to 2: the pole belongs to the last row.
        const auto row = static_cast<std::size_t>(std::min(rows - 0.5, rows * 0.5 * (z + 1.0)));
        const auto column = static_cast<std::size_t>(columns * around / turn);
        places[row * columns + column].push_back({z, around, pdf(w)});
    }
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t column = 0; column < columns; ++column) {
            const double dz = 2.0 / rows, dphi = turn / columns;
            bins.count({-1.0 + static_cast<double>(row) * dz, static_cast<double>(column) * dphi,
                        dz, dphi},
                       places[row * columns + column], 0);
        }
    }
    const double integral = bins.expected() / samples;
    bins.add(without, std::max(0.0, samples - bins.expected()));
    return bins.result(integral);
}

}  // namespace relight::test
