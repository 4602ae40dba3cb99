// Where vertices are seen from and lit from: everything that is formed in double. For shine.cpp,
// which includes this after Highway, once for each instruction set.
#if defined(RELIGHT_SHADE_FACE) == defined(HWY_TARGET_TOGGLE)
#ifdef RELIGHT_SHADE_FACE
#undef RELIGHT_SHADE_FACE
#else
#define RELIGHT_SHADE_FACE
#endif

#include "core/shade/kernels.h"
#include "core/shade/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relight::kernel::HWY_NAMESPACE {
namespace {

using Model = Reflector::Model;

/// The vertices from v on, `left` of them, which are those of the block from i on.
struct Range {
    std::size_t i, v, left;
};

/// Vertices as their viewer sees them: half a vector of floats.
struct Seen {
    Vector p, n;  ///< n on the seen side
    Vector wo;
    Double cos_o;  ///< 0: not seen
    Vector x, y;   ///< the lobe's axes, on that side
    Vector L;
};

HWY_INLINE Seen look(const View& view, Range at)
{
    const Doubles d;
    const Viewer& viewer = view.viewer;
    Seen s;
    s.p = read_rows(view.positions + 3 * at.v, at.left);
    s.n = read_rows(view.normals + 3 * at.v, at.left);
    if (viewer.place == Viewer::Place::AlongNormal) {
        s.wo = s.n;
        s.cos_o = hn::IfThenElseZero(dot(s.n, s.n) > hn::Zero(d), all(1.0));
        return s;
    }
    s.wo = all(viewer.at);
    if (viewer.place == Viewer::Place::Point) {
        s.wo = s.wo - s.p;
        s.wo = s.wo * inverse_root(dot(s.wo, s.wo));
    }
    const Double facing = dot(s.n, s.wo);
    s.cos_o = hn::Max(facing, hn::Zero(d));
    if (viewer.two_sided) {
        s.n = turned(s.n, hn::And(facing, hn::SignBit(d)));
        s.cos_o = hn::Abs(facing);
    }
    return s;
}

/// The lobe's axes: the tangent frame on the seen side, turned about its normal.
HWY_INLINE void add_axes(Seen& s, const Block& block, const Task& task, Range at)
{
    const Vector x = load(block.x, at.i);
    Vector y = load(block.y, at.i);
    if (task.view->viewer.two_sided) {
        const Double side = dot(s.n, read_rows(task.view->normals + 3 * at.v, at.left));
        y = turned(y, hn::And(side, hn::SignBit(Doubles())));
    }
    const Double c = all(task.reflector->turn_cos), sine = all(task.reflector->turn_sin);
    s.x = plus(x * c, y, sine);
    s.y = plus(y * c, x, hn::Neg(sine));
}

/// What f depends on, in double: an At that is not yet rounded.
struct Facing {
    Double ci, h2, hxy2, along, x, y, h_x, h_y;
};

/// h = wi + wo loses nothing where they nearly cancel, and is formed before it is divided into its
/// share along the normal and that across.
template <Model model, bool anisotropic>
HWY_INLINE Facing face(const Seen& s, const Source& source, bool both_sides)
{
    Facing f;
    Vector to_light = all(source.at);
    Double inverse = all(1.0);
    if (!source.is_direction) {
        to_light = to_light - s.p;
        inverse = inverse_root(dot(to_light, to_light));
    }
    f.ci = dot(s.n, to_light) * inverse;
    Vector wo = s.wo;
    if (both_sides) {  // wo is the normal: on the side of the light
        wo = turned(wo, hn::And(f.ci, hn::SignBit(Doubles())));
        f.ci = hn::Abs(f.ci);
    }
    if constexpr (model == Model::Lambert) { return f; }
    if constexpr (model == Model::OrenNayar) {
        f.along = hn::NegMulAdd(f.ci, s.cos_o, dot(to_light, wo) * inverse);
        return f;
    }
    const Vector h = plus(wo, to_light, inverse);
    const Double hz = f.ci + s.cos_o;
    // Not from h.h - hz^2, which cancels where both directions graze: an error of hz leaves h's
    // part across the normal as long as it is.
    const Vector across = plus(h, both_sides ? wo : s.n, hn::Neg(hz));
    f.hxy2 = dot(across, across);
    f.h2 = hn::MulAdd(hz, hz, f.hxy2);
    if constexpr (anisotropic) {
        f.x = dot(to_light, s.x) * inverse;
        f.y = dot(to_light, s.y) * inverse;
        f.h_x = dot(h, s.x);
        f.h_y = dot(h, s.y);
    }
    return f;
}

}  // namespace
}  // namespace relight::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
