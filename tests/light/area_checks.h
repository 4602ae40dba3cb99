#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/random.h"
#include "core/light/light.h"

/// What the tests of area lights share: random places, lights, and estimates by sample().
namespace relight::test {

/// Independent numbers of one item.
class Numbers {
  public:
    explicit Numbers(std::uint64_t item) : item_(item) {}
    double next() { return uniform(20260731, item_, count_++, 0); }
    double between(double lo, double hi) { return lo + (hi - lo) * next(); }
    /// Uniform in the logarithm.
    double scale(double lo, double hi) { return std::exp(between(std::log(lo), std::log(hi))); }
    Sample2 square() { return {next(), next()}; }
    Dir3 direction()
    {
        const double z = between(-1.0, 1.0), phi = between(0.0, 2.0 * std::numbers::pi);
        const double s = std::sqrt(1.0 - z * z);
        return normalize({s * std::cos(phi), s * std::sin(phi), z});
    }
    Vec3 vector(double size) { return Vec3(direction()) * (size * std::cbrt(next())); }
    Point3 point(double size) { return Point3{} + vector(size); }

  private:
    std::uint64_t item_, count_ = 0;
};

struct Estimate {
    double mean = 0.0, error = 0.0;
};

/// E at p facing n by independent samples of the light.
template <class Draw>
Estimate estimate(Draw draw, Dir3 n, int samples)
{
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < samples; ++i) {
        const LightSample seen = draw();
        if (!seen.wi) { continue; }
        const double f = seen.L.g * std::max(0.0, dot(n, seen.wi)) / seen.pdf;
        sum += f;
        squares += f * f;
    }
    const double mean = sum / samples;
    return {mean, std::sqrt(std::max(0.0, squares / samples - mean * mean) / (samples - 1))};
}

/// The normalised errors of many estimates: none beyond 4, at most max(2, 1 %) beyond 3, and of
/// rms 1 (less: the errors are not what they claim; more: a bias).
struct Deviations {
    std::vector<double> z;

    void add(const Estimate& by_samples, double exact)
    {
        if (by_samples.error <= 1e-12 * exact) {  // the estimator has no variance
            EXPECT_NEAR(by_samples.mean, exact, 1e-9 * exact);
            return;
        }
        z.push_back((by_samples.mean - exact) / by_samples.error);
        EXPECT_LT(std::abs(z.back()), 4.0) << by_samples.mean << " for " << exact;
    }
    void check() const
    {
        double squares = 0.0;
        std::size_t beyond_3 = 0;
        for (const double x : z) {
            squares += x * x;
            beyond_3 += std::abs(x) > 3.0 ? 1 : 0;
        }
        const double rms = std::sqrt(squares / static_cast<double>(z.size()));
        EXPECT_GT(rms, 0.7);
        EXPECT_LT(rms, 1.35);
        EXPECT_LE(beyond_3, std::max<std::size_t>(2, z.size() / 100));
    }
};

/// A light of any size at about the origin.
inline RectLight some_rect(Numbers& random)
{
    RectLight light{random.point(1.0), {}, {}, random.next() < 0.3};
    light.edge_u = Vec3(random.direction()) * random.scale(0.01, 3.0);
    light.edge_v = Vec3(random.direction()) * random.scale(0.01, 3.0);
    return light;
}
inline DiskLight some_disk(Numbers& random)
{
    return {random.point(1.0), random.direction(), random.scale(0.01, 3.0)};
}
inline SphereLight some_sphere(Numbers& random)
{
    return {random.point(1.0), random.scale(0.01, 2.0)};
}

}  // namespace relight::test
