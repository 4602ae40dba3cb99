#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "server/import/gltf.h"
#include "server/import/promises.h"
#include "tests/import/gltf_texts.h"

namespace relight::test {

/// A glTF made by hand: put numbers in, name the accessors that come back.
struct GltfBuilder {
    Json json = gltf_with({{"scene", 0}, {"scenes", {{{"nodes", {0}}}}}});
    std::string binary;

    /// A view of these numbers; its index.
    template <class T>
    std::size_t view(const std::vector<T>& numbers)
    {
        binary.resize((binary.size() + 3) / 4 * 4);
        const std::size_t offset = binary.size(), bytes = numbers.size() * sizeof(T);
        binary.resize(offset + bytes);
        std::memcpy(binary.data() + offset, numbers.data(), bytes);
        json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
        return json["bufferViews"].size() - 1;
    }

    /// A tight accessor of its own view; its index.
    template <class T>
    std::size_t accessor(const std::vector<T>& numbers, const std::string& type,
                         bool normalized = false)
    {
        const std::size_t width = type == "SCALAR" ? 1
                                  : type == "MAT4" ? 16
                                                   : static_cast<std::size_t>(type.back() - '0');
        json["accessors"].push_back({{"bufferView", view(numbers)},
                                     {"componentType", component_type<T>()},
                                     {"count", numbers.size() / width},
                                     {"type", type}});
        if (normalized) { json["accessors"].back()["normalized"] = true; }
        return json["accessors"].size() - 1;
    }

    /// A mesh of one primitive; its index.
    std::size_t mesh(Json primitive)
    {
        json["meshes"].push_back({{"primitives", Json::array({std::move(primitive)})}});
        return json["meshes"].size() - 1;
    }

    /// The .gltf, its bytes in a data: URI.
    std::string text() const
    {
        Json whole = json;
        whole["buffers"] =
            Json::array({{{"byteLength", binary.size()},
                          {"uri", "data:application/octet-stream;base64," + base64(binary)}}});
        return whole.dump();
    }

    std::string glb() const
    {
        Json whole = json;
        whole["buffers"] = Json::array({{{"byteLength", binary.size()}}});
        return glb_of(whole.dump(), binary);
    }

    static std::string glb_of(std::string text, std::string bytes)
    {
        text.resize((text.size() + 3) / 4 * 4, ' ');
        bytes.resize((bytes.size() + 3) / 4 * 4);
        const auto word = [](std::size_t value) {
            const auto little = static_cast<std::uint32_t>(value);
            std::string four(4, '\0');
            std::memcpy(four.data(), &little, 4);
            return four;
        };
        return "glTF" + word(2) + word(28 + text.size() + bytes.size()) + word(text.size()) +
               "JSON" + text + word(bytes.size()) + std::string("BIN\0", 4) + bytes;
    }

  private:
    template <class T>
    static int component_type()
    {
        if constexpr (std::is_same_v<T, float>) { return 5126; }
        if constexpr (std::is_same_v<T, std::int8_t>) { return 5120; }
        if constexpr (std::is_same_v<T, std::uint8_t>) { return 5121; }
        if constexpr (std::is_same_v<T, std::int16_t>) { return 5122; }
        if constexpr (std::is_same_v<T, std::uint16_t>) { return 5123; }
        if constexpr (std::is_same_v<T, std::uint32_t>) { return 5125; }
    }
};

/// Corners of the triangle (0,0,0) (1,0,0) (0,1,0), whose normal is +z.
inline const std::vector<float> triangle{0, 0, 0, 1, 0, 0, 0, 1, 0};

/// A file of one node 0 that shows a mesh of one primitive, the triangle.
inline GltfBuilder one_triangle()
{
    GltfBuilder gltf;
    gltf.mesh({{"attributes", {{"POSITION", gltf.accessor(triangle, "VEC3")}}}});
    gltf.json["nodes"] = Json::array({{{"mesh", 0}}});
    return gltf;
}

inline Result<Asset> decode(std::string_view bytes, const GltfLimits& limits = {})
{
    return decode_gltf(std::as_bytes(std::span(bytes)), limits);
}
inline Result<Asset> decode(const GltfBuilder& gltf, const GltfLimits& limits = {})
{
    return decode(gltf.text(), limits);
}

/// A .gltf of tests/data/gltf with all that lies beside it put into it.
inline std::string whole_gltf(const std::string& name)
{
    const auto path = std::filesystem::path(RELIGHT_TEST_DATA) / "gltf" / name;
    Json json = embedded_gltf(name);
    for (Json& buffer : json["buffers"]) {
        const std::string uri = buffer["uri"];
        if (!uri.starts_with("data:")) {
            buffer["uri"] = image(file_bytes(path.parent_path() / uri))["uri"];
        }
    }
    return json.dump();
}

}  // namespace relight::test
