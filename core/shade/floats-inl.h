// Vectors of floats, a vertex a lane, and what all models of reflection share. For files that
// include it after Highway, once for each instruction set.
#if defined(RELIGHT_SHADE_FLOATS) == defined(HWY_TARGET_TOGGLE)
#ifdef RELIGHT_SHADE_FLOATS
#undef RELIGHT_SHADE_FLOATS
#else
#define RELIGHT_SHADE_FLOATS
#endif

#include "core/shade/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relight::kernel::HWY_NAMESPACE {
namespace {

using Floats = hn::ScalableTag<float>;
using Float = hn::Vec<Floats>;
using Ints = hn::RebindToSigned<Floats>;

constexpr float inv_pi = 0.318309886F;
// Denominators stay above it: with both directions in the plane f is large, but a number.
constexpr float least = 1e-30F;

HWY_INLINE Float all(float x)
{
    return hn::Set(Floats(), x);
}
HWY_INLINE Float square(Float x)
{
    return x * x;
}
/// a (1 - t) + b t
HWY_INLINE Float mix(Float a, Float b, Float t)
{
    return hn::MulAdd(t, b - a, a);
}

struct Bands {
    Float r, g, b;
};
HWY_INLINE Bands operator+(Bands a, Bands b)
{
    return {a.r + b.r, a.g + b.g, a.b + b.b};
}
HWY_INLINE Bands operator*(Bands a, Bands b)
{
    return {a.r * b.r, a.g * b.g, a.b * b.b};
}
HWY_INLINE Bands operator*(Bands a, Float s)
{
    return {a.r * s, a.g * s, a.b * s};
}
/// a s + c
HWY_INLINE Bands mul_add(Bands a, Float s, Bands c)
{
    return {hn::MulAdd(a.r, s, c.r), hn::MulAdd(a.g, s, c.g), hn::MulAdd(a.b, s, c.b)};
}
HWY_INLINE Bands grey(Float x)
{
    return {x, x, x};
}
HWY_INLINE Bands all(const float (&v)[3])
{
    return {all(v[0]), all(v[1]), all(v[2])};
}
HWY_INLINE Bands mix(Bands a, Bands b, Float t)
{
    return {mix(a.r, b.r, t), mix(a.g, b.g, t), mix(a.b, b.b, t)};
}

/// sin^2 of a direction at cosine c.
HWY_INLINE Float sin2_of(Float c)
{
    return hn::Max((all(1.0F) - c) * (all(1.0F) + c), all(0.0F));
}

/// S = (1 - u)^5 of Schlick's F = F0 + (F90 - F0) S.
HWY_INLINE Float S(Float u)
{
    const Float w = hn::Max(all(1.0F) - u, all(0.0F));
    return square(square(w)) * w;
}
HWY_INLINE Float schlick(float F0, Float s, float F90 = 1.0F)
{
    return hn::MulAdd(all(F90 - F0), s, all(F0));
}

/// What f depends on at some vertices, whatever the light. Models take what they need.
struct Outgoing {
    Float co;
    Float x, y;  ///< wo along the lobe's axes: anisotropic models'
    Bands base;
    Float aside[4];  ///< what a model makes of wo
};

/// And of the light. h is wi + wo, not unit; h2 = |h|^2, hxy2 of it across the normal, hz along it.
struct At {
    Float ci, co, h2, hxy2, hz, cos_d;
    Float along;           ///< wi.wo across the normal: Oren-Nayar's
    Float x, y, h_x, h_y;  ///< wi and h along the lobe's axes: anisotropic models'
};

}  // namespace
}  // namespace relight::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
