#include "core/preview/preview.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>

#include "core/preview/draw.h"
#include "core/preview/render_thread.h"

namespace relight {
namespace {

constexpr std::size_t most_points = 200'000;  // a software driver takes seconds for a million
constexpr double smallest_point = 2.0;        // [pixels]
constexpr double largest_point = 64.0;

/// What of a cloud is drawn: at most most_points of [0, count), in order, one from each of so many
/// equal runs. Not always the same place of the run, which would leave stripes in a scan stored
/// line by line, but one scattered by a hash (the finaliser of MurmurHash3).
std::vector<std::uint32_t> chosen_points(std::size_t count)
{
    const std::size_t kept = std::min(count, most_points);
    std::vector<std::uint32_t> chosen(kept);
    for (std::uint64_t i = 0; i < kept; ++i) {
        std::uint64_t hash = i + 1;
        hash = (hash ^ (hash >> 33U)) * 0xFF51AFD7ED558CCDULL;
        hash = (hash ^ (hash >> 33U)) * 0xC4CEB9FE1A85EC53ULL;
        const std::uint64_t begin = i * count / kept;
        const std::uint64_t end = (i + 1) * count / kept;
        chosen[i] = static_cast<std::uint32_t>(begin + (hash >> 33U) % (end - begin));
    }
    return chosen;
}

std::vector<std::uint32_t> every_vertex(std::size_t count)
{
    std::vector<std::uint32_t> all(count);
    std::iota(all.begin(), all.end(), 0U);
    return all;
}

template <class T>
double median(std::vector<T> values)
{
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return static_cast<double>(*middle);
}

/// Diameter [pixels] at which the cloud reads as a surface: balls of radius 1.5 times the median
/// spacing (the discs that the rays meet have the same), seen from the median depth. `share` of the
/// points is drawn, so the spacing grows by 1/sqrt(share).
double point_diameter(const Surface& surface, const std::vector<double>& depths, double share,
                      double pixels_per_slope)
{
    if (surface.spacing.empty() || depths.empty()) { return smallest_point; }
    const double spacing = median(surface.spacing) / std::sqrt(share);
    return 3.0 * spacing * pixels_per_slope / median(depths);
}

}  // namespace

Result<Picture> preview(const Mesh& mesh, const Surface& surface, std::span<const Rgb8> colors,
                        const Camera& camera, const PreviewOptions& options, Progress& progress)
{
    assert(colors.size() == mesh.positions.size());
    const bool cloud = surface.triangles.empty();
    const std::size_t count = mesh.positions.size();
    const std::vector<std::uint32_t> shown = cloud ? chosen_points(count) : every_vertex(count);
    const Point3 centre = surface.bounds.centre();
    const double diagonal = surface.bounds.diagonal();
    const double unit = diagonal > 0.0 ? diagonal : 1.0;

    Drawing drawing{.eye = Point3{} + (camera.eye - centre) / unit,
                    .axes = axes(camera),
                    .fov_y = camera.fov_y,
                    .options = options};
    drawing.positions.reserve(3 * shown.size());
    drawing.colors.reserve(shown.size());
    std::vector<double> depths;  // of what is in front of the camera, in units
    depths.reserve(shown.size());
    for (const std::uint32_t v : shown) {
        const Point3 p = Point3{} + (mesh.positions[v] - centre) / unit;
        for (const double x : {p.x, p.y, p.z}) {
            drawing.positions.push_back(static_cast<float>(x));
        }
        drawing.colors.push_back(colors[v]);
        const double depth = dot(drawing.eye - p, drawing.axes.back);
        if (depth > 0.0) { depths.push_back(depth); }
    }
    drawing.corners.reserve(3 * surface.triangles.size());
    for (const Triangle& t : surface.triangles) {
        drawing.corners.insert(drawing.corners.end(), {t[0], t[1], t[2]});
    }
    if (!depths.empty()) {
        // A little more than what is there. Something at or behind the eye: as near as the depth
        // buffer can still tell apart what is far.
        const auto [nearest, farthest] = std::minmax_element(depths.begin(), depths.end());
        const bool all_ahead = depths.size() == shown.size();
        drawing.far = 1.01 * *farthest;
        drawing.near = std::max(all_ahead ? 0.99 * *nearest : 0.0, 1e-4 * drawing.far);
    }
    if (cloud) {
        const double share = static_cast<double>(shown.size()) / static_cast<double>(count);
        const double pixels_per_slope = 0.5 * options.height / std::tan(0.5 * camera.fov_y);
        const double diameter =
            options.point_radius > 0.0
                ? 2.0 * options.point_radius
                : point_diameter(surface, depths, share, pixels_per_slope / unit);
        drawing.point_size =
            static_cast<float>(std::clamp(diameter, smallest_point, largest_point));
    }

    std::optional<Result<Picture>> picture;
    on_render_thread([&] { picture = draw(drawing, progress); });
    if (progress.stopped()) {
        return Error{Fault::Cancelled, "the picture was no longer wanted", {}, {}, {}};
    }
    return std::move(*picture);
}

}  // namespace relight
