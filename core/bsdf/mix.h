#pragma once

namespace relight {

/// a (1 - t) + b t: exactly a at t = 0 and exactly b at t = 1, band by band for colours.
template <class Value>
constexpr Value mix(Value a, Value b, double t)
{
    return a * (1.0 - t) + b * t;
}

}  // namespace relight
