#include "core/trace/occluders.h"

#include <atomic>
#include <cmath>

#include "core/geometry/filled.h"

namespace relight {
namespace {

constexpr std::size_t fill_block = 1 << 14;  // vertices; some hundred microseconds

void put(float* to, Vec3 v)
{
    to[0] = static_cast<float>(v.x);
    to[1] = static_cast<float>(v.y);
    to[2] = static_cast<float>(v.z);
}

}  // namespace

Occluders::Occluders(std::shared_ptr<const Mesh> m, std::shared_ptr<const Surface> s,
                     double radius_scale, Progress& progress)
    : mesh(std::move(m)), surface(std::move(s)), point_radius_scale(radius_scale)
{
    box.centre = surface->bounds.centre();
    const double half = 0.5 * surface->bounds.diagonal();
    box.scale = half > 0.0 ? std::exp2(-std::ceil(std::log2(half))) : 1.0;
    const std::vector<Point3>& positions = mesh->positions;
    if (!is_cloud()) {
        vertices = filled<float>(3 * positions.size() + 1, progress);
        parallel_for(positions.size(), fill_block, 0, progress,
                     [&](std::size_t begin, std::size_t end) {
                         for (std::size_t v = begin; v < end; ++v) {
                             put(&vertices[3 * v], box.to_box(positions[v]));
                         }
                     });
        return;
    }
    const std::size_t discs = find_discs(progress);
    vertices = filled<float>(4 * discs, progress);
    normals = filled<float>(3 * discs + 1, progress);
    parallel_for(discs, fill_block, 0, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t d = begin; d < end; ++d) {
            const std::uint32_t i = point(static_cast<std::uint32_t>(d));
            put(&vertices[4 * d], box.to_box(positions[i]));
            vertices[4 * d + 3] = static_cast<float>(disc_radius(i) * box.scale);
            put(&normals[3 * d], surface->normals[i]);
        }
    });
}

std::size_t Occluders::find_discs(Progress& progress)
{
    const std::size_t points = mesh->positions.size();
    const auto has_disc = [&](std::size_t i) {
        return surface->normals[i] && disc_radius(i) > 0.0;
    };
    std::atomic<std::size_t> discs{0};
    parallel_for(points, fill_block, 0, progress, [&](std::size_t begin, std::size_t end) {
        std::size_t some = 0;
        for (std::size_t i = begin; i < end; ++i) { some += has_disc(i) ? 1 : 0; }
        discs += some;
    });
    if (discs == points) { return discs; }
    disc_point.reserve(discs);
    for (std::size_t i = 0; i < points; ++i) {
        if (i % fill_block == 0 && progress.stopped()) { break; }
        if (has_disc(i)) { disc_point.push_back(static_cast<std::uint32_t>(i)); }
    }
    return discs;
}

std::optional<Meeting> Occluders::meeting(Point3 origin, Vec3 direction,
                                          std::uint32_t primitive) const
{
    if (is_cloud()) {
        const std::uint32_t i = point(primitive);
        return meet_disc(direction, mesh->positions[i] - origin, surface->normals[i],
                         disc_radius(i));
    }
    const Triangle& t = surface->triangles[primitive];
    return meet_triangle(direction, mesh->positions[t[0]] - origin, mesh->positions[t[1]] - origin,
                         mesh->positions[t[2]] - origin);
}

bool Occluders::is_met_in_double(const ExactRay& asked, std::uint32_t primitive) const
{
    const std::optional<Meeting> met = meeting(asked.origin, asked.direction, primitive);
    return met && met->inside && met->t > asked.from && met->t < asked.distance;
}

std::uint64_t Occluders::bytes() const
{
    return sizeof(float) * (vertices.capacity() + normals.capacity()) +
           sizeof(std::uint32_t) * disc_point.capacity();
}

}  // namespace relight
