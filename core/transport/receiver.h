#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/light/light.h"
#include "core/scene.h"
#include "core/trace/stage.h"

namespace relight {

/// A place that receives light: a vertex, or where a ray met the surface.
struct Receiver {
    Point3 p;
    Point3 lifted;  ///< where rays start before they step off the surface: p, or the terminator's
    Frame frame;    ///< to shade in: z is the normal n, x the tangent
    Dir3 ng;        ///< geometric normal, on the side of n
    Clearance clear;
};

/// The vertex as a receiver; frame.n is "no direction" if it cannot be lit.
Receiver vertex_receiver(const Stage& stage, std::size_t vertex);

/// Where a ray along `direction` met the surface: flat, on the side that the ray comes from.
Receiver hit_receiver(const Stage& stage, Point3 origin, Dir3 direction, const Hit& hit);

/// Where rays along wi start: off the side that wi leaves from.
Point3 ray_start(const Receiver& receiver, Dir3 wi);

/// The occlusion ray from a receiver along wi, off the side that wi leaves from, as far as
/// `distance` (to a place on a light: it then aims at that very place) or options.max_distance.
ShadowRay shadow_ray(const Bvh& bvh, const Receiver& receiver, Dir3 wi, double distance,
                     const TransportOptions& options);

/// Distance at which a ray toward a shining face of the mesh stops, so as not to be blocked by the
/// face itself [scene units].
inline double short_of_face(const Bvh& bvh, double distance)
{
    constexpr double relative = 1e-5;  // some hundred roundings of a float distance
    constexpr double steps_off = 1e3;  // and of a float coordinate: 1e-6 of the model
    return std::max(
        0.0, distance - std::max(relative * distance, steps_off * bvh.clearance(0.0).offset));
}

/// E of one unit of power on a surface that faces a delta light [1/m^2 sr, or 1]: distances are in
/// scene units, areas in square metres.
double per_unit_m2(const Arrival& arrival, double length_unit_m);

/// The material of a face, and its place in scene.materials.
std::uint32_t material_index(const Scene& scene, const Mesh& mesh, std::size_t face);

/// A material at one place: one of the scene's, or where the file's textures vary it, what they
/// make of it there.
class LocalMaterial {
  public:
    LocalMaterial() = default;
    /// Outlives this.
    explicit LocalMaterial(const Material& everywhere) : material_(&everywhere) {}
    explicit LocalMaterial(std::shared_ptr<const Material> here)
        : material_(here.get()), here_(std::move(here))
    {
    }
    const Material& operator*() const { return *material_; }
    const Material* operator->() const { return material_; }

  private:
    const Material* material_ = nullptr;
    std::shared_ptr<const Material> here_;  ///< null: the scene's own
};

/// Of what a ray hit.
LocalMaterial material_at(const Stage& stage, const Scene& scene, const Hit& hit);
/// Of a vertex, with `materials` = vertex_materials().
LocalMaterial vertex_material(const Stage& stage, const Scene& scene,
                              std::span<const std::uint32_t> materials, std::size_t vertex);
/// V indices into scene.materials: a vertex has the material of the first face that uses it.
/// Empty: the first for all.
std::vector<std::uint32_t> vertex_materials(const Stage& stage, const Scene& scene);

/// A vertex as its viewer sees it.
struct SeenVertex {
    Receiver receiver;        ///< turned to the side that is seen
    Vec3 wo;                  ///< to the viewer, in receiver.frame
    bool both_sides = false;  ///< two-sided in the normal view: it shows the light of either side
};
/// Nothing where the viewer is below the horizon, or the vertex cannot be lit.
std::optional<SeenVertex> seen_vertex(const Stage& stage, const Scene& scene, std::size_t vertex);

/// Lo = rho E / pi: the material is Lambertian, and the viewer sees the sides that E has.
bool E_tells_radiance(const Scene& scene, const Material& material);

/// Linear colour that the file gives a vertex or (interpolated) a hit: its vertex colour, its base
/// colour's factor and texture, multiplied; white without. What a request calls "vertex".
Rgb vertex_color(const Stage& stage, std::size_t vertex);
Rgb color_at(const Stage& stage, const Hit& hit);

}  // namespace relight
