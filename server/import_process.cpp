#include "server/import_process.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/io/utf8.h"
#include "server/import/archive.h"
#include "server/importer.h"

namespace relight {
namespace {

using import_protocol::Header;

constexpr ImportKind exr{"exr", "write it anew with another program, or send a Radiance .hdr"};
constexpr ImportKind gltf{"gltf",
                          "export it anew as GLB, without compression, or send a PLY or OBJ"};

bool within(const Mesh& mesh, const ImportLimits& limits)
{
    return mesh.positions.size() <= limits.vertices && mesh.faces.count() <= limits.faces &&
           std::all_of(mesh.textures.begin(), mesh.textures.end(),
                       [&](const Texture& t) { return t.texels.size() <= limits.pixels; });
}

/// All that becomes part of an answer: text that JSON can carry.
void mend_text(Asset& asset)
{
    for (std::string& name : asset.mesh.materials) { name = as_utf8(name); }
    for (std::string& note : asset.mesh.notes) { note = as_utf8(note); }
    for (Light& light : asset.lights) { light.name = as_utf8(light.name); }
}

}  // namespace

Result<ImportedImage> import_exr(std::span<const std::byte> file, const ImportLimits& limits,
                                 Progress& progress)
{
    const auto answer = run_importer(exr, file, limits, progress);
    if (!answer) { return answer.error(); }
    const Header& header = answer->header;
    if (header.width < 1 || header.height < 1 || header.width > limits.pixels / header.height) {
        return broken_import(exr);
    }
    const std::size_t count = std::size_t{header.width} * header.height;
    if (header.bytes != count * sizeof(Rgbf)) { return broken_import(exr); }
    ImportedImage imported;
    Image& image = imported.image;
    image.width = static_cast<int>(header.width);
    image.height = static_cast<int>(header.height);
    const auto* const texels = reinterpret_cast<const Rgbf*>(answer->content.data());
    image.pixels.assign(texels, texels + count);
    const auto good = [](const Rgbf& texel) {
        return std::all_of(texel.begin(), texel.end(),
                           [](float v) { return v >= 0.0F && std::isfinite(v); });
    };
    if (!std::all_of(image.pixels.begin(), image.pixels.end(), good)) { return broken_import(exr); }
    if (header.negatives > 0) {
        imported.notes.push_back(std::to_string(header.negatives) + " values below 0 became 0");
    }
    return imported;
}

Result<Asset> import_gltf(std::span<const std::byte> file, const ImportLimits& limits,
                          Progress& progress)
{
    const auto answer = run_importer(gltf, file, limits, progress);
    if (!answer) { return answer.error(); }
    std::optional<Asset> asset = read_asset(answer->content);
    if (!asset || !within(asset->mesh, limits)) { return broken_import(gltf); }
    mend_text(*asset);
    return std::move(*asset);
}

}  // namespace relight
