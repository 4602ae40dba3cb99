// The container: a GLB's chunks, or a .gltf's text.
#include "server/import/gltf_bytes.h"

namespace relight::gltf {
namespace {

constexpr std::uint64_t deepest_json = 64;

/// What it says, and where in the file [bytes].
[[noreturn]] void refuse_bytes(Fault fault, std::uint64_t at, std::string_view what)
{
    throw Refusal{
        Error{fault, "byte " + std::to_string(at) + ": " + std::string(what), {}, {}, at}};
}

struct Parts {
    std::string_view json;
    std::optional<std::span<const std::byte>> binary;
};

std::string_view as_text(std::span<const std::byte> bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A GLB: 12 bytes of header, then chunks: length, type, data.   glTF 2.0, chapter 4
Parts split_glb(std::span<const std::byte> file)
{
    constexpr std::size_t header = 12, chunk_header = 8;
    constexpr std::uint32_t json_type = 0x4E4F534A, bin_type = 0x004E4942;
    if (file.size() < header + chunk_header) {
        refuse_bytes(Fault::Truncated, file.size(), "the GLB ends within its header");
    }
    const auto version = number_at<std::uint32_t>(file, 4);
    const auto length = number_at<std::uint32_t>(file, 8);
    if (version != 2) {
        refuse_bytes(Fault::MalformedHeader, 4,
                     "the GLB is of version " + std::to_string(version) +
                         "; version 2 is read: export it as glTF 2.0");
    }
    if (length != file.size()) {
        refuse_bytes(length > file.size() ? Fault::Truncated : Fault::MalformedHeader, 8,
                     "the GLB says it has " + std::to_string(length) + " bytes, and has " +
                         std::to_string(file.size()));
    }
    Parts parts;
    std::size_t at = header;
    for (std::size_t chunk = 0; at < file.size(); ++chunk) {
        if (file.size() - at < chunk_header) {
            refuse_bytes(Fault::Truncated, at, "the file ends within the header of a chunk");
        }
        const auto size = number_at<std::uint32_t>(file, at);
        const auto type = number_at<std::uint32_t>(file, at + 4);
        if (size > file.size() - at - chunk_header) {
            refuse_bytes(Fault::Truncated, at,
                         "the chunk says it has " + std::to_string(size) + " bytes, and " +
                             std::to_string(file.size() - at - chunk_header) + " are left");
        }
        const auto data = file.subspan(at + chunk_header, size);
        if ((type == json_type) != (chunk == 0) || (type == bin_type && chunk != 1)) {
            refuse_bytes(Fault::MalformedHeader, at,
                         "a GLB has one JSON chunk, its first, and may have one BIN chunk, its "
                         "second");
        }
        if (type == json_type) { parts.json = as_text(data); }
        if (type == bin_type) { parts.binary = data; }
        at += chunk_header + size;
    }
    return parts;
}

/// Refuses text nested deeper than `deepest_json`, before a parser keeps a frame for each level.
void check_depth(std::string_view text)
{
    std::uint64_t depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') { ++i; }
            in_string = c != '"';
        } else if (c == '"') {
            in_string = true;
        } else if ((c == '{' || c == '[') && ++depth > deepest_json) {
            refuse(Fault::JsonTooDeep, "",
                   "nests its JSON deeper than " + std::to_string(deepest_json));
        } else if ((c == '}' || c == ']') && depth > 0) {
            --depth;
        }
    }
}

Json parse(std::string_view text)
{
    check_depth(text);
    try {
        Json json = Json::parse(text);
        if (!json.is_object()) { refuse(Fault::MalformedHeader, "", "must be a JSON object"); }
        return json;
    } catch (const Json::parse_error& error) {
        refuse(Fault::MalformedHeader, "",
               "holds JSON that breaks off or is malformed at byte " + std::to_string(error.byte) +
                   " of it");
    } catch (const Json::exception&) {
        refuse(Fault::MalformedHeader, "", "holds a JSON number that is too large for a double");
    }
}

}  // namespace

Container open_container(std::span<const std::byte> file)
{
    if (file.empty()) { throw Refusal{Error{Fault::EmptyFile, "the file is empty", {}, {}, {}}}; }
    Container container;
    container.is_glb = as_text(file).starts_with("glTF");
    Parts parts;
    if (container.is_glb) {
        parts = split_glb(file);
    } else {
        parts.json = as_text(file);
        if (parts.json.starts_with("\xEF\xBB\xBF")) { parts.json.remove_prefix(3); }
        if (parts.json.find_first_not_of(" \t\r\n") != parts.json.find('{')) {
            refuse_bytes(Fault::MalformedHeader, 0,
                         "begins neither with \"glTF\" (a GLB) nor with \"{\" (a .gltf)");
        }
    }
    container.json = parse(parts.json);
    container.binary = parts.binary;
    return container;
}

}  // namespace relight::gltf
