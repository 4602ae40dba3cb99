// Vectors of doubles, a vertex a lane, and how rows of floats and doubles become them. For files
// that include it after Highway, once for each instruction set.
#if defined(RELIGHT_SHADE_VECTORS) == defined(HWY_TARGET_TOGGLE)
#ifdef RELIGHT_SHADE_VECTORS
#undef RELIGHT_SHADE_VECTORS
#else
#define RELIGHT_SHADE_VECTORS
#endif

#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace relight::kernel::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::ScalableTag<double>;
using Double = hn::Vec<Doubles>;
using Halves = hn::Rebind<float, Doubles>;  // as many floats: half a vector of them
using Half = hn::Vec<Halves>;

/// Three numbers of each vertex: a place, a direction, a colour.
struct Vector {
    Double x, y, z;
};

HWY_INLINE Double all(double x)
{
    return hn::Set(Doubles(), x);
}
HWY_INLINE Vector all(const double (&v)[3])
{
    return {all(v[0]), all(v[1]), all(v[2])};
}

HWY_INLINE Vector operator+(Vector a, Vector b)
{
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HWY_INLINE Vector operator-(Vector a, Vector b)
{
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE Vector operator*(Vector a, Vector b)
{
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
HWY_INLINE Vector operator*(Vector a, Double s)
{
    return {a.x * s, a.y * s, a.z * s};
}
/// Signs of `sign` turn v about.
HWY_INLINE Vector turned(Vector v, Double sign)
{
    return {hn::Xor(v.x, sign), hn::Xor(v.y, sign), hn::Xor(v.z, sign)};
}
template <class Mask>
HWY_INLINE Vector where(Mask mask, Vector v)
{
    return {hn::IfThenElseZero(mask, v.x), hn::IfThenElseZero(mask, v.y),
            hn::IfThenElseZero(mask, v.z)};
}

/// Fused, as is all that is no sum of light.
HWY_INLINE Double dot(Vector a, Vector b)
{
    return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, a.x * b.x));
}
/// a + b s
HWY_INLINE Vector plus(Vector a, Vector b, Double s)
{
    return {hn::MulAdd(b.x, s, a.x), hn::MulAdd(b.y, s, a.y), hn::MulAdd(b.z, s, a.z)};
}
/// a - b s
HWY_INLINE Vector minus(Vector a, Vector b, Double s)
{
    return {hn::NegMulAdd(b.x, s, a.x), hn::NegMulAdd(b.y, s, a.y), hn::NegMulAdd(b.z, s, a.z)};
}

/// x^(-1/2), to some 1e-15 of it, with neither root nor quotient: a first guess is mended by the
/// series of (1 - e)^(-1/2), e = 1 - x y^2. The guess is the processor's, within 2^-14, or comes of
/// halving the exponent, within 3.5 %, and is mended twice. Of 0 it is large, but a number.
HWY_INLINE Double inverse_root(Double x)
{
    const Double c1 = all(0.5), c2 = all(0.375), c3 = all(0.3125), one = all(1.0);
#if HWY_TARGET <= HWY_AVX3
    x = hn::Max(x, all(1e-300));
    const Double guess{_mm512_rsqrt14_pd(x.raw)};
#else
    const Doubles d;
    const hn::RebindToUnsigned<Doubles> bits;
    const auto halved = hn::ShiftRight<1>(hn::BitCast(bits, x));
    const Double first = hn::BitCast(d, hn::Set(bits, 0x5FE6EB50C7B537A9ULL) - halved);
    const Double off = hn::NegMulAdd(x * first, first, one);
    const Double guess =
        hn::MulAdd(first * off, hn::MulAdd(off, hn::MulAdd(off, c3, c2), c1), first);
#endif
    const Double e = hn::NegMulAdd(x * guess, guess, one);
    return hn::MulAdd(guess * e, hn::MulAdd(e, hn::MulAdd(e, c3, c2), c1), guess);
}

// Of rows of `bands` numbers, those of a vector's vertices; where fewer are left, 0 for the rest.

template <std::size_t bands, class T>
struct Rows {
    HWY_ALIGN T tail[bands * hn::MaxLanes(Doubles())];  // as it is, unless it is needed
    const T* from;

    HWY_INLINE Rows(const T* rows, std::size_t left) : from(rows)
    {
        if (left >= hn::Lanes(Doubles())) { return; }
        std::memset(tail, 0, sizeof(tail));
        std::memcpy(tail, rows, left * bands * sizeof(T));
        from = tail;
    }
};

HWY_INLINE Vector read_rows(const double* rows, std::size_t left)
{
    const Rows<3, double> some(rows, left);
    Vector v;
    hn::LoadInterleaved3(Doubles(), some.from, v.x, v.y, v.z);
    return v;
}
HWY_INLINE Vector read_rows(const float* rows, std::size_t left)
{
    const Doubles d;
    const Rows<3, float> some(rows, left);
    Half r, g, b;
    hn::LoadInterleaved3(Halves(), some.from, r, g, b);
    return {hn::PromoteTo(d, r), hn::PromoteTo(d, g), hn::PromoteTo(d, b)};
}
HWY_INLINE Double read(const float* values, std::size_t left)
{
    const Rows<1, float> some(values, left);
    return hn::PromoteTo(Doubles(), hn::LoadU(Halves(), some.from));
}

/// Rounded.
HWY_INLINE void write_rows(Vector v, float* rows, std::size_t left)
{
    const Halves d;
    const Half r = hn::DemoteTo(d, v.x), g = hn::DemoteTo(d, v.y), b = hn::DemoteTo(d, v.z);
    if (left >= hn::Lanes(d)) {
        hn::StoreInterleaved3(r, g, b, d, rows);
    } else {
        HWY_ALIGN float tail[3 * hn::MaxLanes(Doubles())];
        hn::StoreInterleaved3(r, g, b, d, tail);
        std::memcpy(rows, tail, 3 * left * sizeof(float));
    }
}

/// From attributes' arrays, aligned.
template <std::size_t size>
HWY_INLINE Vector load(const double (&from)[3][size], std::size_t i)
{
    const Doubles d;
    return {hn::Load(d, from[0] + i), hn::Load(d, from[1] + i), hn::Load(d, from[2] + i)};
}
template <std::size_t size>
HWY_INLINE void store(Vector v, double (&to)[3][size], std::size_t i)
{
    const Doubles d;
    hn::Store(v.x, d, to[0] + i);
    hn::Store(v.y, d, to[1] + i);
    hn::Store(v.z, d, to[2] + i);
}

}  // namespace
}  // namespace relight::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
