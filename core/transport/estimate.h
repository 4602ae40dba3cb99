#pragma once

#include <span>

#include "core/base/rgb.h"
#include "core/transport/budget.h"

namespace relight {

/// A mean of replicates and its standard error (with Student's factor).
struct Estimate {
    Rgb value, standard_error;
};

/// Of direct light whose unoccluded E is known exactly (`closed`, one band): the samples only say
/// what share of it gets through, E = closed * sum(lit) / sum(all), sums over the points of each
/// replicate of what arrived and of what would have with nothing in the way. No noise where nothing
/// or everything is blocked; the bias of the quotient is of the order of its variance. Its error is
/// that of the residuals lit - share * all. When all replicates agree they know no error; a sliver
/// that none of their `rays` met is then counted as half a sample, closed / (2 rays).
/// @param bounced sums of what bounces bring over the same `each` points, counted in the error
/// alone; empty: none do
Estimate estimate_share(std::span<const double> lit, std::span<const double> all,
                        std::span<const Rgb> bounced, unsigned each, double closed, unsigned rays);

/// Of any light: E is the mean of `lit`, its error that of lit + bounced. Either may be empty:
/// none.
Estimate estimate_mean(std::span<const Rgb> lit, std::span<const Rgb> bounced, unsigned each);

}  // namespace relight
