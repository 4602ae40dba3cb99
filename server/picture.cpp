#include "server/picture.h"

#include <algorithm>

#include "core/io/writers.h"
#include "core/preview/preview.h"
#include "server/answer_parts.h"

namespace relight {
namespace {

/// Pixels of display colours as PNG, or as JPEG, which has no alpha.
std::string picture_file(int width, int height, std::span<const Rgb8> pixels, const Output& output,
                         Format format, std::span<const unsigned char> alpha = {})
{
    return format == Format::Jpeg ? write_jpeg(width, height, pixels, output.quality)
                                  : write_png(width, height, pixels, alpha);
}

/// Divides what the background's share left of colour and light out of a pixel: PNG's alpha is
/// straight.
Rgbf straight(Rgbf mixed, float coverage)
{
    if (coverage > 0.0F) {
        for (float& band : mixed) { band /= coverage; }
    }
    return mixed;
}

}  // namespace

std::string encode_radiance(const Rendered& rendered, const Scene& scene, const Output& output,
                            Format format, const std::vector<std::string>& warnings)
{
    const Image& image = rendered.image;
    std::vector<std::string> comments{"radiance in " +
                                      std::string(unit_names(scene.units).radiance)};
    for (const std::string& warning : warnings) { comments.push_back("warning: " + warning); }
    if (format == Format::Hdr) {
        return write_hdr(image.width, image.height, image.pixels, comments);
    }
    std::vector<ExrLayer> layers{{"", 3, floats(image.pixels)}, {"A", 1, image.coverage}};
    if (output.quantities.standard_error) {
        layers.push_back({"standard_error", 3, floats(rendered.standard_error)});
    }
    if (output.quantities.normal) { layers.push_back({"normal", 3, floats(rendered.normal)}); }
    const auto names = property_names(scene.lights);
    for (std::size_t l = 0; l < rendered.per_light.size(); ++l) {
        layers.push_back({"per_light_" + names[l], 3, floats(rendered.per_light[l])});
    }
    return write_exr(image.width, image.height, layers, comments);
}

std::string encode_image(const Image& image, Display display, const Output& output, Format format,
                         unsigned threads, Progress& progress)
{
    if (display.auto_exposure) {
        std::vector<Rgbf> seen;  // the background has no say
        for (std::size_t i = 0; i < image.pixels.size(); ++i) {
            if (image.coverage[i] > 0.0F) { seen.push_back(image.pixels[i]); }
        }
        display.exposure_ev = auto_exposure_ev(seen);
    }
    if (!output.transparent) {
        return picture_file(image.width, image.height,
                            to_srgb8(image.pixels, display, threads, progress), output, format);
    }
    std::vector<Rgbf> own(image.pixels.size());
    std::vector<unsigned char> alpha(image.pixels.size());
    for (std::size_t i = 0; i < own.size(); ++i) {
        own[i] = straight(image.pixels[i], image.coverage[i]);
        alpha[i] = to_code(static_cast<double>(image.coverage[i]));
    }
    return write_png(image.width, image.height, to_srgb8(own, display, threads, progress), alpha);
}

Result<std::string> encode_preview(const Stage& stage, const Scene& scene,
                                   std::span<const Rgbf> radiance, Display display,
                                   const Output& output, Format format, unsigned threads,
                                   Progress& progress)
{
    if (display.auto_exposure) { display.exposure_ev = auto_exposure_ev(radiance); }
    const auto colors = to_srgb8(radiance, display, threads, progress);
    PreviewOptions options;
    options.width = output.width;
    options.height = output.height;
    options.samples = output.samples;
    options.background = to_srgb8(output.background.value_or(Rgb{}), display);
    auto picture = preview(*stage.mesh, *stage.surface, colors, scene.camera, options, progress);
    if (!picture) { return std::move(picture).error(); }
    if (!output.transparent) {
        return picture_file(picture->width, picture->height, picture->pixels, output, format);
    }
    for (std::size_t i = 0; i < picture->pixels.size(); ++i) {
        const int alpha = picture->alpha[i];
        if (alpha == 0) { continue; }
        for (unsigned char& band : picture->pixels[i]) {  // drawn over black
            band = static_cast<unsigned char>(std::min(255, (band * 255 + alpha / 2) / alpha));
        }
    }
    return write_png(picture->width, picture->height, picture->pixels, picture->alpha);
}

}  // namespace relight
