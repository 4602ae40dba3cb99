#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

/// A strict reader of GLB, for what the tests get back: it takes nothing on trust, says what breaks
/// the glTF 2.0 specification, and decodes nothing that is compressed. (Khronos's own validator is
/// asked by tests/gltf/validate.)
namespace relight::test {

using GltfJson = nlohmann::json;

struct Glb {
    GltfJson json;
    std::string binary, rest;         ///< the BIN chunk's data; chunks behind it
    std::vector<std::string> faults;  ///< of the container, and of what check() found
};

inline std::uint32_t u32_of(std::string_view bytes, std::size_t at)
{
    std::uint32_t value = 0;
    if (at + 4 <= bytes.size()) { std::memcpy(&value, bytes.data() + at, 4); }
    return value;
}

/// GLB chunk by chunk: lengths add up, are multiples of 4, JSON comes first and is JSON.
inline Glb opened_glb(std::string_view file)
{
    Glb glb;
    const auto fault = [&](const std::string& what) { glb.faults.push_back("container: " + what); };
    if (!file.starts_with("glTF")) { fault("no magic"); }
    if (u32_of(file, 4) != 2) { fault("version"); }
    if (u32_of(file, 8) != file.size()) { fault("length"); }
    std::size_t chunk = 0;
    for (std::size_t at = 12; at < file.size(); ++chunk) {
        const std::size_t length = u32_of(file, at);
        const std::string_view type = file.substr(std::min(at + 4, file.size()), 4);
        if (at + 8 + length > file.size()) {
            fault("chunk beyond the file");
            return glb;
        }
        if (length % 4 != 0) { fault("chunk of " + std::to_string(length) + " bytes"); }
        const std::string_view data = file.substr(at + 8, length);
        if ((chunk == 0) != (type == "JSON")) { fault("JSON is not the first chunk"); }
        if (chunk == 0) { glb.json = GltfJson::parse(data, nullptr, false); }
        if (chunk == 1 && u32_of(type, 0) == 0x004E4942) {
            glb.binary = data;
        } else if (chunk > 0) {
            glb.rest = file.substr(at);
            break;
        }
        at += 8 + length;
    }
    if (!glb.json.is_object()) { fault("no JSON"); }
    return glb;
}

inline std::size_t components_of(const GltfJson& accessor)
{
    static const std::map<std::string, std::size_t> counts{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3},
                                                           {"VEC4", 4},   {"MAT2", 4}, {"MAT3", 9},
                                                           {"MAT4", 16}};
    const auto found = counts.find(accessor.value("type", ""));
    return found == counts.end() ? 0 : found->second;
}

inline std::size_t component_size(const GltfJson& accessor)
{
    switch (accessor.value("componentType", 0)) {
        case 5120:
        case 5121:
            return 1;
        case 5122:
        case 5123:
            return 2;
        case 5125:
        case 5126:
            return 4;
        default:
            return 0;
    }
}

/// True if this accessor's numbers lie in the binary chunk as they are.
inline bool is_plain(const Glb& glb, const GltfJson& accessor)
{
    if (!accessor.contains("bufferView") || accessor.contains("sparse")) { return false; }
    const GltfJson& view = glb.json["bufferViews"].at(accessor["bufferView"].get<std::size_t>());
    const GltfJson& buffer = glb.json["buffers"].at(view.at("buffer").get<std::size_t>());
    return view.at("buffer") == 0 && !buffer.contains("uri") && !view.contains("extensions");
}

/// The numbers of a plain accessor, as filed; fewer if it runs beyond the chunk.
inline std::vector<double> numbers_of(const Glb& glb, std::size_t index)
{
    const GltfJson& accessor = glb.json["accessors"].at(index);
    const GltfJson& view = glb.json["bufferViews"].at(accessor.at("bufferView").get<std::size_t>());
    const std::size_t components = components_of(accessor), size = component_size(accessor);
    const std::size_t stride = view.value("byteStride", components * size);
    const std::size_t first = view.value("byteOffset", 0U) + accessor.value("byteOffset", 0U);
    const auto count = accessor.at("count").get<std::size_t>();
    const int type = accessor.at("componentType");
    std::vector<double> numbers;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < components; ++k) {
            const std::size_t at = first + i * stride + k * size;
            if (at + size > glb.binary.size()) { return numbers; }
            const auto as = [&](auto number) {
                std::memcpy(&number, glb.binary.data() + at, sizeof(number));
                return static_cast<double>(number);
            };
            switch (type) {
                case 5120:
                    numbers.push_back(as(std::int8_t{}));
                    break;
                case 5121:
                    numbers.push_back(as(std::uint8_t{}));
                    break;
                case 5122:
                    numbers.push_back(as(std::int16_t{}));
                    break;
                case 5123:
                    numbers.push_back(as(std::uint16_t{}));
                    break;
                case 5125:
                    numbers.push_back(as(std::uint32_t{}));
                    break;
                default:
                    numbers.push_back(as(0.0F));
            }
        }
    }
    return numbers;
}

