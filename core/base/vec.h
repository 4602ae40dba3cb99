#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace relight {

/// A displacement, in scene units (double: formulas compute in double, arrays for Embree are
/// float).
struct Vec3 {
    double x{}, y{}, z{};

    constexpr Vec3 operator+(Vec3 b) const { return {x + b.x, y + b.y, z + b.z}; }
    constexpr Vec3 operator-(Vec3 b) const { return {x - b.x, y - b.y, z - b.z}; }
    constexpr Vec3 operator-() const { return {-x, -y, -z}; }
    constexpr Vec3 operator*(double s) const { return {x * s, y * s, z * s}; }
    constexpr Vec3 operator/(double s) const { return {x / s, y / s, z / s}; }
    constexpr Vec3& operator+=(Vec3 b) { return *this = *this + b; }
    constexpr bool operator==(const Vec3&) const = default;
};
constexpr Vec3 operator*(double s, Vec3 v)
{
    return v * s;
}

/// A place. Subtracting two gives a Vec3; adding two does not compile.
struct Point3 {
    double x{}, y{}, z{};

    constexpr Vec3 operator-(Point3 b) const { return {x - b.x, y - b.y, z - b.z}; }
    constexpr Point3 operator+(Vec3 v) const { return {x + v.x, y + v.y, z + v.z}; }
    constexpr Point3 operator-(Vec3 v) const { return {x - v.x, y - v.y, z - v.z}; }
    constexpr bool operator==(const Point3&) const = default;
};

/// A unit direction; `normalize` makes it. The default is "no direction" (all zero), which
/// tests false: a vertex without a normal holds it.
class Dir3 {
  public:
    constexpr Dir3() = default;
    constexpr double x() const { return v_.x; }
    constexpr double y() const { return v_.y; }
    constexpr double z() const { return v_.z; }
    constexpr operator Vec3() const
    {
        return v_;
    }  // NOLINT: a direction is a vector wherever one is asked for
    constexpr Dir3 operator-() const { return Dir3(-v_); }
    constexpr explicit operator bool() const { return v_ != Vec3{}; }
    constexpr bool operator==(const Dir3&) const = default;

  private:
    constexpr explicit Dir3(Vec3 v) : v_(v) {}
    friend Dir3 normalize(Vec3 v);
    friend constexpr Dir3 unit_already(Vec3 v);
    Vec3 v_;
};

/// v, whose length is 1 to within rounding by the way it was made (drawn on the sphere, turned by a
/// frame): what normalize() would give, without its root and quotients.
constexpr Dir3 unit_already(Vec3 v)
{
    return Dir3(v);
}

constexpr double dot(Vec3 a, Vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3 cross(Vec3 a, Vec3 b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Where v . v is a number of full precision: beyond, its squares overflow or vanish.
constexpr bool is_moderate(double squared)
{
    return squared > 1e-200 && squared < 1e200;
}

/// |v|, free of overflow and underflow for any finite v.
inline double length(Vec3 v)
{
    const double squared = dot(v, v);
    return is_moderate(squared) ? std::sqrt(squared) : std::hypot(v.x, v.y, v.z);
}

/// v / |v|; a zero or non-finite vector gives "no direction".
inline Dir3 normalize(Vec3 v)
{
    const double squared = dot(v, v);
    if (is_moderate(squared)) { return Dir3(v / std::sqrt(squared)); }
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!(largest > 0.0) || !std::isfinite(largest)) { return {}; }
    const Vec3 scaled = v / largest;
    return Dir3(scaled / std::sqrt(dot(scaled, scaled)));
}

constexpr bool is_finite(double x)
{
    return x - x == 0.0;
}
constexpr bool is_finite(Vec3 v)
{
    return is_finite(v.x) && is_finite(v.y) && is_finite(v.z);
}
constexpr bool is_finite(Point3 p)
{
    return is_finite(p - Point3{});
}

/// Two unit vectors that complete n to a right-handed frame (x, y, n). Duff et al. 2017.
struct Frame {
    Dir3 x, y, n;

    Vec3 to_local(Vec3 v) const { return {dot(x, v), dot(y, v), dot(n, v)}; }
    Vec3 to_world(Vec3 v) const { return Vec3(x) * v.x + Vec3(y) * v.y + Vec3(n) * v.z; }
};
inline Frame frame_around(Dir3 n)
{
    const double sign = std::copysign(1.0, n.z());
    const double a = -1.0 / (sign + n.z());
    const double b = n.x() * n.y() * a;
    return {normalize({1.0 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()}),
            normalize({b, sign + n.y() * n.y() * a, -n.y()}), n};
}

using Triangle =
    std::array<unsigned, 3>;  ///< vertex indices, counter-clockwise seen from the front

}  // namespace relight
