#include "core/transport/draws.h"

#include <algorithm>
#include <cmath>

// CMakeLists.txt has this file optimised for vectors: sums and products are not fused (they would
// round otherwise where a processor can), so that every processor has the same bits.

namespace relight {
namespace {

/// A receiver that a kernel draws for.
template <class View>
struct Job {
    View view;
    Sequence sequence;
    std::uint32_t pair;
    Vec3 n, ng;
    Vec3 above;  ///< from the receiver to where rays start on the side of ng; others opposite
    Vec3 below;
    bool two_sided;
    double reach;      ///< as far as anything may cast a shadow
    double clearance;  ///< before the light

    Job(const View& v, const Receiver& receiver, const Bvh& bvh, const TransportOptions& options,
        const Sequence& s, std::uint32_t p)
        : view(v),
          sequence(s),
          pair(p),
          n(receiver.frame.n),
          ng(receiver.ng),
          above(receiver.lifted + ng * receiver.clear.offset - receiver.p),
          below(receiver.lifted - ng * receiver.clear.offset - receiver.p),
          two_sided(options.two_sided),
          reach(options.max_distance.value_or(std::numeric_limits<double>::infinity())),
          clearance(bvh.clearance(0.0).offset)
    {
    }
};

/// The lanes one by one, in a form that compilers turn into vectors: no branch and no call.
template <class View>
[[gnu::always_inline]] inline void draw_lanes(const Job<View>& wanted, const Lanes& lanes,
                                              Drawn& drawn)
{
    const Job<View> job = wanted;  // a copy: what is written cannot be part of it
    const unsigned count = lanes.count;
    for (unsigned i = 0; i < count; ++i) {
        const Sample2 s = job.sequence.replicate(lanes.replicate[i]).at(lanes.point[i], job.pair);
        const LightSample there = job.view.sample_direction(s);
        const double cos_n = dot(job.n, there.wi);
        const double cos_i = job.two_sided ? std::abs(cos_n) : std::max(0.0, cos_n);
        drawn.E[i] = cos_i > 0.0 ? there.L.r * cos_i / there.pdf : 0.0;
        const bool is_above = dot(job.ng, there.wi) >= 0.0;
        drawn.side[i] = is_above ? 1.0 : -1.0;
        if constexpr (std::is_same_v<View, SunView> || std::is_same_v<View, CosineView>) {
            drawn.x[i] = there.wi.x();
            drawn.y[i] = there.wi.y();
            drawn.z[i] = there.wi.z();
            drawn.distance[i] = job.reach;
        } else {
            const Vec3 start{is_above ? job.above.x : job.below.x,
                             is_above ? job.above.y : job.below.y,
                             is_above ? job.above.z : job.below.z};
            const Vec3 to_light = Vec3(there.wi) * there.distance - start;
            const double squared = dot(to_light, to_light);
            // Beyond, it overflows, and where the ray starts makes no difference.
            const bool is_far = !(squared < 1e200);
            // A light closer than the step itself is not behind anything.
            const bool is_beside = !(squared > 1e-200 && dot(to_light, there.wi) > 0.0);
            const double far = is_far ? there.distance : std::sqrt(squared);
            const double over = 1.0 / far;
            const bool as_drawn = is_far || is_beside;
            drawn.x[i] = as_drawn ? there.wi.x() : to_light.x * over;
            drawn.y[i] = as_drawn ? there.wi.y() : to_light.y * over;
            drawn.z[i] = as_drawn ? there.wi.z() : to_light.z * over;
            drawn.distance[i] =
                is_beside ? 0.0 : std::max(0.0, std::min(job.reach, far - job.clearance));
        }
    }
}

template <class View>
[[gnu::flatten]] void draw_plain(const Job<View>& job, const Lanes& lanes, Drawn& drawn)
{
    draw_lanes(job, lanes, drawn);
}

#ifdef __x86_64__
template <class View>
[[gnu::flatten, gnu::target("avx2")]] void draw_avx2(const Job<View>& job, const Lanes& lanes,
                                                     Drawn& drawn)
{
    draw_lanes(job, lanes, drawn);
}
template <class View>
[[gnu::flatten, gnu::target("avx512f,avx512dq,avx512vl,avx512bw")]] void draw_avx512(
    const Job<View>& job, const Lanes& lanes, Drawn& drawn)
{
    draw_lanes(job, lanes, drawn);
}
#endif

/// A rectangle that looks small: its samples take branches.
struct SmallRect {
    RectView rect;

    LightSample sample_direction(Sample2 s) const { return rect.sample(s); }
};

template <class View>
using Kernel = void (*)(const Job<View>&, const Lanes&, Drawn&);

/// For the processor that this runs on.
template <class View>
Kernel<View> kernel()
{
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")) {
        return draw_avx512<View>;
    }
    if (__builtin_cpu_supports("avx2")) { return draw_avx2<View>; }
#endif
    return draw_plain<View>;
}

}  // namespace

std::vector<Lanes> lanes_of(unsigned replicates, unsigned begin, unsigned end)
{
    std::vector<Lanes> all;
    for (unsigned r = 0; r < replicates; ++r) {
        for (unsigned i = begin; i < end; ++i) {
            if (all.empty() || all.back().count == Lanes::most) { all.emplace_back(); }
            Lanes& lanes = all.back();
            lanes.replicate[lanes.count] = r;
            lanes.point[lanes.count++] = i;
        }
    }
    return all;
}

template <class View>
Drawn draw(const View& view, const Receiver& receiver, const Bvh& bvh,
           const TransportOptions& options, const Sequence& sequence, std::uint32_t pair,
           const Lanes& lanes)
{
    static const Kernel<View> fastest = kernel<View>();
    Drawn drawn;
    if (!view.is_seen()) {
        std::fill_n(drawn.E.begin(), lanes.count, 0.0);
        return drawn;
    }
    if constexpr (std::is_same_v<View, RectView>) {
        if (view.by_area()) {
            draw_plain(Job<SmallRect>({view}, receiver, bvh, options, sequence, pair), lanes,
                       drawn);
            return drawn;
        }
    }
    fastest(Job<View>(view, receiver, bvh, options, sequence, pair), lanes, drawn);
    return drawn;
}

template Drawn draw(const RectView&, const Receiver&, const Bvh&, const TransportOptions&,
                    const Sequence&, std::uint32_t, const Lanes&);
template Drawn draw(const DiskView&, const Receiver&, const Bvh&, const TransportOptions&,
                    const Sequence&, std::uint32_t, const Lanes&);
template Drawn draw(const SphereView&, const Receiver&, const Bvh&, const TransportOptions&,
                    const Sequence&, std::uint32_t, const Lanes&);
template Drawn draw(const SunView&, const Receiver&, const Bvh&, const TransportOptions&,
                    const Sequence&, std::uint32_t, const Lanes&);
template Drawn draw(const CosineView&, const Receiver&, const Bvh&, const TransportOptions&,
                    const Sequence&, std::uint32_t, const Lanes&);

}  // namespace relight
