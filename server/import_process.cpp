#include "server/import_process.h"

#include <algorithm>
#include <cmath>
#include <memory>
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
    ImportedImage imported;
    Image& image = imported.image;
    std::uint64_t negatives = 0;
    const auto room = [&](const Header& header) -> std::optional<std::span<std::byte>> {
        if (header.width < 1 || header.height < 1 || header.width > limits.pixels / header.height) {
            return {};
        }
        negatives = header.negatives;
        image.width = static_cast<int>(header.width);
        image.height = static_cast<int>(header.height);
        image.pixels.resize(std::size_t{header.width} * header.height);
        const auto texels = std::as_writable_bytes(std::span(image.pixels));
        if (header.bytes != texels.size()) { return {}; }
        return texels;
    };
    const auto done = run_importer(exr, file, limits, progress, room);
    if (!done) { return done.error(); }
    const auto good = [](const Rgbf& texel) {
        return std::all_of(texel.begin(), texel.end(),
                           [](float v) { return v >= 0.0F && std::isfinite(v); });
    };
    if (!std::all_of(image.pixels.begin(), image.pixels.end(), good)) { return broken_import(exr); }
    if (negatives > 0) {
        imported.notes.push_back(std::to_string(negatives) + " values below 0 became 0");
    }
    return imported;
}

Result<Asset> import_gltf(std::span<const std::byte> file, const ImportLimits& limits,
                          Progress& progress)
{
    std::unique_ptr<std::byte[]> archive;  // left as it is until bytes come: pages that never do
    std::size_t size = 0;                  // cost nothing
    const auto room = [&](const Header& header) -> std::optional<std::span<std::byte>> {
        if (header.bytes > limits.memory) { return {}; }  // it held all that in its own
        size = header.bytes;
        archive = std::make_unique_for_overwrite<std::byte[]>(size);
        return std::span(archive.get(), size);
    };
    const auto done = run_importer(gltf, file, limits, progress, room);
    if (!done) { return done.error(); }
    std::optional<Asset> asset = read_asset({archive.get(), size});
    if (!asset || !within(asset->mesh, limits)) { return broken_import(gltf); }
    mend_text(*asset);
    return std::move(*asset);
}

}  // namespace relight
