#pragma once

#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/sobol.h"
#include "core/transport/budget.h"
#include "core/transport/receiver.h"

namespace relight {

/// The vertex's part of its random numbers' key: where it is and which way it faces, so that
/// neither the order of the vertices nor a duplicate changes an answer.
std::uint64_t key_of(const Receiver& receiver);

/// One light as the transport sees it: whose column is being made.
struct Source {
    const Stage& stage;
    const Scene& scene;
    const Light& light;
    std::uint64_t number = 0;  ///< part of the random numbers' key

    bool shadowed() const { return scene.transport.shadows && light.cast_shadows; }
    Sequence sequence(const Receiver& receiver, unsigned replicate) const
    {
        return {scene.transport.seed, key_of(receiver), number, replicate};
    }
};

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

/// A share of a vertex's answer that counts if its ray gets through.
struct Deposit {
    Rgb* lit;      ///< where it is added
    Tally* tally;  ///< counts the ray and its weight as one toward the light; may be null
    Rgb value;
};

/// Rays waiting to be traced together, each with what it brings. Order of arrival is kept: sums do
/// not depend on where a flush falls.
class RayQueue {
  public:
    explicit RayQueue(const Bvh& bvh) : bvh_(bvh) {}

    void ask(const ShadowRay& ray, const Deposit& deposit)
    {
        rays_.push_back(ray);
        deposits_.push_back(deposit);
    }
    /// Deposits without a ray: nothing can be in the way.
    static void give(const Deposit& deposit);
    bool full() const { return rays_.size() >= enough; }
    void flush();
    void count(std::uint64_t rays) { traced_ += rays; }  ///< traced elsewhere
    std::uint64_t traced() const { return traced_; }

  private:
    static constexpr std::size_t enough = 8192;
    const Bvh& bvh_;
    std::vector<ShadowRay> rays_;
    std::vector<Deposit> deposits_;
    std::vector<std::uint8_t> blocked_;
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

  private:
    bool two_sided_;
    const Material* material_ = nullptr;  // null: E
    Vec3 wo_;
    Rgb color_;
};

/// Points [begin, end) of one replicate's direct light (of a light that is no delta) at a receiver:
/// even ones drawn from the light, odd ones from the response, joined by the balance heuristic
/// (Veach & Guibas 1995); where `closed` the light alone is drawn, an even sky by the response
/// alone.
void gather_direct(const Source& source, const Receiver& receiver, const Response& response,
                   const Sequence& sequence, unsigned begin, unsigned end, bool closed, Rgb& lit,
                   Rgb* all, Tally* tally, RayQueue& queue);

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
