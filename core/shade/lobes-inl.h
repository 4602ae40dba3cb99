// The lobes of which f is made, in float, a vector of vertices at a time: the formulas of
// core/bsdf, turned so that they need no angle and lose no digits. With h = wi + wo (not unit):
// cos_d = |h| / 2, cos_m = h_z / |h|, tan_m = |n x h| / h_z. For shine.cpp, which includes this
// after Highway, once for each instruction set.
#if defined(RELIGHT_SHADE_LOBES) == defined(HWY_TARGET_TOGGLE)
#ifdef RELIGHT_SHADE_LOBES
#undef RELIGHT_SHADE_LOBES
#else
#define RELIGHT_SHADE_LOBES
#endif

#include "core/bsdf/charlie.h"
#include "core/shade/floats-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relight::kernel::HWY_NAMESPACE {
namespace {

/// The square of a vector across the normal, stretched by a lobe's widths along its axes.
template <bool anisotropic>
HWY_INLINE Float stretched(float x2, float y2, Float across2, Float x, Float y)
{
    if constexpr (anisotropic) { return hn::MulAdd(all(x2), square(x), all(y2) * square(y)); }
    return all(x2) * across2;
}
template <bool anisotropic>
HWY_INLINE Float stretched_h(const Facets& l, const At& a)
{
    return stretched<anisotropic>(l.inv_ax2, l.inv_ay2, a.hxy2, a.h_x, a.h_y);
}
/// Of wi or wo, at cosine c.
template <bool anisotropic>
HWY_INLINE Float stretched_w(const Facets& l, Float c, Float x, Float y)
{
    return stretched<anisotropic>(l.ax2, l.ay2, sin2_of(c), x, y);
}

/// cos + 2 Lambda cos of GGX: Lambda cos = (root - cos) / 2.
HWY_INLINE Float ggx_root(Float alpha2, Float c)
{
    return hn::Sqrt(hn::MulAdd(all(1.0F) - alpha2, square(c), alpha2));
}
template <bool anisotropic>
HWY_INLINE Float ggx_root(const Facets& l, Float c, Float x, Float y)
{
    if constexpr (anisotropic) { return hn::Sqrt(hn::MulAdd(c, c, stretched_w<true>(l, c, x, y))); }
    return ggx_root(all(l.ax2), c);
}

/// D V of GGX. With p = |h stretched by 1/alpha|^2: D = peak (h2 / p)^2, and
/// V = 1 / 2 (co root_i + ci root_o) (height-correlated) or 1 / ((ci + root_i) (co + root_o)). One
/// quotient; the powers of two keep its parts in range.
HWY_INLINE Float ggx(const Facets& l, const At& a, Float h_stretched, Float root_i, Float root_o,
                     bool separable)
{
    const Float far = all(0x1p30F);
    const Float p = far * hn::MulAdd(a.hz, a.hz, h_stretched);
    const Float area = separable ? (a.ci + root_i) * (a.co + root_o)
                                 : all(2.0F) * hn::MulAdd(a.co, root_i, a.ci * root_o);
    return all(l.peak) * square(far * a.h2) / hn::Max(square(p) * area, all(least));
}

/// V from Lambda cos of both directions.
HWY_INLINE Float V(const At& a, Float Li, Float Lo, bool separable)
{
    const Float area = separable ? (a.ci + Li) * (a.co + Lo)
                                 : hn::MulAdd(a.ci, a.co, hn::MulAdd(Li, a.co, Lo * a.ci));
    return all(0.25F) / hn::Max(area, all(least));
}

/// Lambda cos of Beckmann = t T(cos / t): exp(-a^2) / (2 sqrt pi) - a erfc(a) / 2 by a polynomial
/// through Chebyshev's nodes of [0, 4], within 1e-7 (of the sum cos + Lambda cos: 3e-7); beyond, T
/// is below 2e-9.
HWY_INLINE Float Lambda_beckmann(Float c, Float t2)
{
    constexpr float T[] = {0.00048900887F, -0.00467773262F, 0.0206673881F,   -0.0551123443F,
                           0.0964352159F,  -0.110213593F,   0.0699179487F,   0.00409089169F,
                           -0.0546196821F, 0.0458294951F,   -0.00098726697F, -0.0262020216F,
                           0.0151470083F,  0.0048213653F,   -0.0072595098F,  0.000778130964F,
                           0.00125728777F, -0.000361588246F};
    const Float t = hn::Sqrt(t2);
    const Float a = hn::Min(c / hn::Max(t, all(least)), all(4.0F));
    const Float x = hn::MulAdd(a, all(0.5F), all(-1.0F));
    Float sum = all(T[17]);
    for (int k = 16; k >= 0; --k) { sum = hn::MulAdd(sum, x, all(T[k])); }
    return t * hn::Max(sum, all(0.0F));
}

/// D of Beckmann = peak exp(-tan^2 / alpha^2) / cos^4.
HWY_INLINE Float D_beckmann(const Facets& l, const At& a, Float h_stretched)
{
    const Float hz2 = hn::Max(square(a.hz), all(least));
    const Float steep = hn::Min(h_stretched / hz2, all(200.0F));  // of which exp is 0
    const Float inv_cos2 = hn::Min(a.h2 / hz2, all(1e9F));
    return all(l.peak) * hn::Exp(Floats(), hn::Neg(steep)) * square(inv_cos2);
}

/// Through the four nodes around `place` of a table of `nodes`, by Lagrange's cubic.
HWY_INLINE Float cubic(const float* table, int nodes, Float place)
{
    const Floats d;
    const Ints ints;
    const auto first =
        hn::Min(hn::Max(hn::ConvertTo(ints, place) - hn::Set(ints, 1), hn::Zero(ints)),
                hn::Set(ints, nodes - 4));
    const Float t = place - hn::ConvertTo(d, first);
    const Float t1 = t - all(1.0F), t2 = t - all(2.0F), t3 = t - all(3.0F);
    const Float y0 = hn::GatherIndex(d, table, first), y1 = hn::GatherIndex(d, table + 1, first),
                y2 = hn::GatherIndex(d, table + 2, first),
                y3 = hn::GatherIndex(d, table + 3, first);
    const Float outer = (y3 * t * t1 * t2 - y0 * t1 * t2 * t3) * all(1.0F / 6.0F);
    return outer + (y1 * t2 * t3 - y2 * t1 * t3) * t * all(0.5F);
}

/// Of a GTR lobe, from gtr::Masking's table.
HWY_INLINE Float Lambda_gtr(const Reflector& m, Float c)
{
    const Float place =
        hn::Asinh(Floats(), hn::Min(c, all(1.0F)) * all(m.inv_alpha)) * all(m.gtr_scale);
    return hn::Exp(Floats(), cubic(m.gtr_table, gtr::Masking::nodes, place)) * sin2_of(c);
}

/// (cos^2 + sin^2 / alpha^2) of h: what GTR's bracket is, over its value at the pole.
HWY_INLINE Float gtr_u(const At& a, Float h_stretched)
{
    return hn::MulAdd(a.hz, a.hz, h_stretched) / hn::Max(a.h2, all(least));
}
HWY_INLINE Float D_gtr(const Reflector& m, const At& a, Float h_stretched)
{
    const Float ln_u = hn::Log(Floats(), hn::Max(gtr_u(a, h_stretched), all(1e-3F)));
    return all(m.facets.peak) * hn::Exp(Floats(), all(-m.gamma) * ln_u);
}

/// 1 - E(cos): what facets lose of light from there to others (MultiscatterTable).
HWY_INLINE Float lost(const Reflector& m, Float c)
{
    const Float x = hn::Asinh(Floats(), hn::Min(c, all(1.0F)) * all(m.lost_inv_scale));
    const Float place =
        all(float{MultiscatterTable::nodes - 1}) * hn::Sqrt(x * all(m.lost_inv_reach));
    const Float share = cubic(m.lost_table, MultiscatterTable::nodes, place);
    return hn::Min(hn::Max(share, all(0.0F)), all(1.0F));
}

/// Fresnel's equations. With g = sqrt(N^2 - sin^2): r_s = (u - g) / (u + g) = (1 - N^2) / (u + g)^2
/// and r_p = (N^2 u - g) / (N^2 u + g) = (N^2 - 1) ((N^2 + 1) u^2 - 1) / (N^2 u + g)^2, in which
/// nothing cancels but what vanishes (Brewster's angle). Beyond the critical angle g is imaginary.
HWY_INLINE Float fresnel(const Boundary& n, Float u, Float u2)
{
    const Float im = all(n.imaginary);
    const Float g2 = all(n.less) + u2;  // real part
    const Float size = hn::Sqrt(hn::MulAdd(g2, g2, im * im));
    const Float longer = hn::Sqrt(all(0.5F) * (size + hn::Abs(g2)));
    const Float shorter = all(0.5F) * im / hn::Max(longer, all(least));
    const auto forward = g2 > all(0.0F);
    const Float g = hn::IfThenElse(forward, longer, shorter);  // its real part, and
    const Float k = hn::IfThenElse(forward, shorter, longer);  // its imaginary part
    const Float s2 = hn::MulAdd(u + g, u + g, k * k);          // |u + g|^2
    const Float rs = all(n.distance) / hn::Max(s2, all(least));
    const Float pr = hn::MulAdd(all(n.N2), u, g), pi = hn::MulAdd(im, u, k);
    const Float qr = hn::MulAdd(all(n.more), u2, all(-1.0F)), qi = im * u2;
    const Float rp = all(n.distance) * hn::Sqrt(hn::MulAdd(qr, qr, qi * qi)) /
                     hn::Max(hn::MulAdd(pr, pr, pi * pi), all(least));
    const Float one = all(1.0F);
    return all(0.5F) * (hn::Min(rs * rs, one) + hn::Min(rp * rp, one));
}

HWY_INLINE Bands F(const Reflector& m, const At& a)
{
    if (m.boundaries == 0) {
        const Float s = S(a.cos_d);
        return {schlick(m.F0[0], s), schlick(m.F0[1], s), schlick(m.F0[2], s)};
    }
    const Float u = hn::Min(a.cos_d, all(1.0F));
    const Float u2 = hn::Min(all(0.25F) * a.h2, all(1.0F));
    const Float r = fresnel(m.boundary[0], u, u2);
    if (m.boundaries == 1) { return grey(r); }
    return {r, fresnel(m.boundary[1], u, u2), fresnel(m.boundary[2], u, u2)};
}

/// Charlie's Lambda: exp of a fit (core/bsdf/charlie.h).
HWY_INLINE Float Lambda_charlie(const Reflector& m, Float c)
{
    const Floats d;
    const auto [a, b, power, slope, rest] = m.charlie_fit;
    const auto low = c < all(0.5F);
    const Float x = hn::IfThenElse(low, c, hn::Max(all(1.0F) - c, all(0.0F)));
    const Float raised = hn::Exp(d, all(power) * hn::Log(d, hn::Max(x, all(least))));
    const Float to_power = hn::IfThenElseZero(x > all(0.0F), raised);
    const Float l =
        all(a) / hn::MulAdd(all(b), to_power, all(1.0F)) + hn::MulAdd(all(slope), x, all(rest));
    return hn::Exp(d, hn::IfThenElse(low, l, all(m.charlie_middle) - l));
}

/// The albedo of the sheen, linear in the cube root of the cosine.
HWY_INLINE Float E_charlie(const Reflector& m, Float c)
{
    const Floats d;
    const Ints ints;
    const Float root = hn::Exp(d, hn::Log(d, hn::Max(c, all(least))) * all(1.0F / 3.0F));
    const Float place = root * all(float{charlie::albedo_columns - 1});
    const auto first = hn::Min(hn::Max(hn::ConvertTo(ints, place), hn::Zero(ints)),
                               hn::Set(ints, charlie::albedo_columns - 2));
    const Float y0 = hn::GatherIndex(d, m.sheen_table, first);
    const Float y1 = hn::GatherIndex(d, m.sheen_table + 1, first);
    return hn::Min(mix(y0, y1, place - hn::ConvertTo(d, first)), all(1.0F));
}

/// D V of the sheen. sin_m^(1/alpha), with ln sin^2 = ln(1 - cos^2) near the horizon of h.
HWY_INLINE Float DV_charlie(const Reflector& m, const At& a, Float Lambda_o)
{
    const Floats d;
    const Float h2 = hn::Max(a.h2, all(least));
    const Float cos2 = hn::Min(square(a.hz) / h2, all(1.0F));
    const Float sin2 = hn::Max(a.hxy2 / h2, all(least));
    const Float ln =
        hn::IfThenElse(cos2 < all(0.25F), hn::Log1p(d, hn::Neg(cos2)), hn::Log(d, sin2));
    const Float D = all(m.charlie_norm) * hn::Exp(d, all(m.charlie_exponent) * ln);
    const Float shadowed = all(1.0F) + Lambda_charlie(m, a.ci) + Lambda_o;
    return D * all(0.25F) / hn::Max(shadowed * a.ci * a.co, all(least));
}

}  // namespace
}  // namespace relight::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
