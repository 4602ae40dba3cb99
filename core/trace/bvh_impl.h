#pragma once

#include <memory>
#include <optional>
#include <span>

#include "core/trace/bvh.h"
#include "core/trace/extent.h"
#include "core/trace/occluders.h"
#include "core/trace/tree.h"

struct RTCRay;  // Embree's: named, for no header of this room includes Embree

namespace relight {

/// What a Bvh holds, for those who ask it: bvh.cpp whether anything is met, nearest.cpp what first.
struct Bvh::Impl {
    Impl(std::shared_ptr<const Occluders> o, TreeQuality q, RayPattern p)
        : shared(std::move(o)), quality(q), pattern(p)
    {
    }

    /// What lies first on each of at most `most` rays.
    template <std::size_t most>
    void nearest(std::span<const ShadowRay> rays, std::span<Hit> hits) const;

    std::shared_ptr<const Occluders> shared;
    const Occluders& occluders = *shared;
    TreeQuality quality;
    RayPattern pattern;
    Tree tree;
    Extent extent;  ///< of all that casts shadows, around the box's centre
};

/// The ray begun beside the model, where floats are finest. None: it passes the model by.
std::optional<ShadowRay> brought_near(const ShadowRay& ray, const UnitBox& box);

/// As Embree takes one; `id` is what filters are told.
RTCRay embree_ray(const BoxRay& ray, unsigned id);

}  // namespace relight
