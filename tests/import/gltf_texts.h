#pragma once

#include <stb/stb_image_write.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "server/import/gltf_file.h"
#include "server/import/gltf_look.h"

namespace relight::test {

using gltf::Json;

/// RFC 4648.
inline std::string base64(std::string_view bytes)
{
    constexpr std::string_view alphabet =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t at = 0; at < bytes.size(); at += 3) {
        std::uint32_t bits = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            bits = bits << 8U |
                   (at + i < bytes.size() ? static_cast<unsigned char>(bytes[at + i]) : 0U);
        }
        for (std::size_t i = 0; i < 4; ++i) {
            text += at + i > bytes.size() ? '=' : alphabet[bits >> (18 - 6 * i) & 63U];
        }
    }
    return text;
}

inline void append(void* text, void* bytes, int size)
{
    static_cast<std::string*>(text)->append(static_cast<const char*>(bytes),
                                            static_cast<std::size_t>(size));
}

/// Interleaved 8-bit channels as a PNG, or as a JPEG of the best quality.
inline std::string png(int width, int height, int channels, const std::vector<std::uint8_t>& codes)
{
    std::string file;
    stbi_write_png_to_func(append, &file, width, height, channels, codes.data(), width * channels);
    return file;
}
inline std::string jpeg(int width, int height, int channels, const std::vector<std::uint8_t>& codes)
{
    std::string file;
    stbi_write_jpg_to_func(append, &file, width, height, channels, codes.data(), 100);
    return file;
}

/// A picture of one pixel that has this grey.
inline std::string dot(std::uint8_t grey)
{
    return png(1, 1, 1, {grey});
}

inline Json image(std::string_view bytes)
{
    return {{"uri", "data:application/octet-stream;base64," + base64(bytes)}};
}

/// A glTF with these members beside the obligatory one.
inline Json gltf_with(Json members)
{
    members["asset"] = {{"version", "2.0"}};
    return members;
}

inline std::string file_bytes(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// A .gltf of tests/data/gltf, with the pictures that lie beside it put into it.
inline Json embedded_gltf(const std::string& name)
{
    const auto path = std::filesystem::path(RELIGHT_TEST_DATA) / "gltf" / name;
    Json json = Json::parse(file_bytes(path));
    for (Json& each : json["images"]) {
        each = image(file_bytes(path.parent_path() / each["uri"].get<std::string>()));
    }
    return json;
}

/// f(file), or why the file was refused.
template <class F>
auto attempt(std::string_view bytes, F&& f) -> Result<std::invoke_result_t<F, gltf::File&>>
{
    try {
        gltf::File file(std::as_bytes(std::span(bytes)));
        return f(file);
    } catch (const gltf::Refusal& refusal) {
        return refusal.error;
    }
}

inline Result<gltf::Look> look_of_bytes(std::string_view bytes, std::uint64_t most_pixels = 4096)
{
    return attempt(bytes, [&](gltf::File& file) { return gltf::read_look(file, most_pixels); });
}

inline Result<gltf::Look> look_of(const Json& gltf, std::uint64_t most_pixels = 4096)
{
    return look_of_bytes(gltf.dump(), most_pixels);
}

inline Result<Light> light_of(const Json& gltf, std::uint64_t index,
                              const std::array<double, 12>& to_world)
{
    return attempt(gltf.dump(), [&](gltf::File& file) {
        return gltf::read_light(file, index, "/nodes/7", to_world);
    });
}

/// "" if it was read.
template <class T>
std::string detail_of(const Result<T>& result)
{
    return result ? std::string() : result.error().detail;
}

}  // namespace relight::test
