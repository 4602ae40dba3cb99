#pragma once

#include <type_traits>

#include "core/base/rgb.h"

namespace relight {

/// W^w m^m sr^s. SI calls sr dimensionless; here it tells radiance from irradiance, so that adding
/// E to L does not compile. In a photometric scene read lm for W: the formulas are the same.
template <int W, int M, int Sr, class Rep = Rgb>
struct Quantity {
    Rep value{};

    constexpr Quantity operator+(Quantity b) const { return {value + b.value}; }
    constexpr Quantity operator*(double s) const { return {value * s}; }
    constexpr Quantity operator/(double s) const { return {value / s}; }
    constexpr Quantity& operator+=(Quantity b) { return *this = *this + b; }
    constexpr bool operator==(const Quantity&) const = default;
};

/// A product adds the exponents.
template <int W1, int M1, int S1, class R1, int W2, int M2, int S2, class R2>
constexpr auto operator*(Quantity<W1, M1, S1, R1> a, Quantity<W2, M2, S2, R2> b)
{
    using Rep = decltype(a.value * b.value);
    return Quantity<W1 + W2, M1 + M2, S1 + S2, Rep>{a.value * b.value};
}

using RadiantFlux = Quantity<1, 0, 0>;                 ///< Phi [W]
using RadiantIntensity = Quantity<1, 0, -1>;           ///< I [W/sr]
using Irradiance = Quantity<1, -2, 0>;                 ///< E [W/m^2]
using Radiance = Quantity<1, -2, -1>;                  ///< L [W/(m^2 sr)]
using BsdfValue = Quantity<0, 0, -1>;                  ///< f [1/sr]
using SolidAnglePerArea = Quantity<0, -2, 1, double>;  ///< dw/dA [sr/m^2]
static_assert(std::is_same_v<decltype(BsdfValue{} * Irradiance{}), Radiance>);
static_assert(std::is_same_v<decltype(RadiantIntensity{} * SolidAnglePerArea{}), Irradiance>);

}  // namespace relight
