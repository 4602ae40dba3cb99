// f of every material model, in float, a vector of vertices at a time, for directions above the
// surface. For shine.cpp, which includes this after Highway, once for each instruction set.
#if defined(RELIGHT_SHADE_MODELS) == defined(HWY_TARGET_TOGGLE)
#ifdef RELIGHT_SHADE_MODELS
#undef RELIGHT_SHADE_MODELS
#else
#define RELIGHT_SHADE_MODELS
#endif

#include "core/shade/lobes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relight::kernel::HWY_NAMESPACE {
namespace {

using Model = Reflector::Model;

constexpr float coat_alpha2 = 0.25F * 0.25F;  // of the masking of Principled's coat

/// core/bsdf/cook_torrance.h; aside: root or Lambda of wo, and what is lost there.
template <Model model, bool anisotropic>
HWY_INLINE Bands cook_torrance(const Reflector& m, const Outgoing& o, const At& a)
{
    const Float h_stretched = stretched_h<anisotropic>(m.facets, a);
    Float DV;
    if constexpr (model == Model::Ggx) {
        const Float root = ggx_root<anisotropic>(m.facets, a.ci, a.x, a.y);
        DV = ggx(m.facets, a, h_stretched, root, o.aside[0], m.separable);
    } else if constexpr (model == Model::Beckmann) {
        const Float t2 = stretched_w<anisotropic>(m.facets, a.ci, a.x, a.y);
        DV = D_beckmann(m.facets, a, h_stretched) *
             V(a, Lambda_beckmann(a.ci, t2), o.aside[0], m.separable);
    } else {
        DV = D_gtr(m, a, h_stretched) * V(a, Lambda_gtr(m, a.ci), o.aside[0], m.separable);
    }
    const Bands reflected = F(m, a);
    const Float one = all(1.0F);
    const Bands passed{one - reflected.r, one - reflected.g, one - reflected.b};
    const Bands f = mul_add(reflected, DV, passed * (o.base * all(inv_pi)));
    if (m.lost_table == nullptr) { return f; }
    return mul_add(all(m.F_ms), lost(m, a.ci) * o.aside[1], f);
}

/// core/bsdf/principled.h; aside: roots of wo for the lobe and the coat, and S(cos_o).
template <bool anisotropic>
HWY_INLINE Bands principled(const Reflector& m, const Outgoing& o, const At& a)
{
    const Float one = all(1.0F);
    const Float FH = S(a.cos_d), FL = S(a.ci), FV = o.aside[2];
    Bands tint = grey(one);
    if (m.specular_tint > 0.0F || m.sheen_tint > 0.0F) {
        const Float bright = all(0.3F) * o.base.r + all(0.6F) * o.base.g + all(0.1F) * o.base.b;
        const auto is_black = bright <= all(0.0F);
        const Float inverse = one / hn::IfThenElse(is_black, one, bright);
        tint = {hn::IfThenElse(is_black, one, o.base.r * inverse),
                hn::IfThenElse(is_black, one, o.base.g * inverse),
                hn::IfThenElse(is_black, one, o.base.b * inverse)};
    }
    const Bands F0 =
        mix(mix(grey(one), tint, all(m.specular_tint)) * all(m.specular), o.base, all(m.metallic));
    const Float root_i = ggx_root<anisotropic>(m.facets, a.ci, a.x, a.y);
    const Float DV =
        ggx(m.facets, a, stretched_h<anisotropic>(m.facets, a), root_i, o.aside[0], true);
    const Bands specular = mix(F0, grey(one), FH) * DV;

    const Float retro = all(m.roughness) * all(0.25F) * a.h2;
    const Float F90 = hn::MulAdd(all(2.0F), retro, all(0.5F));
    Float shape = mix(one, F90, FL) * mix(one, F90, FV);
    if (m.subsurface > 0.0F) {
        const Float Fss = mix(one, retro, FL) * mix(one, retro, FV);
        const Float ss =
            all(1.25F) * hn::MulAdd(Fss, one / hn::Max(a.hz, all(least)) - all(0.5F), all(0.5F));
        shape = mix(shape, ss, all(m.subsurface));
    }
    const Float dielectric = all(1.0F - m.metallic);
    Bands f = mul_add(o.base, dielectric * shape * all(inv_pi), specular);
    if (m.sheen > 0.0F) {
        f = mul_add(mix(grey(one), tint, all(m.sheen_tint)), dielectric * FH * all(m.sheen), f);
    }
    if (m.clearcoat > 0.0F) {
        const Float u = gtr_u(a, all(m.coat.inv_ax2) * a.hxy2);
        const Float area = (a.ci + ggx_root(all(coat_alpha2), a.ci)) * (a.co + o.aside[1]);
        f = f + grey(all(m.clearcoat * m.coat.peak) * schlick(0.04F, FH) /
                     hn::Max(u * area, all(least)));
    }
    return f;
}

/// core/bsdf/metallic_roughness.h; aside: roots of wo for the lobe and the coat, Lambda and E of
/// wo for the sheen.
template <bool anisotropic>
HWY_INLINE Bands metallic_roughness(const Reflector& m, const Outgoing& o, const At& a)
{
    const Float one = all(1.0F);
    Float uncovered = one;
    Bands f = grey(all(0.0F));
    if (m.clearcoat > 0.0F) {
        const Float coat = all(m.clearcoat) * schlick(0.04F, S(a.co));
        const Float root_i = ggx_root(all(m.coat.ax2), a.ci);
        f = grey(coat * ggx(m.coat, a, all(m.coat.inv_ax2) * a.hxy2, root_i, o.aside[1], false));
        uncovered = one - coat;
    }
    if (m.sheen_table != nullptr) {
        f = mul_add(all(m.sheen_color), uncovered * DV_charlie(m, a, o.aside[2]), f);
        const Float E = hn::Max(E_charlie(m, a.ci), o.aside[3]);
        uncovered = uncovered * hn::NegMulAdd(all(m.strongest_sheen), E, one);
    }
    const Float root_i = ggx_root<anisotropic>(m.facets, a.ci, a.x, a.y);
    const Float DV =
        ggx(m.facets, a, stretched_h<anisotropic>(m.facets, a), root_i, o.aside[0], false);
    const Float s = S(a.cos_d);
    const Bands F_d{schlick(m.F0[0], s, m.specular), schlick(m.F0[1], s, m.specular),
                    schlick(m.F0[2], s, m.specular)};
    const Bands F_m = mix(o.base, grey(one), s);
    f = mul_add(mix(F_d, F_m, all(m.metallic)), uncovered * DV, f);
    const Float passed = one - schlick(m.F0_strongest, s, m.specular);
    const Float kept = all(1.0F - m.metallic) * hn::Max(passed, all(0.0F));
    return mul_add(o.base, uncovered * kept * all(inv_pi), f);
}

/// core/bsdf/oren_nayar.h
HWY_INLINE Bands oren_nayar(const Reflector& m, const Outgoing& o, const At& a)
{
    const Float along = hn::Max(a.along, all(0.0F));
    const Float lean = along / hn::Max(hn::Max(a.ci, a.co), all(least));
    return o.base * (hn::MulAdd(all(m.B), lean, all(m.A)) * all(inv_pi));
}

template <Model model, bool anisotropic>
HWY_INLINE Bands f_of(const Reflector& m, const Outgoing& o, const At& a)
{
    if constexpr (model == Model::Lambert) {
        return o.base * all(inv_pi);
    } else if constexpr (model == Model::OrenNayar) {
        return oren_nayar(m, o, a);
    } else if constexpr (model == Model::Principled) {
        return principled<anisotropic>(m, o, a);
    } else if constexpr (model == Model::MetallicRoughness) {
        return metallic_roughness<anisotropic>(m, o, a);
    } else {
        return cook_torrance<model, anisotropic>(m, o, a);
    }
}

/// What stays the same from light to light.
template <Model model, bool anisotropic>
HWY_INLINE void keep_aside(const Reflector& m, Outgoing& o)
{
    if constexpr (model == Model::Lambert || model == Model::OrenNayar) { return; }
    if constexpr (model == Model::Beckmann || model == Model::Gtr) {
        const Float t2 = stretched_w<anisotropic>(m.facets, o.co, o.x, o.y);
        o.aside[0] = model == Model::Gtr ? Lambda_gtr(m, o.co) : Lambda_beckmann(o.co, t2);
    } else {
        o.aside[0] = ggx_root<anisotropic>(m.facets, o.co, o.x, o.y);
    }
    if (m.lost_table != nullptr) { o.aside[1] = lost(m, o.co); }
    if constexpr (model == Model::Principled) {
        o.aside[1] = ggx_root(all(coat_alpha2), o.co);
        o.aside[2] = S(o.co);
    }
    if constexpr (model == Model::MetallicRoughness) {
        o.aside[1] = ggx_root(all(m.coat.ax2), o.co);
        if (m.sheen_table == nullptr) { return; }
        o.aside[2] = Lambda_charlie(m, o.co);
        o.aside[3] = E_charlie(m, o.co);
    }
}

}  // namespace
}  // namespace relight::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
