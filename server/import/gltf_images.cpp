#include "server/import/gltf_images.h"

#include <stb/stb_image.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <utility>

#include "server/import/gltf_factors.h"

namespace relight::gltf {
namespace {

std::string_view as_text(std::span<const std::byte> bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

constexpr std::string_view png_begin("\x89PNG\r\n\x1A\n", 8), jpeg_begin("\xFF\xD8\xFF", 3);

/// The name of a format that glTF extensions know and we do not, for the refusal.
std::string_view other_format(std::string_view text)
{
    if (text.starts_with("RIFF") && text.substr(0, 12).ends_with("WEBP")) { return "image/webp"; }
    if (text.starts_with("\xABKTX 20\xBB")) { return "image/ktx2"; }
    if (text.substr(0, 12).ends_with("ftypavif")) { return "image/avif"; }
    if (text.starts_with("GIF8")) { return "image/gif"; }
    return "neither, by its first bytes";
}

struct Size {
    std::uint64_t width = 0, height = 0;
};

/// As the header says, before anything is decoded; nothing if there is none.
std::optional<Size> size_of(std::span<const std::byte> bytes)
{
    const std::string_view text = as_text(bytes);
    if (text.starts_with(png_begin)) {  // IHDR comes first: width and height, big endian
        if (text.size() < 26 || text.substr(12, 4) != "IHDR") { return std::nullopt; }
        const auto number = [&](std::size_t at) {
            std::uint64_t value = 0;
            for (const char c : text.substr(at, 4)) {
                value = value << 8U | static_cast<unsigned char>(c);
            }
            return value;
        };
        return Size{number(16), number(20)};
    }
    int width = 0, height = 0, channels = 0;
    const bool read =
        stbi_info_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                              static_cast<int>(bytes.size()), &width, &height, &channels) != 0;
    if (!read) { return std::nullopt; }
    return Size{static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height)};
}

Size checked_size(std::span<const std::byte> bytes, std::string_view where,
                  std::uint64_t most_pixels)
{
    const auto size = size_of(bytes);
    if (!size || size->width == 0 || size->height == 0) {
        refuse(Fault::MalformedBody, where, "holds a picture whose header is broken");
    }
    const std::uint64_t most = std::min<std::uint64_t>(most_pixels, 1ULL << 28U);  // RGBA in an int
    if (size->width > most / size->height) {
        refuse(Fault::OutOfRange, where,
               "holds " + std::to_string(size->width) + " x " + std::to_string(size->height) +
                   " pixels; " + std::to_string(most) +
                   " are allowed it beside the file's other textures: send smaller pictures");
    }
    return *size;
}

Wrap wrap_of(const Node& sampler, std::string_view key)
{
    switch (sampler.count(key, 10497)) {
        case 33071:
            return Wrap::ClampToEdge;
        case 33648:
            return Wrap::MirroredRepeat;
        case 10497:
            return Wrap::Repeat;
        default:
            refuse(Fault::MalformedBody, sampler.at(key).where(),
                   "must be 33071 (clamp to edge), 33648 (mirrored repeat) or 10497 (repeat)");
    }
}

bool is_nearest(const Node& sampler)
{
    const std::uint64_t filter = sampler.count("magFilter", 9729);
    if (filter != 9728 && filter != 9729) {
        refuse(Fault::MalformedBody, sampler.at("magFilter").where(),
               "must be 9728 (nearest) or 9729 (linear)");
    }
    return filter == 9728;
}

/// translation * rotation * scale. Counter-clockwise as one sees the picture, whose v points down:
/// (u, v) = (1, 0) turns to (cos, -sin).   KHR_texture_transform
std::array<float, 6> transform_of(const Node& extension)
{
    using Pair = std::vector<double>;
    constexpr double most = largest_factor;
    const Pair offset = factors(extension, "offset", 2, -most, most).value_or(Pair{0.0, 0.0});
    const Pair scale = factors(extension, "scale", 2, -most, most).value_or(Pair{1.0, 1.0});
    const double rotation = extension.number("rotation", 0.0, -most, most);
    const double c = std::cos(rotation), s = std::sin(rotation);
    const std::array<double, 6> exact{c * scale[0],  s * scale[1], offset[0],
                                      -s * scale[0], c * scale[1], offset[1]};
    std::array<float, 6> rounded{};
    std::transform(exact.begin(), exact.end(), rounded.begin(),
                   [](double x) { return static_cast<float>(x); });
    return rounded;
}

}  // namespace

