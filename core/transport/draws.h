#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/sobol.h"
#include "core/light/light.h"
#include "core/transport/receiver.h"

namespace relight {

/// Points of one vertex's sequences that are drawn together.
struct Lanes {
    static constexpr unsigned most = 64;
    unsigned count = 0;
    std::array<std::uint32_t, most> replicate, point;  ///< [0, count) are filled
};
/// Points [begin, end) of each of `replicates` replicates, one replicate after the other.
std::vector<Lanes> lanes_of(unsigned replicates, unsigned begin, unsigned end);

/// A hemisphere, drawn by its cosine: how a sky of about the same radiance everywhere is best
/// found.
class CosineView {
  public:
    /// @param two_sided both hemispheres, half and half
    CosineView(const Frame& frame, bool two_sided) : frame_(frame), sides_(two_sided ? 2.0 : 1.0) {}

    static constexpr bool is_seen() { return true; }
    LightSample sample_direction(Sample2 s) const
    {
        // s.u chooses the side and is then spread over it.
        const double at = s.u * sides_, below = at >= 1.0 ? 1.0 : 0.0;
        const Vec3 up = warp::cosine_hemisphere({at - below, s.v});
        const Vec3 local{up.x, up.y, up.z * (1.0 - 2.0 * below)};
        return {unit_already(frame_.to_world(local)), std::numeric_limits<double>::infinity(),
                Rgb::grey(1.0), warp::cosine_hemisphere_pdf(up.z) / sides_};
    }

  private:
    Frame frame_;
    double sides_;
};

/// What lanes have drawn: shadow rays as shadow_ray() would make them, and what each brings if
/// nothing is in its way.
struct Drawn {
    template <class T>
    using Lane = std::array<T, Lanes::most>;

    alignas(64) Lane<double> x, y, z;   ///< direction of the ray, unit
    alignas(64) Lane<double> distance;  ///< as far as it goes
    alignas(
        64) Lane<double> E;  ///< of the light's radiance, over the density; 0: nothing to ask for
    alignas(64) Lane<double> side;  ///< of the surface on which it starts: 1 or -1

    Dir3 direction(unsigned lane) const { return unit_already({x[lane], y[lane], z[lane]}); }
    ShadowRay ray(const Receiver& receiver, unsigned lane) const
    {
        const double step = side[lane] * receiver.clear.offset;
        return {receiver.lifted + Vec3(receiver.ng) * step, direction(lane), receiver.clear.from,
                distance[lane]};
    }
};

/// Draws a light (of one colour) that `view` sees from a receiver, the pair `pair` of the
/// sequence's replicates. In vectors as wide as the processor has; the same to the bit on any,
/// since every lane is what the scalar functions of light/ and base/ give, and aimed as
/// shadow_ray() does. Test: Draws.*
template <class View>
Drawn draw(const View& view, const Receiver& receiver, const Bvh& bvh,
           const TransportOptions& options, const Sequence& sequence, std::uint32_t pair,
           const Lanes& lanes);

extern template Drawn draw(const RectView&, const Receiver&, const Bvh&, const TransportOptions&,
                           const Sequence&, std::uint32_t, const Lanes&);
extern template Drawn draw(const DiskView&, const Receiver&, const Bvh&, const TransportOptions&,
                           const Sequence&, std::uint32_t, const Lanes&);
extern template Drawn draw(const SphereView&, const Receiver&, const Bvh&, const TransportOptions&,
                           const Sequence&, std::uint32_t, const Lanes&);
extern template Drawn draw(const SunView&, const Receiver&, const Bvh&, const TransportOptions&,
                           const Sequence&, std::uint32_t, const Lanes&);
extern template Drawn draw(const CosineView&, const Receiver&, const Bvh&, const TransportOptions&,
                           const Sequence&, std::uint32_t, const Lanes&);

}  // namespace relight
