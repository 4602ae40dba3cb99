#include "server/light_file.h"

#include <algorithm>
#include <numbers>

#include "core/io/photometry.h"
#include "core/light/environment.h"
#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/negotiate.h"

namespace relight {
namespace {

/// "hdr" or "exr"; nothing if it is neither by name, media type or first bytes.
std::optional<std::string> image_format(std::span<const std::byte> file,
                                        std::optional<std::string_view> named,
                                        std::string_view content_type)
{
    if (named) {
        if (*named == "hdr" || *named == "exr") { return std::string(*named); }
        return {};
    }
    const std::string type = essence(content_type);
    if (type == "image/vnd.radiance" || type == "image/x-hdr") { return "hdr"; }
    if (type == "image/x-exr" || type == "image/aces") { return "exr"; }
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    if (text.starts_with("#?")) { return "hdr"; }
    if (text.starts_with("\x76\x2f\x31\x01")) { return "exr"; }
    return {};
}

std::string_view symmetry_of(const IesProfile& profile)
{
    const double first = profile.horizontal_deg.front();
    const double last = profile.horizontal_deg.back();
    if (profile.horizontal_deg.size() == 1) { return "axial"; }
    if (first == 90.0) { return "bilateral_90_270"; }
    if (last == 90.0) { return "quadrant"; }
    return last == 180.0 ? "bilateral_0_180" : "none";
}

}  // namespace

Result<EnvironmentFile> read_environment(std::span<const std::byte> file,
                                         std::optional<std::string_view> named,
                                         std::string_view content_type, std::uint64_t most_pixels,
                                         Progress& progress)
{
    if (file.empty()) { return make_error(Fault::EmptyFile, "the file has no bytes"); }
    const auto format = image_format(file, named, content_type);
    if (!format) {
        return make_error(Fault::UnknownFormat,
                          "an environment is an equirectangular Radiance .hdr or OpenEXR .exr; " +
                              (named ? "format \"" + printable(*named) + "\" is neither"
                                     : std::string("the first bytes are of neither; name it by "
                                                   "?format= or Content-Type if they mislead")));
    }
    if (*format == "hdr") {
        return read_hdr(file, most_pixels, progress).transform([&](Image&& image) {
            return EnvironmentFile{*format, std::move(image), {}};
        });
    }
    ImportLimits limits;
    limits.pixels = most_pixels;
    return import_exr(file, limits, progress).transform([&](ImportedImage&& imported) {
        return EnvironmentFile{*format, std::move(imported.image), std::move(imported.notes)};
    });
}

Result<IesProfile> read_profile(std::span<const std::byte> file,
                                std::optional<std::string_view> named, Progress& progress)
{
    if (named && *named != "ies") {
        return make_error(Fault::UnknownFormat, "a profile is an IESNA LM-63 .ies file; format \"" +
                                                    printable(*named) + "\" is another");
    }
    return read_ies(file, progress);
}

std::string describe(const std::string& id, std::uint64_t bytes, const EnvironmentFile& file)
{
    const EnvironmentMap map(file.image);
    Rgb integral;
    double brightest = 0.0;
    for (int y = 0; y < file.image.height; ++y) {
        for (int x = 0; x < file.image.width; ++x) {
            const Rgb L = to_double(file.image.pixels[file.image.at(x, y)]);
            integral += L * map.texel_solid_angle(y);
            brightest = std::max(brightest, luminance(L));
        }
    }
    std::vector<std::string> notes = file.notes;
    if (file.image.width != 2 * file.image.height) {
        notes.emplace_back("not twice as wide as high: is it equirectangular?");
    }
    if (brightest == 0.0) { notes.emplace_back("black: it lights nothing"); }
    const Rgb mean = integral / (4.0 * std::numbers::pi);
    return ObjectWriter()
        .text("id", id)
        .text("kind", "environment")
        .text("format", file.format)
        .count("bytes", bytes)
        .count("width", static_cast<std::uint64_t>(file.image.width))
        .count("height", static_cast<std::uint64_t>(file.image.height))
        .raw("mean_radiance", json_of(Vec3{mean.r, mean.g, mean.b}))
        .number("largest_luminance", brightest)
        .raw("notes", text_array(notes))
        .done();
}

std::string describe(const std::string& id, std::uint64_t bytes, const IesProfile& profile)
{
    return ObjectWriter()
        .text("id", id)
        .text("kind", "profile")
        .text("format", "ies")
        .count("bytes", bytes)
        .count("vertical_angles", profile.vertical_deg.size())
        .count("horizontal_angles", profile.horizontal_deg.size())
        .number("first_vertical_deg", profile.vertical_deg.front())
        .number("last_vertical_deg", profile.vertical_deg.back())
        .text("symmetry", symmetry_of(profile))
        .number("flux_lm", flux(profile))
        .number("largest_intensity_cd",
                *std::max_element(profile.candela.begin(), profile.candela.end()))
        .done();
}

}  // namespace relight
