#pragma once

#include <optional>

#include "core/transport/budget.h"

namespace relight {

/// A mean of replicates and its standard error.
struct Estimate {
    Rgb value, standard_error;
};

/// Mean of the replicates and its standard error (with Student's factor), of what has been
/// collected from `each` points a replicate.
///
/// Where the unoccluded E is known exactly (`closed`, one band), the samples only say what share of
/// it gets through: E = closed * sum(lit) / sum(all). No noise where nothing or everything is
/// blocked; the bias of the quotient is of the order of its variance. Its error is that of the
/// residuals lit - share * all. When all replicates agree they know no error; a sliver that none of
/// their N points met is then counted as half a sample, closed / (2 N).
Estimate estimate(const Tally& tally, unsigned replicates, unsigned each,
                  std::optional<double> closed);

}  // namespace relight
