#include "server/relight.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "core/shade/shade.h"
#include "server/encode.h"
#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/mesh_file.h"
#include "server/negotiate.h"
#include "server/relight_checks.h"
#include "server/scene_json.h"

namespace relight {
namespace {

using Clock = std::chrono::steady_clock;

/// Adds the time of `work` to a stage's; returns what it returns.
template <class Work>
auto timed(double& ms, Work&& work)
{
    struct Stopwatch {
        double& ms;
        Clock::time_point start = Clock::now();
        ~Stopwatch()
        {
            ms += std::chrono::duration<double, std::milli>(Clock::now() - start).count();
        }
    };
    const Stopwatch stopwatch{ms};
    return work();
}

Error cancelled()
{
    return make_error(Fault::Cancelled, "the server is stopping; send it again later");
}

/// Mesh -> surface and acceleration structure.
Result<Stage> build_stage(Mesh mesh, double point_radius_scale, unsigned threads, Timings& timings,
                          Progress& progress)
{
    if (mesh.faces.count() == 0 && mesh.normals.empty()) {
        return make_error(Fault::NormalsRequired,
                          "a point cloud is lit by the normals it brings, and this one has none; "
                          "estimating them is not in this build",
                          "/mesh");
    }
    return timed(timings.bvh, [&]() -> Result<Stage> {
        Stage stage;
        stage.mesh = std::make_shared<const Mesh>(std::move(mesh));
        stage.surface = std::make_shared<const Surface>(prepare(*stage.mesh, threads, progress));
        if (progress.stopped()) { return cancelled(); }
        stage.bvh = std::make_shared<const Bvh>(*stage.mesh, *stage.surface, point_radius_scale);
        return stage;
    });
}

/// The stage of a request's mesh, from the cache if it has come before.
struct StageFinder {
    const RelightRequest& request;
    const std::vector<Part>& parts;
    const Workshop& workshop;
    Timings& timings;
    Progress& progress;

    Result<Stage> build(std::span<const std::byte> file, std::optional<std::string_view> format,
                        std::string_view content_type) const
    {
        auto mesh = timed(timings.parse, [&] {
            return parse_mesh(file, format, content_type, workshop.read, progress);
        });
        if (!mesh) { return std::move(mesh).error(); }
        return build_stage(std::move(*mesh), request.point_radius_scale, workshop.threads, timings,
                           progress);
    }

    /// What a stage depends on: the file, how it is read, the size of its points.
    std::string key(const std::string& id, std::string_view read_as) const
    {
        return id + ' ' + std::string(read_as) + ' ' + decimal(request.point_radius_scale);
    }

    Result<Stage> operator()(const StoredMesh& stored) const
    {
        const auto object = workshop.store.find(stored.id);
        if (!object) {
            return make_error(Fault::NotFound,
                              "no mesh is stored under this id; POST /v1/meshes stores one",
                              "/mesh/id");
        }
        return workshop.cache.stage(key(stored.id, object->format), [&]() -> Result<Stage> {
            const File file = workshop.store.open(stored.id);
            if (!file) { return make_error(Fault::NotFound, "this mesh was deleted", "/mesh/id"); }
            return build(file.read_all(), object->format, {});
        });
    }

    Result<Stage> operator()(const PartMesh& mesh) const
    {
        const auto part = std::find_if(parts.begin(), parts.end(),
                                       [&](const Part& p) { return p.name == mesh.part; });
        if (part == parts.end()) {
            return make_error(Fault::MissingField,
                              "no part of the request is called \"" + printable(mesh.part) +
                                  "\"; a part is a file of a multipart/form-data body",
                              "/mesh/part");
        }
        return workshop.cache.stage(key(sha256(part->data), part->content_type), [&] {
            return build(std::as_bytes(std::span(part->data)), {}, part->content_type);
        });
    }

