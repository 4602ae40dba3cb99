// f of every material model, in float, a block of vertices at a time.
#include "core/bsdf/charlie.h"
#include "core/shade/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/shade/reflect.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
//
#include <hwy/contrib/math/math-inl.h>
//
#include "core/shade/lobes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relight::kernel::HWY_NAMESPACE {
namespace {

/// core/bsdf/cook_torrance.h; aside: root or Lambda of wo, and what is lost there.
template <Reflector::Model model, bool anisotropic>
void cook_torrance(Block& block, const Reflector& m)
{
    const std::size_t lanes = hn::Lanes(Floats());
    for (std::size_t i = 0; i < block.count; i += lanes) {
        const At a = at(block, i);
        const Float h_stretched = stretched_h<anisotropic>(m.facets, block, i, a.hxy2);
        const Float t2 = stretched_wi<anisotropic>(m.facets, block, i);
        const Float kept = load(block.aside[0] + i);
        Float DV;
        if constexpr (model == Reflector::Model::Ggx) {
            DV = ggx(m.facets, a, h_stretched, ggx_root(a.ci, t2), kept, m.separable);
        } else if constexpr (model == Reflector::Model::Beckmann) {
            DV = D_beckmann(m.facets, a, h_stretched) *
                 V(a, Lambda_beckmann(a.ci, t2), kept, m.separable);
        } else {
            DV = D_gtr(m, a, h_stretched) * V(a, Lambda_gtr(m, a.ci), kept, m.separable);
        }
        const Bands reflected = F(m, a);
        const Float one = all(1.0F);
        const Bands passed{one - reflected.r, one - reflected.g, one - reflected.b};
        Bands f = passed * base_at(block, i) * all(inv_pi) + reflected * DV;
        if (m.lost_table != nullptr) {
            f = f + all(m.F_ms) * (lost(m, a.ci) * load(block.aside[1] + i));
        }
        store(block, i, f);
    }
}

/// core/bsdf/principled.h; aside: roots of wo for the lobe and the coat, and S(cos_o).
template <bool anisotropic>
void principled(Block& block, const Reflector& m)
{
    const std::size_t lanes = hn::Lanes(Floats());
    const Float one = all(1.0F);
    constexpr float coat_alpha2 = 0.25F * 0.25F;  // of its masking
    for (std::size_t i = 0; i < block.count; i += lanes) {
        const At a = at(block, i);
        const Bands base = base_at(block, i);
        const Float FH = S(a.cos_d), FL = S(a.ci), FV = load(block.aside[2] + i);

        Bands tint = grey(one);
        if (m.specular_tint > 0.0F || m.sheen_tint > 0.0F) {
            const Float bright = all(0.3F) * base.r + all(0.6F) * base.g + all(0.1F) * base.b;
            const auto is_black = bright <= all(0.0F);
            const Float inverse = one / hn::IfThenElse(is_black, one, bright);
            tint = {hn::IfThenElse(is_black, one, base.r * inverse),
                    hn::IfThenElse(is_black, one, base.g * inverse),
                    hn::IfThenElse(is_black, one, base.b * inverse)};
        }
        const Bands F0 = mix(mix(grey(one), tint, all(m.specular_tint)) * all(m.specular), base,
                             all(m.metallic));
        const Float root_i = ggx_root(a.ci, stretched_wi<anisotropic>(m.facets, block, i));
        const Float DV = ggx(m.facets, a, stretched_h<anisotropic>(m.facets, block, i, a.hxy2),
                             root_i, load(block.aside[0] + i), true);
        Bands f = mix(F0, grey(one), FH) * DV;

        const Float retro = all(m.roughness) * all(0.25F) * a.h2;
        const Float F90 = hn::MulAdd(all(2.0F), retro, all(0.5F));
        Float shape = mix(one, F90, FL) * mix(one, F90, FV);
        if (m.subsurface > 0.0F) {
            const Float Fss = mix(one, retro, FL) * mix(one, retro, FV);
            const Float ss =
                all(1.25F) *
                hn::MulAdd(Fss, one / hn::Max(a.hz, all(least)) - all(0.5F), all(0.5F));
            shape = mix(shape, ss, all(m.subsurface));
        }
        const Float dielectric = all(1.0F - m.metallic);
        f = f + base * (dielectric * shape * all(inv_pi));
        if (m.sheen > 0.0F) {
            f = f + mix(grey(one), tint, all(m.sheen_tint)) * (dielectric * FH * all(m.sheen));
        }
        if (m.clearcoat > 0.0F) {
            const Float u = gtr_u(a, all(m.coat.inv_ax2) * a.hxy2);
            const Float root = ggx_root(a.ci, all(coat_alpha2) * sin2_of(a.ci));
            const Float area = (a.ci + root) * (a.co + load(block.aside[1] + i));
            f = f + grey(all(m.clearcoat * m.coat.peak) * schlick(0.04F, FH) /
                         hn::Max(u * area, all(least)));
        }
        store(block, i, f);
    }
}

/// core/bsdf/metallic_roughness.h; aside: roots of wo for the lobe and the coat, Lambda and E of
/// wo for the sheen.
template <bool anisotropic>
void metallic_roughness(Block& block, const Reflector& m)
{
    const std::size_t lanes = hn::Lanes(Floats());
    const Float one = all(1.0F);
    for (std::size_t i = 0; i < block.count; i += lanes) {
        const At a = at(block, i);
        const Bands base = base_at(block, i);
        Float uncovered = one;
        Bands f = grey(all(0.0F));
        if (m.clearcoat > 0.0F) {
            const Float coat = all(m.clearcoat) * schlick(0.04F, S(a.co));
            const Float root_i = ggx_root(a.ci, all(m.coat.ax2) * sin2_of(a.ci));
            f = grey(coat * ggx(m.coat, a, all(m.coat.inv_ax2) * a.hxy2, root_i,
                                load(block.aside[1] + i), false));
            uncovered = one - coat;
        }
        if (m.sheen_table != nullptr) {
            f = f + all(m.sheen_color) * (uncovered * DV_charlie(m, a, load(block.aside[2] + i)));
            const Float E = hn::Max(E_charlie(m, a.ci), load(block.aside[3] + i));
            uncovered = uncovered * hn::NegMulAdd(all(m.strongest_sheen), E, one);
        }
        const Float root_i = ggx_root(a.ci, stretched_wi<anisotropic>(m.facets, block, i));
        const Float DV = ggx(m.facets, a, stretched_h<anisotropic>(m.facets, block, i, a.hxy2),
                             root_i, load(block.aside[0] + i), false);
        const Float s = S(a.cos_d);
        const Bands F_d{schlick(m.F0[0], s, m.specular), schlick(m.F0[1], s, m.specular),
                        schlick(m.F0[2], s, m.specular)};
        const Bands F_m = mix(base, grey(one), s);
        f = f + mix(F_d, F_m, all(m.metallic)) * (uncovered * DV);
        const Float passed = one - schlick(m.F0_strongest, s, m.specular);
        const Float kept = all(1.0F - m.metallic) * hn::Max(passed, all(0.0F));
        store(block, i, f + base * (uncovered * kept * all(inv_pi)));
    }
}

void lambert(Block& block)
{
    const std::size_t lanes = hn::Lanes(Floats());
    for (std::size_t i = 0; i < block.count; i += lanes) {
        store(block, i, base_at(block, i) * all(inv_pi));
    }
}

/// core/bsdf/oren_nayar.h
void oren_nayar(Block& block, const Reflector& m)
{
    const std::size_t lanes = hn::Lanes(Floats());
    for (std::size_t i = 0; i < block.count; i += lanes) {
        const Float along = hn::Max(load(block.along + i), all(0.0F));
        const Float greater = hn::Max(load(block.ci + i), load(block.co + i));
        const Float lean = along / hn::Max(greater, all(least));
        const Float shape = hn::MulAdd(all(m.B), lean, all(m.A));
        store(block, i, base_at(block, i) * (shape * all(inv_pi)));
    }
}

/// What stays the same from light to light.
template <bool anisotropic>
void keep_aside(Block& block, const Reflector& m)
{
    using Model = Reflector::Model;
    const Floats d;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t i = 0; i < block.count; i += lanes) {
        const Float co = load(block.co + i);
        const Float t2 = stretched_wo<anisotropic>(m.facets, block, i);
        const bool has_lambda = m.model == Model::Beckmann || m.model == Model::Gtr;
        const Float first = has_lambda ? Lambda(m, co, t2) : ggx_root(co, t2);
        hn::Store(first, d, block.aside[0] + i);
        if (m.lost_table != nullptr) { hn::Store(lost(m, co), d, block.aside[1] + i); }
        if (m.model == Model::Principled) {
            hn::Store(ggx_root(co, all(0.25F * 0.25F) * sin2_of(co)), d, block.aside[1] + i);
            hn::Store(S(co), d, block.aside[2] + i);
        }
        if (m.model == Model::MetallicRoughness) {
            hn::Store(ggx_root(co, all(m.coat.ax2) * sin2_of(co)), d, block.aside[1] + i);
        }
        if (m.sheen_table != nullptr) {
            hn::Store(Lambda_charlie(m, co), d, block.aside[2] + i);
            hn::Store(E_charlie(m, co), d, block.aside[3] + i);
        }
    }
}

