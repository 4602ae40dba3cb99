#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/sobol.h"
#include "core/light/dome.h"
#include "core/light/light.h"
#include "core/trace/shadow_stream.h"
#include "core/transport/receiver.h"

namespace relight {

/// Points of one vertex's sequences that are drawn together.
struct Lanes {
    static constexpr unsigned most = 64;
    unsigned count = 0;
    std::array<std::uint32_t, most> replicate{}, point{};  ///< [0, count) are filled
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

/// The same directions of weight 1: what is seen along them is found after.
struct CosineDirections {
    CosineView cosine;

    static constexpr bool is_seen() { return true; }
    LightSample sample_direction(Sample2 s) const
    {
        return {cosine.sample_direction(s).wi, std::numeric_limits<double>::infinity(),
                Rgb::grey(1.0), 1.0};
    }
};
/// Those that a sky of a map draws, likewise; the pair after `pair` picks its parts. What is seen
/// along them is left in `lanes`.
struct DomeDirections {
    const Dome* dome;
    DomeLanes* lanes;

    static constexpr bool is_seen() { return true; }
};

/// Those toward shining faces, drawn from them or by the cosine, of weight 1 if they meet one, and
/// as far as it. What the face shows along them is left in `lanes`.
struct MeshDirections {
    const EmitterTable* faces;
    MeshLanes* lanes;

    static constexpr bool is_seen() { return true; }
};
struct MeshCosines {
    CosineView cosine;
    const EmitterTable* faces;
    MeshLanes* lanes;

    static constexpr bool is_seen() { return true; }
    LightSample sample_direction(Sample2 s) const
    {
        return CosineDirections{cosine}.sample_direction(s);
    }
};

/// One who asks for samples: how the light looks from there, and its random numbers.
template <class View>
struct Asker {
    View view;
    const Receiver* receiver;
    Sequence sequence;  ///< replicate 0
};

/// What each ray of a stream brings if nothing is in its way: of the light's radiance, over the
/// density. 0: there is nothing to ask for, and the ray is passed over.
using Brought = std::array<double, RayFields::capacity + RayFields::spare>;

/// As many askers' lanes as fit a stream.
inline std::size_t askers_a_stream(const Lanes& lanes)
{
    return ShadowStream::capacity / lanes.count;
}

/// Draws the light that each asker sees, the pair `pair` of the sequence's replicates, and puts
/// shadow rays as shadow_ray() would make them into the stream (which is empty): asker after asker,
/// each in the order of the lanes. In vectors as wide as the processor has; the same on any: every
/// lane is what the scalar functions of light/ and base/ give (but see RectDirections), and aimed
/// as shadow_ray() does. Test: Draws.*
/// @param askers no more than askers_a_stream()
template <class View>
void draw(std::span<const Asker<View>> askers, const Bvh& bvh, const TransportOptions& options,
          std::uint32_t pair, const Lanes& lanes, ShadowStream& stream, Brought& E);

}  // namespace relight
