#include "core/geometry/precision.h"

#include <algorithm>
#include <cmath>

namespace relight {

bool float_loses_text(std::span<const Point3> positions)
{
    if (positions.empty()) { return false; }
    Point3 low = positions.front(), high = low;
    double most = 0.0;  // moved by rounding
    for (const Point3& p : positions) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
        for (const double c : {p.x, p.y, p.z}) {
            most = std::max(most, std::abs(static_cast<double>(static_cast<float>(c)) - c));
        }
    }
    return most > 1e-7 * length(high - low);
}

bool float_loses(std::span<const Point3> positions)
{
    const auto is_float = [](double c) { return static_cast<double>(static_cast<float>(c)) == c; };
    return !std::all_of(positions.begin(), positions.end(), [&](const Point3& p) {
        return is_float(p.x) && is_float(p.y) && is_float(p.z);
    });
}

}  // namespace relight