    Result<Stage> operator()(const Mesh& mesh) const
    {
        return build_stage(mesh, request.point_radius_scale, workshop.threads, timings, progress);
    }
};

/// Values beyond single precision become its largest: an answer holds finite numbers only.
std::size_t clamp_to_finite(std::vector<Rgbf>& values)
{
    std::size_t clamped = 0;
    for (Rgbf& value : values) {
        for (float& band : value) {
            if (band <= std::numeric_limits<float>::max()) { continue; }
            band = std::numeric_limits<float>::max();
            ++clamped;
        }
    }
    return clamped;
}

/// Stage and scene -> columns -> E and L -> bytes, per vertex.
Result<Encoded> light_vertices(const RelightRequest& request, Format format, const Stage& stage,
                               const Scene& scene, const Workshop& workshop, Timings& timings,
                               Progress& progress)
{
    const Quantities& wanted = request.output.quantities;
    const Transport transport =
        timed(timings.trace, [&] { return trace(stage, scene, workshop.threads, progress); });
    if (progress.stopped()) { return cancelled(); }
    const ShadeOptions options{wanted.color || wanted.radiance || is_image(format),
                               wanted.per_light, workshop.threads};
    Shaded shaded =
        timed(timings.shade, [&] { return shade(stage, transport, scene, options, progress); });
    if (progress.stopped()) { return cancelled(); }
    std::size_t clamped = clamp_to_finite(shaded.irradiance) + clamp_to_finite(shaded.radiance);
    for (auto& one : shaded.per_light) { clamped += clamp_to_finite(one); }
    Encoded encoded{std::string(media_type(format)),
                    {},
                    transport.rays,
                    {},
                    warnings_of(stage, scene, clamped, Receivers::Vertices)};
    return timed(timings.encode, [&]() -> Result<Encoded> {
        if (is_image(format)) {
            auto png = encode_preview(stage, scene, shaded.radiance, request.display,
                                      request.output, workshop.threads, progress);
            if (!png) { return std::move(png).error(); }
            encoded.bytes = std::move(*png);
        } else {
            const Lit lit{stage, scene, transport, shaded, encoded.warnings};
            encoded.bytes =
                encode_mesh(lit, request.display, wanted, format, workshop.threads, progress);
        }
        if (progress.stopped()) { return cancelled(); }
        return std::move(encoded);
    });
}

/// Stage and scene -> picture -> bytes.
Result<Encoded> light_pixels(const RelightRequest& request, Format format, const Stage& stage,
                             const Scene& scene, const Workshop& workshop, Timings& timings,
                             Progress& progress)
{
    const Output& output = request.output;
    const RaytraceOptions options{output.width,         output.height,
                                  output.samples,       output.background.value_or(Rgb{}),
                                  scene.transport.seed, workshop.threads};
    Rendered rendered =
        timed(timings.trace, [&] { return raytrace(stage, scene, options, progress); });
    if (progress.stopped()) { return cancelled(); }
    const std::size_t clamped = clamp_to_finite(rendered.image.pixels);
    Encoded encoded{std::string(media_type(format)),
                    {},
                    rendered.rays,
                    {},
                    warnings_of(stage, scene, clamped, Receivers::Pixels)};
    timed(timings.encode, [&] {
        encoded.bytes =
            encode_image(rendered.image, request.display, output, workshop.threads, progress);
    });
    if (progress.stopped()) { return cancelled(); }
    return encoded;
}

}  // namespace

Result<Mesh> parse_mesh(std::span<const std::byte> file, std::optional<std::string_view> named,
                        std::string_view content_type, const ReadLimits& limits, Progress& progress)
{
    return choose_mesh_format(named, content_type, file).and_then([&](MeshFormat format) {
        return read_mesh(format, file, limits, progress);
    });
}

Result<Encoded> relight(const RelightRequest& request, Format format,
                        const std::vector<Part>& parts, const Workshop& workshop,
                        Progress& progress)
{
    Timings timings;
    const auto light = [&](const Stage& stage) {
        return complete(request, stage.surface->bounds)
            .and_then([&](const Scene& scene) -> Result<Encoded> {
                if (auto error = check(request, format, stage, scene, workshop)) {
                    return std::move(*error);
                }
                const bool traced =
                    is_image(format) && request.output.renderer == Renderer::Raytrace;
                return traced ? light_pixels(request, format, stage, scene, workshop, timings,
                                             progress)
                              : light_vertices(request, format, stage, scene, workshop, timings,
                                               progress);
            });
    };
    if (auto error = check_format(request.output, format)) { return std::move(*error); }
    auto encoded = timed(timings.total, [&] {
        return std::visit(StageFinder{request, parts, workshop, timings, progress}, request.mesh)
            .and_then(light);
    });
    if (encoded) { encoded->timings = timings; }
    return encoded;
}

}  // namespace relight
