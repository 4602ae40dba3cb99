#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/parallel.h"
#include "core/geometry/mesh.h"
#include "core/geometry/surface.h"
#include "core/trace/meeting.h"
#include "core/trace/unit_box.h"

namespace relight {

/// A ray as it was asked for, in scene units.
struct ExactRay {
    Point3 origin;
    Vec3 direction;
    double from{}, distance{};
};

/// What casts shadows, twice: in floats and in the unit box, as Embree takes it, and as filed, in
/// double. A surface's triangles; or, when it has none, its points as oriented discs.
struct Occluders {
    std::shared_ptr<const Mesh> mesh;
    std::shared_ptr<const Surface> surface;
    double point_radius_scale = 0.0;
    UnitBox box;
    std::vector<float> vertices;  ///< xyz, or xyzr of discs; one spare at the end for Embree
    std::vector<float> normals;   ///< xyz of discs; one spare
    std::vector<std::uint32_t> disc_point;  ///< point of each disc; empty: the same index

    Occluders() = default;
    Occluders(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const Surface> surface,
              double point_radius_scale, Progress& progress);

    bool is_cloud() const { return surface->triangles.empty(); }
    /// Triangles, or discs.
    std::size_t count() const
    {
        return is_cloud() ? vertices.size() / 4 : surface->triangles.size();
    }
    std::uint32_t point(std::uint32_t disc) const
    {
        return disc_point.empty() ? disc : disc_point[disc];
    }
    double disc_radius(std::size_t point) const
    {
        return point_radius_scale * static_cast<double>(surface->spacing[point]);
    }

    /// Where the line meets a triangle or disc, in double.
    std::optional<Meeting> meeting(Point3 origin, Vec3 direction, std::uint32_t primitive) const;

    /// Whether what floats met at `t` [box] is on the ray: in double, where they cannot tell.
    /// @param normal of the primitive, any length
    bool is_met(const ExactRay& asked, double t, Vec3 normal, std::uint32_t primitive) const
    {
        const double along = std::min(t - asked.from * box.scale, asked.distance * box.scale - t);
        return is_beside(along, asked.direction, normal, float_slack) ||
               is_met_in_double(asked, primitive);
    }

    /// Never where is_met() says no, and mostly where it says yes: by the ray's floats, whose
    /// rounding (1e-7 of the direction over less than 8, 4e-7 at the far end) makes a difference of
    /// less than three slacks.
    /// @param along how far from the nearer of its ends the ray meets the primitive [box]
    static bool is_plainly_met(double along, Vec3 direction, Vec3 normal)
    {
        return is_beside(along, direction, normal, 4.0 * float_slack);
    }

    std::uint64_t bytes() const;

    /// In units of the box: how far from a triangle's plane a ray must begin and end for floats to
    /// know on which side. Origin, corners and Embree's test err by up to 1.6e-7 (measured: large,
    /// small and sliver triangles, 1e-8 to 1 away). Nearer hits are told in double.
    static constexpr double float_slack = 1e-6;

  private:
    /// How many points have one; disc_point, if not all do.
    std::size_t find_discs(Progress& progress);
    /// How far from the primitive's plane the nearer end is, against rounding.
    static bool is_beside(double along, Vec3 direction, Vec3 normal, double slack)
    {
        const double beside = along * std::abs(dot(normal, direction));
        return beside > 0.0 && beside * beside > slack * slack * dot(normal, normal);
    }
    bool is_met_in_double(const ExactRay& asked, std::uint32_t primitive) const;
};

}  // namespace relight
