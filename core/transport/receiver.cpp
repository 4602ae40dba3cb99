#include "core/transport/receiver.h"

#include <algorithm>
#include <cmath>

#include "core/transport/textured.h"

namespace relight {

Receiver vertex_receiver(const Stage& stage, std::size_t vertex)
{
    const Surface& surface = *stage.surface;
    const Point3 p = stage.mesh->positions[vertex];
    const Dir3 n = surface.normals[vertex];
    return {p, p, shading_frame(surface, vertex), n,
            stage.bvh->clearance(static_cast<double>(surface.spacing[vertex]))};
}

Receiver hit_receiver(const Stage& stage, Point3 origin, Dir3 direction, const Hit& hit)
{
    const Surface& surface = *stage.surface;
    Receiver receiver;
    double spacing = 0.0;
    if (hit.is_point) {
        receiver.ng = surface.normals[hit.primitive];
        spacing = static_cast<double>(surface.spacing[hit.primitive]);
        receiver.p = origin + Vec3(direction) * hit.distance;
    } else {
        const Triangle& t = surface.triangles[hit.primitive];
        const Point3 a = stage.mesh->positions[t[0]];
        const Vec3 ab = stage.mesh->positions[t[1]] - a;
        const Vec3 ac = stage.mesh->positions[t[2]] - a;
        receiver.ng = normalize(cross(ab, ac));
        spacing = static_cast<double>(
            std::min({surface.spacing[t[0]], surface.spacing[t[1]], surface.spacing[t[2]]}));
        receiver.p = a + ab * hit.u + ac * hit.v;
    }
    if (dot(receiver.ng, direction) > 0.0) { receiver.ng = -receiver.ng; }
    receiver.lifted = receiver.p;
    receiver.frame = frame_around(receiver.ng);
    receiver.clear = stage.bvh->clearance(spacing);
    return receiver;
}

Point3 ray_start(const Receiver& receiver, Dir3 wi)
{
    const double side = std::copysign(receiver.clear.offset, dot(receiver.ng, wi));
    return receiver.lifted + Vec3(receiver.ng) * side;
}

ShadowRay shadow_ray(const Bvh& bvh, const Receiver& receiver, Dir3 wi, double distance,
                     const TransportOptions& options)
{
    const double reach = options.max_distance.value_or(std::numeric_limits<double>::infinity());
    const Point3 origin = ray_start(receiver, wi);
    if (!std::isfinite(distance)) { return {origin, wi, receiver.clear.from, reach}; }
    const Vec3 to_light = receiver.p + Vec3(wi) * distance - origin;
    const Dir3 aim = normalize(to_light);
    // A light closer than the step itself is not behind anything.
    if (!aim || dot(aim, wi) <= 0.0) { return {origin, wi, receiver.clear.from, 0.0}; }
    const double short_of_light = length(to_light) - bvh.clearance(0.0).offset;
    return {origin, aim, receiver.clear.from, std::max(0.0, std::min(reach, short_of_light))};
}

double per_unit_m2(const Arrival& arrival, double length_unit_m)
{
    return std::isinf(arrival.distance) ? arrival.per_unit
                                        : arrival.per_unit / (length_unit_m * length_unit_m);
}

std::uint32_t material_index(const Scene& scene, const Mesh& mesh, std::size_t face)
{
    if (scene.material_of_group.empty() || mesh.face_materials.empty()) { return 0; }
    return scene.material_of_group[mesh.face_materials[face]];
}

namespace {

/// The scene's material `index`, or what the file's textures make of it at a vertex or hit.
template <class Place>
LocalMaterial local_material(const Stage& stage, const Scene& scene, std::uint32_t index,
                             const Place& at)
{
    const Material& everywhere = scene.materials[index];
    const auto* factors = scene.textured.empty() || !scene.textured[index]
                              ? nullptr
                              : std::get_if<MetallicRoughness>(&everywhere);
    if (factors == nullptr) { return LocalMaterial(everywhere); }
    const FiledPlace place = filed_place(stage, at);
    if (!varies(*factors, *stage.mesh, place)) { return LocalMaterial(everywhere); }
    return LocalMaterial(std::make_shared<const Material>(resolve(*factors, *stage.mesh, place)));
}

}  // namespace

LocalMaterial material_at(const Stage& stage, const Scene& scene, const Hit& hit)
{
    const Surface& surface = *stage.surface;
    if (hit.is_point) { return local_material(stage, scene, 0, hit); }
    const std::size_t face =
        surface.triangle_face.empty() ? hit.primitive : surface.triangle_face[hit.primitive];
    return local_material(stage, scene, material_index(scene, *stage.mesh, face), hit);
}

LocalMaterial vertex_material(const Stage& stage, const Scene& scene,
                              std::span<const std::uint32_t> materials, std::size_t vertex)
{
    return local_material(stage, scene, materials.empty() ? 0 : materials[vertex], vertex);
}

std::vector<std::uint32_t> vertex_materials(const Stage& stage, const Scene& scene)
{
    const Mesh& mesh = *stage.mesh;
    if (scene.material_of_group.empty() || mesh.face_materials.empty()) { return {}; }
    constexpr std::uint32_t none = ~0U;
    std::vector<std::uint32_t> of(mesh.positions.size(), none);
    for (std::size_t face = 0; face < mesh.faces.count(); ++face) {
        const std::uint32_t index = material_index(scene, mesh, face);
        for (std::size_t c = mesh.faces.begin(face); c < mesh.faces.end(face); ++c) {
            std::uint32_t& own = of[mesh.faces.indices[c]];
            if (own == none) { own = index; }
        }
    }
    std::replace(of.begin(), of.end(), none, 0U);
    return of;
}

namespace {

/// Direction from p to the viewer; "no direction" where the viewer stands at p.
Dir3 toward_viewer(const Scene& scene, Point3 p, Dir3 n)
{
    if (std::holds_alternative<CameraView>(scene.view)) { return normalize(scene.camera.eye - p); }
    const auto* direction = std::get_if<DirectionView>(&scene.view);
    return direction != nullptr ? direction->toward_viewer : n;
}

}  // namespace

std::optional<SeenVertex> seen_vertex(const Stage& stage, const Scene& scene, std::size_t vertex)
{
    SeenVertex seen{vertex_receiver(stage, vertex), {}, false};
    Frame& frame = seen.receiver.frame;
    const Dir3 to_viewer = toward_viewer(scene, seen.receiver.p, frame.n);
    const bool two_sided = scene.transport.two_sided;
    if (two_sided && dot(frame.n, to_viewer) < 0.0) {
        frame = {frame.x, -frame.y, -frame.n};
        seen.receiver.ng = -seen.receiver.ng;
    }
    if (!frame.n || !(dot(frame.n, to_viewer) > 0.0)) { return {}; }
    seen.wo = frame.to_local(to_viewer);
    seen.both_sides = two_sided && std::holds_alternative<NormalView>(scene.view);
    return seen;
}

bool E_tells_radiance(const Scene& scene, const Material& material)
{
    return is_lambertian(material) &&
           (!scene.transport.two_sided || std::holds_alternative<NormalView>(scene.view));
}

Rgb vertex_color(const Stage& stage, std::size_t vertex)
{
    return base_color(*stage.mesh, filed_place(stage, vertex));
}

Rgb color_at(const Stage& stage, const Hit& hit)
{
    return base_color(*stage.mesh, filed_place(stage, hit));
}

}  // namespace relight
