#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "tests/gltf_checks.h"

/// glTF files as the server gets them.
namespace relight::test {

inline std::string contents(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline std::string base64(std::string_view bytes)
{
    constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        unsigned group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            group = group << 8U |
                    (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const bool there = i + k < bytes.size() + 1;
            text += there ? digits[group >> (18 - 6 * k) & 63U] : '=';
        }
    }
    return text;
}

/// The file as a client has to send it: a .gltf with all that it names inside.
inline std::string sent(const std::filesystem::path& path)
{
    if (path.extension() == ".glb") { return contents(path); }
    GltfJson json = GltfJson::parse(contents(path));
    for (const char* list : {"buffers", "images"}) {
        if (!json.contains(list)) { continue; }
        for (GltfJson& entry : json[list]) {
            const auto uri = entry.at("uri").get<std::string>();
            if (uri.starts_with("data:")) { continue; }
            const std::string media = uri.ends_with(".png")   ? "image/png"
                                      : uri.ends_with(".jpg") ? "image/jpeg"
                                                              : "application/octet-stream";
            entry["uri"] =
                "data:" + media + ";base64," + base64(contents(path.parent_path() / uri));
        }
    }
    return json.dump();
}

inline std::vector<std::filesystem::path> gltf_files()
{
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(
             std::filesystem::path(RELIGHT_TEST_DATA) / "gltf")) {
        const auto extension = entry.path().extension();
        if (extension == ".glb" || extension == ".gltf") { files.push_back(entry.path()); }
    }
    std::sort(files.begin(), files.end());
    return files;
}

/// GLB of this JSON and binary chunk, written without a thought for anything else.
inline std::string glb_of(const GltfJson& json, std::string binary, const std::string& rest = {})
{
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4);
    const auto u32 = [](std::size_t n) {
        const auto value = static_cast<std::uint32_t>(n);
        return std::string(reinterpret_cast<const char*>(&value), 4);
    };
    const std::string chunk = binary.empty() ? "" : u32(binary.size()) + u32(0x004E4942) + binary;
    return "glTF" + u32(2) + u32(20 + text.size() + chunk.size() + rest.size()) + u32(text.size()) +
           "JSON" + text + chunk + rest;
}

/// Keeps a file where RELIGHT_KEEP_GLB says, for tests/gltf/validate.
inline void keep(const std::string& name, std::string_view bytes)
{
    if (const char* folder = std::getenv("RELIGHT_KEEP_GLB")) {
        std::ofstream(std::filesystem::path(folder) / name, std::ios::binary) << bytes;
    }
}

}  // namespace relight::test
