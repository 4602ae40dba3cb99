#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/result.h"
#include "core/io/readers.h"
#include "core/io/text_scanner.h"

namespace relight::off {

/// Walks the records of an OFF file: one a line; '#' at the start of a word begins a comment, which
/// ends with its line.
class Words {
  public:
    explicit Words(std::span<const std::byte> file) : scanner_(file), line_(scanner_.line()) {}

    std::uint64_t line() const { return line_; }  ///< of the record at hand
    std::size_t remaining() const { return scanner_.remaining(); }

    /// The next word on this line, empty at its end or from a comment on.
    std::string_view word()
    {
        const std::string_view next = scanner_.word();
        if (!next.starts_with('#')) { return next; }
        scanner_.rest_of_line();
        return {};
    }

    /// The first word of the next line that says something; empty at the end of the file.
    std::string_view next_record()
    {
        for (;;) {
            scanner_.next_line();
            line_ = scanner_.line();
            const std::string_view first = word();
            if (!first.empty() || scanner_.at_end()) { return first; }
        }
    }

    void rest_of_line() { scanner_.rest_of_line(); }

    Error error(Fault fault, std::string detail) const
    {
        return {fault, std::move(detail), {}, line_, {}};
    }

  private:
    TextScanner scanner_;
    std::uint64_t line_;
};

/// What each vertex has, beside x y z, and how many vertices and faces are announced.
struct Header {
    bool uvs = false, colors = false, normals = false;
    std::uint64_t vertices = 0, faces = 0;

    /// Numbers of a vertex, but for its colour.
    std::size_t fixed() const { return 3U + (normals ? 3U : 0U) + (uvs ? 2U : 0U); }
    std::string shown() const
    {
        return std::string("x y z") + (normals ? " nx ny nz" : "") + (colors ? " r g b [a]" : "") +
               (uvs ? " s t" : "");
    }
};

/// [ST][C][N]OFF in any order, then the counts, which the bytes that follow can hold. Errors:
/// MalformedHeader, CountExceedsFile, NoGeometry, TooManyVertices, TooManyFaces.
Result<Header> read_header(Words& words, const ReadLimits& limits);

}  // namespace relight::off
