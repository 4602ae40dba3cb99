#pragma once

#include <array>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "core/base/progress.h"
#include "core/base/sobol.h"
#include "core/trace/shadow_stream.h"
#include "core/transport/budget.h"
#include "core/transport/draws.h"
#include "core/transport/receiver.h"
#include "core/transport/source.h"

namespace relight {

/// Nothing in any band.
constexpr bool is_black(Rgb c)
{
    return !(c.r > 0.0 || c.g > 0.0 || c.b > 0.0);
}

/// A value over the density that it was drawn with; black where there is no such density.
constexpr Rgb ratio(Rgb value, double pdf)
{
    return pdf > 0.0 && is_finite(pdf) ? value / pdf : Rgb{};
}

/// What comes of the light's direct samples beside their sums: how much of what they ask for is
/// seen.
struct Unblocked {
    double open = 0.0, total = 0.0;  ///< luminance of what arrives, and of what would unblocked
};

/// A share of a vertex's answer that counts if its ray gets through.
struct Deposit {
    Rgb* lit;  ///< where it is added
    Rgb value;
    double* open = nullptr;  ///< where its luminance is added too, if not null

    void give() const
    {
        *lit += value;
        if (open != nullptr) { *open += luminance(value); }
    }
};

/// Rays waiting to be traced together, each with what it brings. Order of arrival is kept: sums do
/// not depend on where a flush falls. Deposits outlive the flush.
class RayQueue {
  public:
    explicit RayQueue(const Bvh& bvh) : stream_(bvh) {}

    void ask(const ShadowRay& ray, const Deposit& deposit)
    {
        deposits_[stream_.size()] = deposit;
        stream_.put(ray);
        if (stream_.full()) { flush(); }
    }
    void flush()
    {
        const std::span<const std::uint8_t> blocked = stream_.trace();
        traced_ += blocked.size();
        for (std::size_t r = 0; r < blocked.size(); ++r) {
            if (blocked[r] == 0) { deposits_[r].give(); }
        }
    }
    void count(std::uint64_t rays) { traced_ += rays; }  ///< traced elsewhere
    std::uint64_t traced() const { return traced_; }

  private:
    ShadowStream stream_;
    std::array<Deposit, ShadowStream::capacity> deposits_;
    std::uint64_t traced_ = 0;
};

/// What a place makes of light from wi: E's cosine, or f cos toward a viewer. Directions are in
/// its frame; on a two-sided receiver light from below counts as from above.
class Response {
  public:
    /// The cosine: E.
    explicit Response(bool two_sided) : two_sided_(two_sided) {}
    /// f cos: radiance toward wo (wo.z > 0).
    Response(bool two_sided, const Material& material, Vec3 wo, Rgb color)
        : two_sided_(two_sided), material_(&material), wo_(wo), color_(color)
    {
    }

    Rgb value(Vec3 wi) const;
    double pdf(Vec3 wi) const;  ///< of sample(), 1/sr
    Vec3 sample(Sample2 s, Sample2 pick) const;
    bool picks() const { return two_sided_ || material_ != nullptr; }  ///< sample() looks at `pick`

  private:
    bool two_sided_;
    const Material* material_ = nullptr;  // null: E
    Vec3 wo_;
    Rgb color_;
};

/// Points [begin, end) of one replicate's direct light (of a light that is no delta) at a receiver
/// that sees it as `view`: even ones drawn from the light, odd ones from the response, joined by
/// the balance heuristic (Veach & Guibas 1995); an even sky by the response alone.
/// @param seen null: not asked for
void gather_direct(const Source& source, const Receiver& receiver, const LightView& view,
                   const Response& response, const Sequence& sequence, unsigned begin, unsigned end,
                   Rgb& lit, Unblocked* seen, RayQueue& queue);

/// A vertex whose direct E of a light of one colour is drawn, and its sums: a number a replicate,
/// of what arrives, and of what would with nothing in the way.
struct GreyVertex {
    const Receiver* receiver;
    std::span<double> lit, all;
    unsigned* rays;  ///< counts those that it asks for
};
/// The same points of all replicates at once for many vertices: of a light of one colour by itself,
/// or of an even sky by the cosine.
/// @return rays traced
std::uint64_t gather_irradiance(const Source& source, std::span<const GreyVertex> vertices,
                                std::span<const Lanes> lanes, ShadowStream& stream);

/// Such a light is drawn by itself alone: a face that is found by looking about is the light only
/// where a ray meets it first, whatever is between.
bool is_found_by_light_alone(const Source& source);

/// A vertex whose direct E of a light of many colours is drawn: a sky of a map, or shining faces.
struct ColoredVertex {
    const Receiver* receiver;
    std::span<Rgb> lit;  ///< a sum a replicate
    Unblocked* seen;
};
/// Points [begin, end) (even numbers) of all replicates at once for many vertices, drawn and joined
/// as gather_direct() does: half from the sky, half by the cosine; of an even sky all by the
/// cosine.
/// @return rays traced
std::uint64_t gather_dome(const Source& source, const Dome& dome,
                          std::span<const ColoredVertex> vertices, unsigned replicates,
                          unsigned begin, unsigned end, ShadowStream& stream);
/// The same of shining faces.
std::uint64_t gather_faces(const Source& source, const EmitterTable& faces,
                           std::span<const ColoredVertex> vertices, unsigned replicates,
                           unsigned begin, unsigned end, ShadowStream& stream);
/// A light that gather_dome() draws; nothing of others.
std::optional<Dome> dome_of(const LightShape& shape);

/// A path that goes on from a place: what it carries, and where it is counted.
struct Path {
    Receiver at;
    Dir3 wi;       ///< the way it goes on
    Rgb weight;    ///< response / pdf so far
    Rgb* bounced;  ///< where its light is added
    Sequence sequence;
    unsigned point = 0;
};

/// Sends a path off from a receiver with the `point`-th point of a sequence.
void start_path(const Receiver& receiver, const Response& response, const Sequence& sequence,
                unsigned point, Rgb& bounced, std::vector<Path>& paths);

/// Follows paths for up to `bounces` surfaces. At each they pick up the light's direct E once and
/// send rho E / pi on, by cosine. Diffuse, flat faces, both sides.
void follow(const Source& source, std::vector<Path> paths, unsigned bounces, RayQueue& queue);

}  // namespace relight
