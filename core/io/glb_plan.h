#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/io/glb_parts.h"

namespace relight::glb {

/// The file's JSON and its buffer, laid out before a byte of the buffer is written.
class Plan {
  public:
    /// An accessor with a view of its own: `array` is its count * components numbers, `more` the
    /// rest of its JSON. Returns its index.
    std::size_t add(Target target, ComponentType type, int components, std::size_t count,
                    Piece array, const std::string& more = {})
    {
        if (accessors_count_ > 0) {
            views_ += ',';
            accessors_ += ',';
        }
        views_ += R"({"buffer":0,"byteOffset":)" + std::to_string(size_) + R"(,"byteLength":)" +
                  std::to_string(array.bytes) + R"(,"target":)" + std::to_string(target) + '}';
        accessors_ += R"({"bufferView":)" + std::to_string(accessors_count_) +
                      R"(,"componentType":)" + std::to_string(type) + R"(,"count":)" +
                      std::to_string(count) + R"(,"type":")" + std::string(type_name(components)) +
                      '"' + more + '}';
        Piece padding = padding_behind(array.bytes);
        size_ += array.bytes + padding.bytes;
        pieces_.push_back(std::move(array));
        pieces_.push_back(std::move(padding));
        return accessors_count_++;
    }

    /// The GLB with this JSON beside the buffer's; no bytes if it would be too large for one.
    Encoding encoded(const std::string& json) &&
    {
        std::string head =
            begun(json + R"(,"accessors":[)" + accessors_ + R"(],"bufferViews":[)" + views_ +
                      R"(],"buffers":[{"byteLength":)" + std::to_string(size_) + "}]}",
                  size_);
        if (head.empty()) { return sent_whole({}); }
        pieces_.insert(pieces_.begin(), text_piece(std::move(head)));
        return joined(std::move(pieces_));
    }

  private:
    std::string views_, accessors_;
    std::size_t accessors_count_ = 0;
    std::vector<Piece> pieces_;
    std::uint64_t size_ = 0;
};

}  // namespace relight::glb
