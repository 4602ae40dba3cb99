#include "core/transport/estimate.h"

#include <algorithm>

namespace relight {
namespace {

constexpr double agreement = 1e-12;  // of the replicates' shares, but for rounding

template <class Combine>
Rgb per_band(Rgb a, Rgb b, Combine combine)
{
    return {combine(a.r, b.r), combine(a.g, b.g), combine(a.b, b.b)};
}

}  // namespace

Estimate estimate(const Tally& tally, unsigned replicates, unsigned each,
                  std::optional<double> closed)
{
    const double n = each;
    const double R = replicates;
    Rgb lit, all, bounced;
    for (unsigned r = 0; r < replicates; ++r) {
        lit += tally.lit[r];
        all += tally.all[r];
        bounced += tally.bounced[r];
    }
    const auto quotient = [](double a, double b) { return b > 0.0 ? a / b : 0.0; };
    const Rgb share = per_band(lit, all, quotient);
    Estimate result;
    result.value = closed ? share * *closed : lit / (n * R);
    // A replicate's deviation from the mean, direct and bounced light together.
    Rgb squares;
    for (unsigned r = 0; r < replicates; ++r) {
        Rgb deviation = (tally.bounced[r] - bounced / R) / n;
        if (closed) {
            const Rgb residual = tally.lit[r] - share * tally.all[r];
            deviation += per_band(residual * R, all, quotient) * *closed;
        } else {
            deviation += (tally.lit[r] - lit / R) / n;
        }
        squares += deviation * deviation;
    }
    const double factor = student_factor(replicates);
    const auto root = [&](double sum) { return factor * std::sqrt(sum / (R * (R - 1.0))); };
    result.standard_error = {root(squares.r), root(squares.g), root(squares.b)};
    if (closed && all == Rgb{}) {  // no point met what little of the light is above the horizon
        result.standard_error += Rgb::grey(*closed);
    }
    const double most =
        std::max({result.standard_error.r, result.standard_error.g, result.standard_error.b});
    if (closed && tally.rays > 0 && most <= agreement * *closed) {
        result.standard_error += Rgb::grey(0.5 * *closed / tally.rays);
    }
    return result;
}

}  // namespace relight
