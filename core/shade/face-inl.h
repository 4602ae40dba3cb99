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
    Vector p, n;    ///< n on the seen side
    Double cos_o;   ///< 0: not seen
    Vector across;  ///< wo across the normal
    Vector x, y;    ///< the lobe's axes, on that side
    Double wo_x, wo_y;
};

HWY_INLINE Seen look(const View& view, Range at)
{
    const Doubles d;
    const Viewer& viewer = view.viewer;
    Seen s;
    s.p = read_rows(view.positions + 3 * at.v, at.left);
    s.n = read_rows(view.normals + 3 * at.v, at.left);
    if (viewer.place == Viewer::Place::AlongNormal) {
        s.cos_o = hn::IfThenElseZero(dot(s.n, s.n) > hn::Zero(d), all(1.0));
        s.across = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        return s;
    }
    Vector wo = all(viewer.at);
    if (viewer.place == Viewer::Place::Point) {
        wo = wo - s.p;
        wo = wo * inverse_root(dot(wo, wo));
    }
    const Double facing = dot(s.n, wo);
    s.across = minus(wo, s.n, facing);
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
    s.y = minus(y * c, x, sine);
    s.wo_x = dot(s.across, s.x);
    s.wo_y = dot(s.across, s.y);
}

/// What f is made of besides the cosines: nothing; wi.wo across the normal; the half vector; the
/// half vector, and directions along the lobe's axes.
enum class Made { OfCosines, OfAlong, OfHalf, OfAxes };

template <Model model, bool anisotropic>
constexpr Made made = model == Model::Lambert     ? Made::OfCosines
                      : model == Model::OrenNayar ? Made::OfAlong
                      : anisotropic               ? Made::OfAxes
                                                  : Made::OfHalf;

/// In double: an At that is not yet rounded.
struct Facing {
    Double ci, hxy2, along, x, y, h_x, h_y;
};

/// Of h = wi + wo the part across the normal is the sum of theirs, which loses nothing where they
/// nearly cancel. (h.h - h_z^2 would, where both directions graze.)
template <Made made>
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
    if (both_sides) {  // wo is the normal: a light behind is as good as its image before
        to_light = turned(to_light, hn::And(f.ci, hn::SignBit(Doubles())));
        f.ci = hn::Abs(f.ci);
    }
    if constexpr (made == Made::OfCosines) { return f; }
    if constexpr (made == Made::OfAlong) {
        f.along = dot(to_light, s.across) * inverse;
        return f;
    }
    const Vector across = minus(plus(s.across, to_light, inverse), s.n, f.ci);
    f.hxy2 = dot(across, across);
    if constexpr (made == Made::OfAxes) {
        f.x = dot(to_light, s.x) * inverse;
        f.y = dot(to_light, s.y) * inverse;
        f.h_x = f.x + s.wo_x;
        f.h_y = f.y + s.wo_y;
    }
    return f;
}

}  // namespace
}  // namespace relight::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
