#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace relight::gltf {

using Json = nlohmann::json;

/// Thrown where the file is wrong; decode_gltf() turns it into its Result. (The reader walks a
/// graph: an exception says it with less than a Result at each of its steps.)
struct Refusal {
    Error error;
};

/// Refuses the file: `where` is a JSON pointer into it ("/accessors/3/count").
[[noreturn]] void refuse(Fault fault, std::string_view where, std::string_view what);

/// A client's text, fit for a message: quoted, printable ASCII, shortened.
std::string shown(std::string_view text);

/// True of the extensions that decode_gltf() names: all others are passed over, or refused where
/// the file requires them.
bool is_supported(std::string_view extension);

/// A member of the file's JSON that knows where it stands, so that whatever is wrong with it can be
/// named. All the readers refuse a value of another type or out of range.
class Node {
  public:
    Node(const Json& json, std::string where) : json_(&json), where_(std::move(where)) {}

    const std::string& where() const { return where_; }
    const Json& json() const { return *json_; }

    bool has(std::string_view key) const;
    /// A member that must be there.
    Node at(std::string_view key) const;
    /// A member that may be there.
    std::optional<Node> find(std::string_view key) const;
    /// An extension's object: find("extensions") and the name in it.
    std::optional<Node> extension(std::string_view name) const;
    /// Elements of the array member `key`; none if it is not there.
    std::vector<Node> items(std::string_view key) const;
    std::size_t size(std::string_view key) const;
    /// Element `index` of the array member `key`; refuses an index that is out of range, naming
    /// this place as the one that asks.
    Node item(std::string_view key, std::uint64_t index) const;

    std::string text(std::string_view key, std::string_view otherwise = {}) const;
    bool flag(std::string_view key, bool otherwise) const;
    /// Finite, and in [low, high].
    double number(std::string_view key, double otherwise, double low, double high) const;
    std::uint64_t count(std::string_view key, std::uint64_t otherwise) const;
    std::optional<std::uint64_t> index(std::string_view key) const;
    /// An array of them; empty if the member is not there.
    std::vector<std::uint64_t> indices(std::string_view key) const;
    /// `length` finite numbers; nothing if the member is not there.
    std::optional<std::vector<double>> numbers(std::string_view key, std::size_t length) const;

  private:
    const Json* json_;
    std::string where_;
};

/// The file taken apart: its JSON, and its buffers with every compressed view unpacked.
class File {
  public:
    explicit File(std::span<const std::byte> file);

    Node root() const { return {json_, ""}; }
    /// Element `index` of the root's array `list`, for the member at `asked_at` that names it.
    Node element(std::string_view list, std::uint64_t index, std::string_view asked_at) const;
    bool is_glb() const { return is_glb_; }

    /// The bytes of bufferViews[index], unpacked where EXT_meshopt_compression says so; and the
    /// stride they have (0: tight).
    struct View {
        std::span<const std::byte> bytes;
        std::size_t stride = 0;
    };
    /// Valid as long as this File and the bytes it was made of.
    View view(std::uint64_t index, std::string_view asked_at);

    /// The bytes of a "uri" (data: alone is allowed) or of a "bufferView": an image's.
    std::vector<std::byte> bytes_of_image(const Node& image);

  private:
    /// `length` bytes from `offset` on of the buffer that `place` (a view, or its compressed form)
    /// names.
    std::span<const std::byte> slice(const Node& place);
    std::span<const std::byte> buffer(std::uint64_t index, std::string_view asked_at);

    Json json_;
    bool is_glb_ = false;
    std::optional<std::span<const std::byte>> binary_;             ///< the GLB's BIN chunk
    std::vector<std::optional<std::vector<std::byte>>> buffers_;   ///< decoded data URIs, on demand
    std::vector<std::optional<std::vector<std::byte>>> unpacked_;  ///< meshopt views, on demand
    std::uint64_t unpacked_bytes_ = 0;
};

}  // namespace relight::gltf
