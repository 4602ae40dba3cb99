#pragma once

#include <memory>
#include <vector>

#include "core/base/vec.h"

namespace relight {

/// A photometric web, LM-63 Type C: intensity over vertical angle (from the axis) and horizontal
/// angle. Candela are final (multiplier and ballast factor multiplied in).
struct IesProfile {
    std::vector<double> vertical_deg;    ///< ascending, at least 1, within 0..180
    std::vector<double> horizontal_deg;  ///< ascending; the last says the symmetry (0, 90, 180,
                                         ///< 360; or 90..270)
    std::vector<double> candela;         ///< [horizontal][vertical], not negative
};

/// I(theta, phi) [cd]: bilinear in degrees, 0 outside the tabulated vertical angles; the horizontal
/// angle is folded by the web's symmetry.   Contract section 2. Test: Ies.*
double intensity(const IesProfile& profile, double vertical_deg, double horizontal_deg);

/// Integral of I over the sphere [lm], of the bilinear interpolant, exact.
double flux(const IesProfile& profile);

/// A point that shines as its profile says. Power multiplies the candela.
struct IesLight {
    Point3 position;
    Dir3 axis;  ///< of vertical angle 0: the way its main light travels
    Dir3 h0;  ///< of horizontal angle 0, made perpendicular to axis; 90 degrees = cross(-axis, h0)
    std::shared_ptr<const IesProfile> profile;
};
/// I toward the receiver whose direction to the light is wi [cd].
double intensity_toward(const IesLight& light, Dir3 wi);

}  // namespace relight