void prepare_any(Block& block, const Reflector& m)
{
    m.anisotropic ? keep_aside<true>(block, m) : keep_aside<false>(block, m);
}

void reflect_any(Block& block, const Reflector& m)
{
    using Model = Reflector::Model;
    switch (m.model) {
        case Model::Lambert:
            return lambert(block);
        case Model::OrenNayar:
            return oren_nayar(block, m);
        case Model::Beckmann:
            return m.anisotropic ? cook_torrance<Model::Beckmann, true>(block, m)
                                 : cook_torrance<Model::Beckmann, false>(block, m);
        case Model::Ggx:
            return m.anisotropic ? cook_torrance<Model::Ggx, true>(block, m)
                                 : cook_torrance<Model::Ggx, false>(block, m);
        case Model::Gtr:
            return cook_torrance<Model::Gtr, false>(block, m);
        case Model::Principled:
            return m.anisotropic ? principled<true>(block, m) : principled<false>(block, m);
        case Model::MetallicRoughness:
            return m.anisotropic ? metallic_roughness<true>(block, m)
                                 : metallic_roughness<false>(block, m);
    }
}

}  // namespace
}  // namespace relight::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relight::kernel {

HWY_EXPORT(prepare_any);
HWY_EXPORT(reflect_any);

void prepare(Block& block, const Reflector& reflector)
{
    round_wo(block, reflector.anisotropic);
    const bool diffuse = reflector.model == Reflector::Model::Lambert ||
                         reflector.model == Reflector::Model::OrenNayar;
    if (!diffuse) { HWY_DYNAMIC_DISPATCH(prepare_any)(block, reflector); }
}

void reflect(Block& block, const Reflector& reflector, const Source& source, bool both_sides)
{
    const bool leans = reflector.model == Reflector::Model::OrenNayar;
    face(block, source, both_sides,
         leans ? Across::Along : (reflector.anisotropic ? Across::Axes : Across::Half));
    HWY_DYNAMIC_DISPATCH(reflect_any)(block, reflector);
}

}  // namespace relight::kernel
#endif