void Notes::add(std::string_view text)
{
    if (std::find(lines_.begin(), lines_.end(), text) == lines_.end()) {
        lines_.emplace_back(text);
    }
}

Texture decode_picture(std::span<const std::byte> bytes, std::string_view where,
                       std::uint64_t most_pixels, Notes& notes)
{
    const std::string_view text = as_text(bytes);
    const bool is_png = text.starts_with(png_begin);
    if (!is_png && !text.starts_with(jpeg_begin)) {
        refuse(Fault::NotAvailable, where,
               "must be image/png or image/jpeg, and is " + std::string(other_format(text)));
    }
    if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        refuse(Fault::OutOfRange, where, "holds a picture of 2 GiB or more");
    }
    const Size size = checked_size(bytes, where, most_pixels);
    if (is_png && text[24] == 16) { notes.add("PNG textures of 16 bits are read as 8 bits"); }

    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
        stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                              static_cast<int>(bytes.size()), &width, &height, &channels, 4),
        stbi_image_free);
    if (!pixels) {
        if (std::string_view(stbi_failure_reason()) == "outofmem") { throw std::bad_alloc(); }
        refuse(
            Fault::MalformedBody, where,
            std::string("holds a ") + (is_png ? "PNG" : "JPEG") + " that is broken or cut short");
    }
    if (std::cmp_not_equal(width, size.width) || std::cmp_not_equal(height, size.height)) {
        refuse(Fault::MalformedBody, where, "holds a picture of two sizes");
    }
    Texture texture{width, height, {}};
    texture.texels.resize(size.width * size.height);
    std::memcpy(texture.texels.data(), pixels.get(), 4 * texture.texels.size());
    return texture;
}

std::optional<TextureMap> Pictures::map(const Node& owner, std::string_view key)
{
    const auto info = owner.find(key);
    if (!info) { return std::nullopt; }
    const Node index = info->at("index");
    const Node texture = file_->element("textures", info->count("index", 0), index.where());

    TextureMap map;
    std::uint64_t set = info->count("texCoord", 0);
    if (const auto transform = info->extension("KHR_texture_transform")) {
        map.transform = transform_of(*transform);
        set = transform->count("texCoord", set);
    }
    if (set > 1) {
        notes_->add("textures on TEXCOORD_2 and beyond are passed over");
        return std::nullopt;
    }
    map.uv_set = static_cast<std::uint8_t>(set);
    if (const auto sampler = texture.index("sampler")) {
        const Node node = file_->element("samplers", *sampler, texture.where() + "/sampler");
        map.wrap_u = wrap_of(node, "wrapS");
        map.wrap_v = wrap_of(node, "wrapT");
        map.nearest = is_nearest(node);
    }
    // WebP and KTX2 (EXT_texture_webp, KHR_texture_basisu) stand beside a PNG or JPEG, or alone.
    const auto source = texture.index("source");
    if (!source) {
        notes_->add("textures without a PNG or JPEG source are passed over");
        return std::nullopt;
    }
    map.texture = decoded(*source, texture.where() + "/source");
    return map;
}

std::uint32_t Pictures::decoded(std::uint64_t image, std::string_view asked_at)
{
    const auto next = static_cast<std::uint32_t>(decoded_.size());
    const auto [known, is_new] = index_of_image_.try_emplace(image, next);
    if (is_new) {
        const Node node = file_->element("images", image, asked_at);
        const auto bytes = file_->bytes_of_image(node);
        decoded_.push_back(
            decode_picture(bytes, node.where(), std::min(most_pixels_, left_), *notes_));
        left_ -= decoded_.back().texels.size();
    }
    return known->second;
}

}  // namespace relight::gltf
