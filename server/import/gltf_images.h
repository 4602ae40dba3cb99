#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/texture/texture.h"
#include "server/import/gltf_file.h"

namespace relight::gltf {

/// What is passed over, each thing said once however often it comes.
class Notes {
  public:
    void add(std::string_view text);
    std::vector<std::string> take() { return std::move(lines_); }

  private:
    std::vector<std::string> lines_;
};

/// The picture that these bytes are, PNG or JPEG by their first ones. Its size is checked before it
/// is decoded: at most `most_pixels`. 16-bit PNG loses its lower bytes (noted).
/// Errors, at `where`: NotAvailable (another format), MalformedBody, OutOfRange. Throws
/// std::bad_alloc.
Texture decode_picture(std::span<const std::byte> bytes, std::string_view where,
                       std::uint64_t most_pixels, Notes& notes);

/// The file's textures, each picture decoded when it is first asked for, and only once.
class Pictures {
  public:
    /// All of them together may have four times `most_pixels`.
    Pictures(File& file, std::uint64_t most_pixels, Notes& notes)
        : file_(&file), most_pixels_(most_pixels), left_(4 * most_pixels), notes_(&notes)
    {
    }

    /// How the texture lies that `owner`'s member `key` (a textureInfo) names; nothing if there is
    /// no such member, or a texture that we cannot show (noted).
    std::optional<TextureMap> map(const Node& owner, std::string_view key);

    std::vector<Texture> take() { return std::move(decoded_); }

  private:
    /// Into the decoded ones, of /images/`image`.
    std::uint32_t decoded(std::uint64_t image, std::string_view asked_at);

    File* file_;
    std::uint64_t most_pixels_, left_;
    Notes* notes_;
    std::vector<Texture> decoded_;
    std::unordered_map<std::uint64_t, std::uint32_t> index_of_image_;
};

}  // namespace relight::gltf