/// Looks at everything an answer of ours has to get right, into `faults`.
class GltfCheck {
  public:
    explicit GltfCheck(Glb& glb) : glb_(glb), json_(glb.json) {}

    void run()
    {
        if (json_.at("asset").at("version") != "2.0") { fault("asset", "version"); }
        buffers();
        each("accessors", [this](const GltfJson& a, const std::string& at) { accessor(a, at); });
        each("meshes", [this](const GltfJson& mesh, const std::string& at) {
            for (const GltfJson& p : mesh.at("primitives")) { primitive(p, at); }
            if (mesh.at("primitives").empty()) { fault(at, "no primitives"); }
        });
        nodes();
        extensions();
        no_empty(json_, "");
    }

  private:
    void fault(const std::string& where, const std::string& what)
    {
        glb_.faults.push_back(where + ": " + what);
    }
    std::size_t size(const char* key) const { return json_.contains(key) ? json_[key].size() : 0; }
    template <class Visit>
    void each(const char* key, Visit visit)
    {
        for (std::size_t i = 0; i < size(key); ++i) {
            visit(json_[key][i], key + ("/" + std::to_string(i)));
        }
    }
    /// The element that a member names; nothing if it names none.
    const GltfJson* named(const GltfJson& from, const char* member, const char* list,
                          const std::string& at)
    {
        if (!from.contains(member)) { return nullptr; }
        if (from[member].is_number_unsigned() && from[member] < size(list)) {
            return &json_[list][from[member].get<std::size_t>()];
        }
        fault(at, std::string(member) + " names nothing");
        return nullptr;
    }

    void buffers()
    {
        each("buffers", [this](const GltfJson& buffer, const std::string& at) {
            const auto length = buffer.at("byteLength").get<std::size_t>();
            if (length == 0) { fault(at, "empty"); }
            const bool stored = at == "buffers/0" && !buffer.contains("uri");
            const bool fallback = buffer.contains("extensions");
            if (!stored && !buffer.contains("uri") && !fallback) { fault(at, "is nowhere"); }
            if (stored && !fallback &&
                (length > glb_.binary.size() || glb_.binary.size() > length + 3)) {
                fault(at, "is not the binary chunk");
            }
        });
        each("bufferViews", [this](const GltfJson& view, const std::string& at) {
            const GltfJson* buffer = named(view, "buffer", "buffers", at);
            const std::size_t end =
                view.value("byteOffset", 0U) + view.at("byteLength").get<std::size_t>();
            if (buffer != nullptr && end > buffer->at("byteLength")) { fault(at, "too long"); }
            if (view.at("byteLength") == 0) { fault(at, "empty"); }
            const std::size_t stride = view.value("byteStride", 4U);
            if (stride % 4 != 0 || stride > 252) { fault(at, "stride"); }
            if (view.contains("byteStride") && view.value("target", 34962) != 34962) {
                fault(at, "stride of indices");
            }
        });
    }

    void accessor(const GltfJson& accessor, const std::string& at)
    {
        const std::size_t size = component_size(accessor), components = components_of(accessor);
        const auto count = accessor.at("count").get<std::size_t>();
        if (size == 0 || components == 0 || count == 0) { return fault(at, "of what?"); }
        const GltfJson* view = named(accessor, "bufferView", "bufferViews", at);
        if (view == nullptr) { return; }
        const std::size_t offset = accessor.value("byteOffset", 0U);
        const std::size_t stride = view->value("byteStride", size * components);
        if (offset % size != 0 || (view->value("byteOffset", 0U) + offset) % size != 0) {
            fault(at, "not aligned");
        }
        if (offset + stride * (count - 1) + size * components > view->at("byteLength")) {
            return fault(at, "beyond its view");
        }
        if (!is_plain(glb_, accessor)) { return; }
        const std::vector<double> numbers =
            numbers_of(glb_, static_cast<std::size_t>(&accessor - &json_["accessors"][0]));
        for (const double x : numbers) {
            if (!std::isfinite(x)) { return fault(at, "not finite"); }
        }
        for (std::size_t k = 0; k < components && accessor.contains("min"); ++k) {
            double low = numbers[k], high = numbers[k];
            for (std::size_t i = k; i < numbers.size(); i += components) {
                low = std::min(low, numbers[i]);
                high = std::max(high, numbers[i]);
            }
            if (accessor["min"].at(k) != low || accessor["max"].at(k) != high) {
                fault(at, "min, max");
            }
        }
    }

