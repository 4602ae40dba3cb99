// File: the buffers and the views of a glTF.
#include "server/import/gltf_file.h"

#include <algorithm>
#include <array>
#include <utility>

#include "server/import/gltf_bytes.h"

namespace relight::gltf {
namespace {

/// glTF 2.x; and what it requires we have.
void check_version(const Node& root)
{
    const Node asset = root.at("asset");
    const std::string version = asset.text("version"), least = asset.text("minVersion", "2.0");
    if (!version.starts_with("2.") || least != "2.0") {
        refuse(Fault::MalformedHeader, asset.where(),
               "says version " + shown(version) + ", minVersion " + shown(least) +
                   "; glTF 2.0 is read");
    }
    for (const Node& required : root.items("extensionsRequired")) {
        if (!required.json().is_string()) {
            refuse(Fault::MalformedBody, required.where(), "must be a string");
        }
        const auto& name = required.json().get_ref<const std::string&>();
        if (!is_supported(name)) {
            refuse(Fault::NotAvailable, required.where(),
                   "the file requires the extension " + shown(name) +
                       ", which is not read here; export it without");
        }
    }
}

/// RFC 4648, padded, nothing between.
std::vector<std::byte> base64(std::string_view text, const std::string& where)
{
    static const auto values = [] {
        constexpr std::string_view alphabet =
            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::array<std::uint8_t, 256> table{};
        table.fill(64);
        for (std::size_t i = 0; i < alphabet.size(); ++i) {
            table[static_cast<unsigned char>(alphabet[i])] = static_cast<std::uint8_t>(i);
        }
        return table;
    }();
    std::size_t padding = 0;
    while (padding < 2 && text.ends_with('=')) {
        text.remove_suffix(1);
        ++padding;
    }
    const bool whole = (text.size() + padding) % 4 == 0;
    const bool good = std::all_of(text.begin(), text.end(), [&](char c) {
        return values[static_cast<unsigned char>(c)] < 64;
    });
    if (!whole || !good) {
        refuse(Fault::MalformedBody, where, "holds text that is not padded base64");
    }
    std::vector<std::byte> bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    unsigned held = 0;
    for (const char c : text) {
        bits = (bits << 6U) | values[static_cast<unsigned char>(c)];
        held += 6;
        if (held >= 8) {
            held -= 8;
            bytes.push_back(static_cast<std::byte>((bits >> held) & 0xFFU));
        }
    }
    return bytes;
}

std::vector<std::byte> bytes_of_uri(const Node& place)
{
    const Node uri = place.at("uri");
    if (!uri.json().is_string()) { refuse(Fault::MalformedBody, uri.where(), "must be a string"); }
    const std::string_view text = uri.json().get_ref<const std::string&>();
    if (!text.starts_with("data:")) {
        refuse(Fault::NotAvailable, uri.where(),
               "names the file " + shown(text) +
                   "; nothing outside the upload is read: send one GLB, or embed the file as a "
                   "data: URI");
    }
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos || !text.substr(0, comma).ends_with(";base64")) {
        refuse(Fault::MalformedBody, uri.where(),
               "must be data:<media type>;base64,<data>, and begins " + shown(text.substr(0, 40)));
    }
    return base64(text.substr(comma + 1), uri.where());
}

}  // namespace

bool is_supported(std::string_view extension)
{
    constexpr std::string_view names[] = {
        "KHR_draco_mesh_compression", "EXT_meshopt_compression",
        "KHR_mesh_quantization",      "EXT_mesh_gpu_instancing",
        "KHR_texture_transform",      "KHR_lights_punctual",
        "KHR_materials_clearcoat",    "KHR_materials_sheen",
        "KHR_materials_specular",     "KHR_materials_ior",
        "KHR_materials_anisotropy",   "KHR_materials_emissive_strength"};
    return std::find(std::begin(names), std::end(names), extension) != std::end(names);
}

File::File(std::span<const std::byte> file)
{
    Container container = open_container(file);
    is_glb_ = container.is_glb;
    json_ = std::move(container.json);
    binary_ = container.binary;
    check_version(root());
    buffers_.resize(root().size("buffers"));
    unpacked_.resize(root().size("bufferViews"));
}

