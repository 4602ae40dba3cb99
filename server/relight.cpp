#include "server/relight.h"

#include <algorithm>
#include <limits>

#include "core/shade/shade.h"
#include "server/encode.h"
#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/negotiate.h"
#include "server/relight_checks.h"
#include "server/timed.h"

namespace relight {
namespace {

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
Result<Encoded> light_vertices(const RelightRequest& request, Format format, const SetUp& made,
                               std::span<const std::byte> source, const Workshop& workshop,
                               Timings& timings, Progress& progress)
{
    const Stage& stage = made.model.stage;
    const Scene& scene = made.scene;
    const Quantities& wanted = request.output.quantities;
    const bool radiance = wanted.color || wanted.radiance || is_image(format);
    const TransportWanted columns{radiance, wanted.ambient_occlusion, wanted.sh, workshop.threads};
    const Transport transport =
        timed(timings.trace, [&] { return trace(stage, scene, columns, progress); });
    if (progress.stopped()) { return cancelled(); }
    const ShadeOptions options{radiance, wanted.per_light, wanted.standard_error, workshop.threads};
    Shaded shaded =
        timed(timings.shade, [&] { return shade(stage, transport, scene, options, progress); });
    if (progress.stopped()) { return cancelled(); }
    std::size_t clamped = clamp_to_finite(shaded.irradiance) + clamp_to_finite(shaded.radiance) +
                          clamp_to_finite(shaded.standard_error);
    for (auto& one : shaded.per_light) { clamped += clamp_to_finite(one); }
    Encoded encoded{std::string(media_type(format)),
                    {},
                    transport.rays,
                    {},
                    warnings_of(stage, scene, clamped, Receivers::Vertices)};
    warn_of_thin_shadows(encoded.warnings, stage, shaded.irradiance);
    return timed(timings.encode, [&]() -> Result<Encoded> {
        if (is_image(format)) {
            auto picture = encode_preview(stage, scene, shaded.radiance, request.display,
                                          request.output, format, workshop.threads, progress);
            if (!picture) { return std::move(picture).error(); }
            encoded.bytes = std::move(*picture);
        } else {
            const Lit lit{stage, scene, transport, shaded, encoded.warnings, source};
            auto file =
                encode_mesh(lit, request.display, wanted, format, workshop.threads, progress);
            if (!file) { return std::move(file).error(); }
            encoded.bytes = std::move(*file);
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
    std::size_t clamped =
        clamp_to_finite(rendered.image.pixels) + clamp_to_finite(rendered.standard_error);
    for (auto& one : rendered.per_light) { clamped += clamp_to_finite(one); }
    Encoded encoded{std::string(media_type(format)),
                    {},
                    rendered.rays,
                    {},
                    warnings_of(stage, scene, clamped, Receivers::Pixels)};
    timed(timings.encode, [&] {
        encoded.bytes = is_display_image(format)
                            ? encode_image(rendered.image, request.display, output, format,
                                           workshop.threads, progress)
                            : encode_radiance(rendered, scene, output, format, encoded.warnings);
    });
    if (progress.stopped()) { return cancelled(); }
    return encoded;
}

}  // namespace

Result<Encoded> relight(RelightRequest request, Format format, const std::vector<Part>& parts,
                        const Workshop& workshop, Progress& progress)
{
    Timings timings;
    if (auto error = check_format(request.output, format)) { return std::move(*error); }
    const auto light = [&](const SetUp& made) -> Result<Encoded> {
        const Stage& stage = made.model.stage;
        const Scene& scene = made.scene;
        if (auto error = check(request, format, made, workshop)) { return std::move(*error); }
        const bool traced = is_image(format) && request.output.renderer == Renderer::Raytrace;
        if (traced) {
            return light_pixels(request, format, stage, scene, workshop, timings, progress);
        }
        std::vector<std::byte> source;  // where the answer is the file itself, added to
        if (keeps_source(format, *stage.mesh)) {
            auto bytes = source_of(request, parts, workshop);
            if (!bytes) { return std::move(bytes).error(); }
            source = std::move(*bytes);
        }
        return light_vertices(request, format, made, source, workshop, timings, progress);
    };
    auto encoded = timed(timings.total, [&] {
        return set_up(request, parts, workshop, timings, progress).and_then(light);
    });
    if (encoded) { encoded->timings = timings; }
    return encoded;
}

}  // namespace relight