    void primitive(const GltfJson& primitive, const std::string& at)
    {
        const GltfJson& attributes = primitive.at("attributes");
        std::map<std::string, std::size_t> vertices_of_view;
        std::size_t vertices = 0;
        for (const auto& [name, index] : attributes.items()) {
            const GltfJson* a = named(attributes, name.c_str(), "accessors", at);
            if (a == nullptr) { continue; }
            if (vertices == 0) { vertices = a->at("count"); }
            if (a->at("count") != vertices) { fault(at, name + " of another count"); }
            const bool known = name == "POSITION" || name == "NORMAL" || name == "TANGENT" ||
                               name.starts_with("TEXCOORD_") || name.starts_with("COLOR_") ||
                               name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_");
            if (!known && !name.starts_with("_")) { fault(at, "attribute " + name); }
            if (name == "POSITION" && !a->contains("min")) { fault(at, "no bounds"); }
            if (const GltfJson* view = named(*a, "bufferView", "bufferViews", at)) {
                if (view->value("target", 34962) != 34962) { fault(at, name + "'s target"); }
                if (view->value("byteOffset", 0U) % 4 != 0) { fault(at, name + " not aligned"); }
            }
            if (name.starts_with("COLOR_") && is_plain(glb_, *a) &&
                a->at("componentType") == 5126) {
                for (const double x : numbers_of(glb_, index.get<std::size_t>())) {
                    if (x < 0.0 || x > 1.0) { return fault(at, name + " beyond 0..1"); }
                }
            }
            if (name == "NORMAL" && is_plain(glb_, *a) && a->at("componentType") == 5126) {
                const std::vector<double> n = numbers_of(glb_, index.get<std::size_t>());
                for (std::size_t i = 0; i < n.size(); i += 3) {
                    if (std::abs(std::hypot(n[i], n[i + 1], n[i + 2]) - 1.0) > 5e-4) {
                        return fault(at, "a NORMAL is not unit");
                    }
                }
            }
        }
        named(primitive, "material", "materials", at);
        const GltfJson* indices = named(primitive, "indices", "accessors", at);
        if (indices == nullptr) { return; }
        const int type = indices->at("componentType");
        if (indices->at("type") != "SCALAR" || (type != 5121 && type != 5123 && type != 5125)) {
            fault(at, "indices of another type");
        }
        if (!is_plain(glb_, *indices)) { return; }
        const double restart = type == 5121 ? 255.0 : type == 5123 ? 65535.0 : 4294967295.0;
        for (const double i : numbers_of(glb_, primitive["indices"].get<std::size_t>())) {
            if (i >= static_cast<double>(vertices) || i == restart) {
                return fault(at, "index " + std::to_string(i));
            }
        }
    }

    void nodes()
    {
        std::set<std::size_t> children;
        each("nodes", [&](const GltfJson& node, const std::string& at) {
            named(node, "mesh", "meshes", at);
            named(node, "skin", "skins", at);
            named(node, "camera", "cameras", at);
            if (node.contains("skin") && !node.contains("mesh")) { fault(at, "skin of nothing"); }
            if (node.contains("rotation")) {
                double squared = 0.0;
                for (const double x : node["rotation"]) { squared += x * x; }
                if (std::abs(squared - 1.0) > 5e-4) { fault(at, "rotation is not unit"); }
            }
            if (!node.contains("children")) { return; }
            for (const std::size_t child : node["children"]) {
                if (child >= size("nodes")) { fault(at, "child is nowhere"); }
                if (!children.insert(child).second) { fault(at, "child of two"); }
            }
        });
        each("scenes", [&](const GltfJson& scene, const std::string& at) {
            if (!scene.contains("nodes")) { return; }
            for (const std::size_t root : scene["nodes"]) {
                if (root >= size("nodes")) { fault(at, "root is nowhere"); }
                if (children.contains(root)) { fault(at, "root is a child"); }
            }
        });
    }

    void extensions()
    {
        std::set<std::string> used;
        const auto gather = [&](const auto& self, const GltfJson& json) -> void {
            if (json.is_object() && json.contains("extensions")) {
                for (const auto& [name, body] : json["extensions"].items()) { used.insert(name); }
            }
            for (const auto& [key, child] : json.items()) {
                if (child.is_structured() && key != "extras") { self(self, child); }
            }
        };
        gather(gather, json_);
        std::set<std::string> said;
        for (const GltfJson& name : json_.value("extensionsUsed", GltfJson::array())) {
            said.insert(name);
        }
        for (const std::string& name : used) {
            if (!said.contains(name)) { fault("extensionsUsed", "lacks " + name); }
        }
        for (const std::string name : json_.value("extensionsRequired", GltfJson::array())) {
            if (!said.contains(name)) { fault("extensionsRequired", name + " is not used"); }
        }
    }

    /// No array, and no object but of extensions and extras, is empty.
    void no_empty(const GltfJson& json, const std::string& at)
    {
        for (const auto& [key, child] : json.items()) {
            if (key == "extras" || key == "extensions" || !child.is_structured()) { continue; }
            std::string here = at;
            here.append("/").append(key);
            const bool may_be = child.is_object() && at.find('/') != std::string::npos;
            if (child.empty() && !may_be) { fault(here, "empty"); }
            no_empty(child, here);
        }
    }

    Glb& glb_;
    const GltfJson& json_;
};

/// A GLB, with all that is wrong in it.
inline Glb checked_glb(std::string_view file)
{
    Glb glb = opened_glb(file);
    if (!glb.json.is_object()) { return glb; }
    try {
        GltfCheck(glb).run();
    } catch (const GltfJson::exception& e) {
        glb.faults.emplace_back(e.what());
    }
    return glb;
}

}  // namespace relight::test
