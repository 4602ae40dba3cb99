#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/light/light_sample.h"

namespace relight::test {

struct Draw {
    Sample2 s;
    double pick;
};
/// Independent numbers, so that a standard error means what it says.
inline Draw draw(std::uint64_t seed, int i)
{
    const auto at = [&](std::uint64_t dimension) {
        return uniform(seed, 0, static_cast<std::uint64_t>(i), dimension);
    };
    return {{at(0), at(1)}, at(2)};
}

struct Estimate {
    double mean = 0.0, standard_error = 0.0;
    /// How many standard errors it is off; a spread that is rounding counts as 1e-12.
    double off(double expected) const
    {
        return (mean - expected) / std::max(standard_error, 1e-12 * std::abs(expected));
    }
};

/// Mean of f(i), i < n.
template <class F>
Estimate mean_of(int n, F f)
{
    double sum = 0.0, squares = 0.0, first = f(0);  // the first is near the mean: no cancellation
    for (int i = 0; i < n; ++i) {
        const double x = f(i) - first;
        sum += x;
        squares += x * x;
    }
    const double mean = sum / n;
    return {first + mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1))};
}

/// E at n (luminance) by a light's own samples, `sample(draw)` -> LightSample.
template <class Sampler>
Estimate irradiance_by_samples(Sampler sample, Dir3 n, int samples, std::uint64_t seed)
{
    return mean_of(samples, [&](int i) {
        const LightSample drawn = sample(draw(seed, i));
        const double cosine = dot(n, drawn.wi);
        return drawn.wi && cosine > 0.0 ? luminance(drawn.L) * cosine / drawn.pdf : 0.0;
    });
}

/// Root mean square of offsets in standard errors: near 1 if means and errors are both honest.
class Offsets {
  public:
    void add(double off)
    {
        sum_ += off * off;
        ++count_;
    }
    double rms() const { return std::sqrt(sum_ / std::max(1, count_)); }
    int count() const { return count_; }

  private:
    double sum_ = 0.0;
    int count_ = 0;
};

}  // namespace relight::test
