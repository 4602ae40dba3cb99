#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "core/trace/bvh.h"

namespace relight {

/// Rays field by field, as Embree's fastest call and vector code take them: as floats in the unit
/// box, and as they were asked for, in double, for hits that floats cannot tell.
struct alignas(64) RayFields {
    // A million vertices take 6 to 10 % less time than with 64 or 256, a hundred thousand as long.
    static constexpr std::size_t capacity = 1024;
    static constexpr std::size_t spare = 16;  // for vectors that are stored whole
    template <class T>
    using Field = std::array<T, capacity + spare>;

    Field<float> org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, tfar;
    Field<double> origin_x, origin_y, origin_z, direction_x, direction_y, direction_z, from,
        distance;
};

/// Shadow rays that come one by one and are traced together, which is where Embree is fastest. Each
/// is written as Embree takes it when it is put; the answers are those of Bvh::occluded. A hundred
/// kilobytes: one a block of work, not one a vertex. Owned by one thread.
class ShadowStream {
  public:
    static constexpr std::size_t capacity = RayFields::capacity;

    /// @param bvh outlives it
    explicit ShadowStream(const Bvh& bvh) : bvh_(&bvh) {}

    std::size_t size() const { return size_; }
    bool full() const { return size_ == capacity; }

    /// Not when full.
    void put(const ShadowRay& ray)
    {
        const BoxRay box = bvh_->box().ray(ray);
        RayFields& f = fields_;
        const std::size_t i = size_++;
        f.org_x[i] = box.org_x;
        f.org_y[i] = box.org_y;
        f.org_z[i] = box.org_z;
        f.tnear[i] = box.tnear;
        f.dir_x[i] = box.dir_x;
        f.dir_y[i] = box.dir_y;
        f.dir_z[i] = box.dir_z;
        f.tfar[i] = box.tfar;
        f.origin_x[i] = ray.origin.x;
        f.origin_y[i] = ray.origin.y;
        f.origin_z[i] = ray.origin.z;
        f.direction_x[i] = ray.direction.x();
        f.direction_y[i] = ray.direction.y();
        f.direction_z[i] = ray.direction.z();
        f.from[i] = ray.from;
        f.distance[i] = ray.distance;
    }

    /// In place of a ray: Embree skips it, and the answer is 1.
    void pass_over()
    {
        fields_.dir_x[size_] = fields_.dir_y[size_] = fields_.dir_z[size_] = 0.0F;
        fields_.tnear[size_] = 0.0F;
        fields_.tfar[size_++] = -std::numeric_limits<float>::infinity();
    }

    /// For vector code, which puts many at once: the fields, of which [0, size()) are taken, and
    /// how many there are then. pass_over() is a tfar of -infinity.
    RayFields& fields() { return fields_; }
    void resize(std::size_t size) { size_ = size; }

    /// Traces what was put since the last time. [i] = 1 where the i-th of them is blocked; valid
    /// until the next call of trace().
    std::span<const std::uint8_t> trace()
    {
        bvh_->trace(fields_, {blocked_.data(), size_});
        return {blocked_.data(), std::exchange(size_, 0)};
    }

  private:
    const Bvh* bvh_;
    std::size_t size_ = 0;
    RayFields fields_;  // [0, size_) are filled
    std::array<std::uint8_t, capacity> blocked_;
};

}  // namespace relight