Node File::element(std::string_view list, std::uint64_t index, std::string_view asked_at) const
{
    const std::size_t count = root().size(list);
    if (index >= count) {
        refuse(Fault::IndexOutOfRange, asked_at,
               "names element " + std::to_string(index) + " of /" + std::string(list) +
                   ", which has " + std::to_string(count));
    }
    return root().item(list, index);
}

std::span<const std::byte> File::buffer(std::uint64_t index, std::string_view asked_at)
{
    const Node node = element("buffers", index, asked_at);
    const std::uint64_t length = node.count("byteLength", 0);
    std::span<const std::byte> bytes;
    if (node.has("uri")) {
        auto& decoded = buffers_[index];
        if (!decoded) { decoded = bytes_of_uri(node); }
        bytes = *decoded;
    } else if (index == 0 && binary_) {
        bytes = *binary_;
    } else {
        // A buffer that EXT_meshopt_compression puts in the place of unpacked data has no bytes.
        refuse(Fault::NotAvailable, node.where(),
               "has no data: it needs a data: URI, or as first buffer of a GLB the BIN chunk");
    }
    if (length == 0) {
        refuse(Fault::MalformedBody, node.where() + "/byteLength", "must be 1 or more");
    }
    if (length > bytes.size()) {
        refuse(Fault::CountExceedsFile, node.where() + "/byteLength",
               "is " + std::to_string(length) + ", and the data have " +
                   std::to_string(bytes.size()) + " bytes");
    }
    return bytes.first(length);
}

std::span<const std::byte> File::slice(const Node& place)
{
    const Node asked = place.at("buffer");
    const auto bytes = buffer(place.count("buffer", 0), asked.where());
    const std::uint64_t offset = place.count("byteOffset", 0),
                        length = place.count("byteLength", 0);
    if (length == 0) {
        refuse(Fault::MalformedBody, place.where() + "/byteLength", "must be 1 or more");
    }
    if (offset > bytes.size() || length > bytes.size() - offset) {
        refuse(Fault::CountExceedsFile, place.where(),
               std::to_string(length) + " bytes from byte " + std::to_string(offset) +
                   " on are more than the buffer's " + std::to_string(bytes.size()));
    }
    return bytes.subspan(offset, length);
}

File::View File::view(std::uint64_t index, std::string_view asked_at)
{
    // Unpacked views of one compressed stretch of bytes could be without number.
    constexpr std::uint64_t most_unpacked = 1ULL << 29U;
    const Node node = element("bufferViews", index, asked_at);
    const std::uint64_t stride = node.count("byteStride", 0);
    if (node.has("byteStride") && (stride < 4 || stride > 252 || stride % 4 != 0)) {
        refuse(Fault::OutOfRange, node.where() + "/byteStride",
               "is " + std::to_string(stride) + ", and must be a multiple of 4 in [4, 252]");
    }
    const auto packed = node.extension("EXT_meshopt_compression");
    if (!packed) { return {slice(node), stride}; }
    auto& unpacked = unpacked_[index];
    if (!unpacked) {
        const PackedShape shape = packed_shape(*packed);
        if (stride != 0 && stride != shape.stride) {
            refuse(Fault::MalformedBody, packed->where() + "/byteStride",
                   "must be the view's own, " + std::to_string(stride));
        }
        const auto bytes = slice(*packed);
        check_packed(shape, bytes.size(), *packed);
        unpacked_bytes_ += shape.count * shape.stride;
        if (unpacked_bytes_ > most_unpacked) {
            refuse(Fault::OutOfRange, packed->where(),
                   "with the views before it unpacks to more than the 512 MiB that are allowed");
        }
        unpacked = unpack(shape, bytes, *packed);
    }
    return {*unpacked, stride};
}

std::vector<std::byte> File::bytes_of_image(const Node& image)
{
    if (image.has("uri") == image.has("bufferView")) {
        refuse(Fault::MalformedBody, image.where(), "needs either a uri or a bufferView");
    }
    if (image.has("uri")) { return bytes_of_uri(image); }
    const auto bytes = view(*image.index("bufferView"), image.where() + "/bufferView").bytes;
    return {bytes.begin(), bytes.end()};
}

}  // namespace relight::gltf
