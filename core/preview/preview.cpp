#include "core/preview/preview.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/preview/discs.h"
#include "core/preview/draw.h"
#include "core/preview/render_thread.h"

namespace relight {
namespace {

// Of a disc, in units of the local spacing: as wide as those that rays meet (Bvh).
constexpr double radius_scale = 1.5;

/// The surface in the drawing's coordinates: (x - centre) / unit.
class Placed {
  public:
    Placed(const Mesh& mesh, const Surface& surface)
        : mesh_(mesh), surface_(surface), centre_(surface.bounds.centre())
    {
        const double diagonal = surface.bounds.diagonal();
        unit_ = diagonal > 0.0 ? diagonal : 1.0;
    }
    Point3 at(Point3 p) const { return Point3{} + (p - centre_) / unit_; }

    void add_triangles(std::span<const Rgb8> colors, Drawing& drawing) const
    {
        drawing.positions.reserve(3 * mesh_.positions.size());
        for (const Point3 vertex : mesh_.positions) {
            const Point3 p = at(vertex);
            for (const double x : {p.x, p.y, p.z}) {
                drawing.positions.push_back(static_cast<float>(x));
            }
        }
        drawing.colors.assign(colors.begin(), colors.end());
        drawing.corners.reserve(3 * surface_.triangles.size());
        for (const Triangle& t : surface_.triangles) {
            drawing.corners.insert(drawing.corners.end(), {t[0], t[1], t[2]});
        }
    }

    void add_points(std::span<const Rgb8> colors, Drawing& drawing) const
    {
        const std::vector<std::uint32_t> chosen = chosen_points(mesh_.positions.size());
        // Each stands for so many, and is as much larger.
        const auto each =
            static_cast<double>(mesh_.positions.size()) / static_cast<double>(chosen.size());
        const double scale = radius_scale * std::sqrt(each) / unit_;
        for (const std::uint32_t v : chosen) {
            if (std::binary_search(mesh_.absent.begin(), mesh_.absent.end(), v)) { continue; }
            add_disc({.p = at(mesh_.positions[v]),
                      .n = surface_.normals[v],
                      .bend = static_cast<double>(surface_.bend[v]),
                      .radius = scale * static_cast<double>(surface_.spacing[v]),
                      .color = colors[v]},
                     drawing);
        }
    }

  private:
    const Mesh& mesh_;
    const Surface& surface_;
    Point3 centre_;
    double unit_ = 1.0;
};

/// Depths a little beyond what is there. Something at or behind the eye: as near as the depth
/// buffer can still tell apart what is far.
void fit_depths(Drawing& drawing)
{
    bool all_ahead = true;
    double nearest = std::numeric_limits<double>::infinity();
    double farthest = 0.0;
    for (std::size_t i = 0; i < drawing.positions.size(); i += 3) {
        const Point3 p{drawing.positions[i], drawing.positions[i + 1], drawing.positions[i + 2]};
        const double depth = dot(drawing.eye - p, drawing.axes.back);
        all_ahead = all_ahead && depth > 0.0;
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
    }
    if (!(farthest > 0.0)) { return; }
    drawing.far = 1.01 * farthest;
    drawing.near = std::max(all_ahead ? 0.99 * nearest : 0.0, 1e-4 * drawing.far);
}

}  // namespace

Result<Picture> preview(const Mesh& mesh, const Surface& surface, std::span<const Rgb8> colors,
                        const Camera& camera, const PreviewOptions& options, Progress& progress)
{
    assert(colors.size() == mesh.positions.size());
    const Placed placed(mesh, surface);
    Drawing drawing{.eye = placed.at(camera.eye),
                    .axes = axes(camera),
                    .fov_y = camera.fov_y,
                    .options = options};
    if (surface.triangles.empty()) {
        placed.add_points(colors, drawing);
    } else {
        placed.add_triangles(colors, drawing);
    }
    fit_depths(drawing);
    std::optional<Result<Picture>> picture;
    on_render_thread([&] { picture = draw(drawing, progress); });
    if (progress.stopped()) {
        return Error{Fault::Cancelled, "the picture was no longer wanted", {}, {}, {}};
    }
    return std::move(*picture);
}

}  // namespace relight
