#include "core/transport/estimate.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace relight {
namespace {

constexpr double agreement = 1e-12;  // of the replicates' shares, but for rounding

Rgb sum_of(std::span<const Rgb> values)
{
    return std::accumulate(values.begin(), values.end(), Rgb{});
}

/// Of the mean of R values, from the sum of the squares of their deviations.
double standard_error(double squares, double R)
{
    return student_factor(static_cast<unsigned>(R)) * std::sqrt(squares / (R * (R - 1.0)));
}

}  // namespace

Estimate estimate_share(std::span<const double> lit, std::span<const double> all,
                        std::span<const Rgb> bounced, unsigned each, double closed, unsigned rays)
{
    const double n = each, R = static_cast<double>(lit.size());
    const double lit_sum = std::accumulate(lit.begin(), lit.end(), 0.0);
    const double all_sum = std::accumulate(all.begin(), all.end(), 0.0);
    const double share = all_sum > 0.0 ? lit_sum / all_sum : 0.0;
    const double scale = all_sum > 0.0 ? closed * R / all_sum : 0.0;
    const auto residual = [&](std::size_t r) { return (lit[r] - share * all[r]) * scale; };
    Estimate result{Rgb::grey(share * closed), {}};
    Rgb& error = result.standard_error;
    if (bounced.empty()) {
        double squares = 0.0;
        for (std::size_t r = 0; r < lit.size(); ++r) { squares += residual(r) * residual(r); }
        error = Rgb::grey(standard_error(squares, R));
    } else {
        const Rgb mean = sum_of(bounced) / R;
        Rgb squares;
        for (std::size_t r = 0; r < lit.size(); ++r) {
            const Rgb deviation = Rgb::grey(residual(r)) + (bounced[r] - mean) / n;
            squares += deviation * deviation;
        }
        error = {standard_error(squares.r, R), standard_error(squares.g, R),
                 standard_error(squares.b, R)};
    }
    // No point met what little of the light is above the horizon.
    if (all_sum == 0.0) { error += Rgb::grey(closed); }
    if (rays > 0 && std::max({error.r, error.g, error.b}) <= agreement * closed) {
        error += Rgb::grey(0.5 * closed / rays);
    }
    return result;
}

Estimate estimate_mean(std::span<const Rgb> lit, std::span<const Rgb> bounced, unsigned each)
{
    const std::size_t replicates = std::max(lit.size(), bounced.size());
    const double n = each, R = static_cast<double>(replicates);
    const Rgb lit_mean = sum_of(lit) / R, bounced_mean = sum_of(bounced) / R;
    Rgb squares;
    for (std::size_t r = 0; r < replicates; ++r) {
        Rgb deviation;
        if (!lit.empty()) { deviation += lit[r] - lit_mean; }
        if (!bounced.empty()) { deviation += bounced[r] - bounced_mean; }
        squares += deviation * deviation / (n * n);
    }
    return {
        lit_mean / n,
        {standard_error(squares.r, R), standard_error(squares.g, R), standard_error(squares.b, R)}};
}

}  // namespace relight
