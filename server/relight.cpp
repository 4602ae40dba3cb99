#include "server/relight.h"

#include "core/shade/shade.h"
#include "server/encode.h"
#include "server/finite.h"
#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/negotiate.h"
#include "server/relight_checks.h"
#include "server/timed.h"

namespace relight {
namespace {

/// Looks a column up among those that are kept, or keeps the one that is made.
Keep keeper(const SetUp& made, bool sh, const Workshop& workshop, Progress& progress)
{
    if (made.model.key.empty()) { return {}; }
    return [&made, &workshop, &progress, sh](Told told, std::size_t light, const auto& make) {
        const std::string key =
            made.model.key + '/' + column_key(told, made.scene, light, sh, made.names);
        auto column =
            workshop.cache.get<SharedColumn>(key, progress, [&]() -> Result<SharedColumn> {
                auto made_now = make();
                if (made_now == nullptr) { return cancelled(); }
                return made_now;
            });
        return column ? *column : nullptr;
    };
}

/// Stage and scene -> columns -> E and L -> bytes, per vertex.
Result<Encoded> light_vertices(const RelightRequest& request, Format format, const SetUp& made,
                               std::vector<std::byte> source, bool last, const Workshop& workshop,
                               Timings& timings, Progress& progress)
{
    const Stage& stage = made.model.stage;
    const Scene& scene = made.scene;
    const Output& output = request.output;
    const Quantities& wanted = output.quantities;
    const bool radiance = wanted.color || wanted.radiance || is_image(format);
    const TransportWanted columns{radiance, wanted.ambient_occlusion, wanted.sh, workshop.threads,
                                  keeper(made, wanted.sh, workshop, progress)};
    Transport transport =
        timed(timings.trace, [&] { return trace(stage, scene, columns, progress); });
    if (progress.stopped()) { return cancelled(); }
    const ShadeOptions options{radiance, wanted.per_light,
                               wanted.standard_error || output.progressive, workshop.threads};
    Encoded encoded;
    encoded.media_type = media_type(format);
    encoded.rays = transport.rays;
    encoded.units = scene.units;
    Shaded shaded = timed(timings.shade, [&] {
        Shaded lit = shade(stage, transport, scene, options, progress);
        std::size_t clamped = clamp_to_finite(lit.irradiance, workshop.threads) +
                              clamp_to_finite(lit.radiance, workshop.threads) +
                              clamp_to_finite(lit.standard_error, workshop.threads);
        for (auto& one : lit.per_light) { clamped += clamp_to_finite(one, workshop.threads); }
        encoded.warnings = warnings_of(stage, scene, clamped, Receivers::Vertices);
        warn_of_thin_shadows(encoded.warnings, stage, lit.irradiance, workshop.threads, progress);
        return lit;
    });
    if (progress.stopped()) { return cancelled(); }
    auto body = timed(timings.encode, [&]() -> Result<Encoding> {
        if (is_image(format)) {
            return encode_preview(stage, scene, shaded.radiance, request.display, output, format,
                                  workshop.threads, progress)
                .transform(sent_whole);
        }
        const auto lit =
            std::make_shared<Lit>(Lit{stage, scene, std::move(transport), std::move(shaded),
                                      encoded.warnings, std::move(source)});
        return encode_mesh(lit, request.display, output, format, last, workshop.threads, progress);
    });
    if (progress.stopped()) { return cancelled(); }
    if (!body) { return std::move(body).error(); }
    encoded.body = std::move(*body);
    return encoded;
}

/// Stage and scene -> picture -> bytes.
Result<Encoded> light_pixels(const RelightRequest& request, Format format, const Stage& stage,
                             const Scene& scene, const Workshop& workshop, Timings& timings,
                             Progress& progress)
{
    const Output& output = request.output;
    RaytraceOptions options;
    options.width = output.width;
    options.height = output.height;
    options.samples = output.samples;
    options.background = output.transparent ? Rgb{} : output.background;
    options.seed = scene.transport.seed;
    options.per_light = output.quantities.per_light;
    options.normal = output.quantities.normal;
    options.threads = workshop.threads;
    Rendered rendered =
        timed(timings.trace, [&] { return raytrace(stage, scene, options, progress); });
    if (progress.stopped()) { return cancelled(); }
    std::size_t clamped = clamp_to_finite(rendered.image.pixels, workshop.threads) +
                          clamp_to_finite(rendered.standard_error, workshop.threads);
    for (auto& one : rendered.per_light) { clamped += clamp_to_finite(one, workshop.threads); }
    Encoded encoded;
    encoded.media_type = media_type(format);
    encoded.rays = rendered.rays;
    encoded.units = scene.units;
    encoded.warnings = warnings_of(stage, scene, clamped, Receivers::Pixels);
    timed(timings.encode, [&] {
        encoded.body =
            sent_whole(is_display_image(format)
                           ? encode_image(rendered.image, request.display, output, format,
                                          workshop.threads, progress)
                           : encode_radiance(rendered, scene, output, format, encoded.warnings));
    });
    if (progress.stopped()) { return cancelled(); }
    return encoded;
}

}  // namespace

Result<Encoded> relight(RelightRequest request, Format format, const std::vector<Part>& parts,
                        const Workshop& workshop, Progress& progress, bool last)
{
    Timings timings;
    if (progress.stopped()) { return cancelled(); }
    if (auto error = check_format(request.output, format)) { return std::move(*error); }
    const auto light = [&](const SetUp& made) -> Result<Encoded> {
        const Stage& stage = made.model.stage;
        const Scene& scene = made.scene;
        if (auto error = check(request, format, made, workshop)) { return std::move(*error); }
        const auto counted = [&](Result<Encoded>&& encoded) {
            const std::uint64_t rays = encoded ? encoded->rays : 0;
            count_rays(made.model, request.points.radius_scale, rays, workshop);
            return std::move(encoded);
        };
        const bool traced = is_image(format) && request.output.renderer == Renderer::Raytrace;
        if (traced) {
            return counted(
                light_pixels(request, format, stage, scene, workshop, timings, progress));
        }
        std::vector<std::byte> source;  // where the answer is the file itself, added to
        if (keeps_source(format, *stage.mesh)) {
            auto bytes = source_of(request, parts, workshop);
            if (!bytes) { return std::move(bytes).error(); }
            source = std::move(*bytes);
        }
        return counted(light_vertices(request, format, made, std::move(source), last, workshop,
                                      timings, progress));
    };
    auto encoded = timed(timings.total, [&] {
        return set_up(request, parts, workshop, timings, progress).and_then(light);
    });
    if (encoded) { encoded->timings = timings; }
    return encoded;
}

}  // namespace relight
