#include "core/io/ply_checks.h"

#include <algorithm>

#include "core/io/text_scanner.h"

namespace relight::ply {
namespace {

/// Fewest bytes that a record can take: an ascii number a digit and a blank, a list its length, a
/// face three corners.
std::uint64_t least_bytes(const Element& element, Encoding encoding)
{
    const bool ascii = encoding == Encoding::Ascii;
    std::uint64_t bytes = 0;
    for (const Property& property : element.properties) {
        bytes += ascii ? 2 : size_of(property.count.value_or(property.type));
        const bool corners = property.name == "vertex_indices" || property.name == "vertex_index";
        if (element.name == "face" && property.count && corners) {
            bytes += 3 * (ascii ? 2 : size_of(property.type));
        }
    }
    return bytes;
}

}  // namespace

Result<Done> check_counts(const Header& header, std::size_t file_size, const ReadLimits& limits)
{
    const bool ascii = header.encoding == Encoding::Ascii;
    const auto refuse = [&](Fault fault, std::string detail) {
        Error error{fault, std::move(detail), {}, {}, {}};
        (ascii ? error.line : error.byte) = ascii ? header.body_line : header.body;
        return error;
    };
    // The last number of an ascii file needs no blank after it.
    const std::uint64_t body = file_size - header.body + (ascii ? 1 : 0);
    std::uint64_t remaining = body;
    for (const Element& element : header.elements) {
        const std::uint64_t least = least_bytes(element, header.encoding);
        if (least != 0 && element.count > remaining / least) {
            return refuse(Fault::CountExceedsFile,
                          "the header announces " + std::to_string(element.count) + " records of " +
                              shown(element.name) + ", at least " + std::to_string(least) +
                              " bytes each, but of the " + std::to_string(body) +
                              " bytes that follow it no more than " + std::to_string(remaining) +
                              " are left for them: the count is wrong or the file was cut short");
        }
        remaining -= element.count * least;
    }
    const auto count = [&](std::string_view name) {
        const Element* element = header.find(name);
        return element == nullptr ? 0 : element->count;
    };
    constexpr std::uint64_t most_indices = 0xffff'ffffU;  // indices are 32 bits wide
    const std::uint64_t most_vertices = std::min(limits.vertices, most_indices);
    if (count("vertex") > most_vertices) {
        return refuse(Fault::TooManyVertices, std::to_string(count("vertex")) +
                                                  " vertices; the limit is " +
                                                  std::to_string(most_vertices));
    }
    if (count("face") > limits.faces) {
        return refuse(Fault::TooManyFaces, std::to_string(count("face")) + " faces; the limit is " +
                                               std::to_string(limits.faces));
    }
    return Done{};
}

std::optional<std::string> skipped_note(const Element& element, const std::vector<bool>& used)
{
    constexpr std::size_t most_names = 8;
    std::string names;
    std::size_t skipped = 0;
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
        if (used[i]) { continue; }
        if (++skipped > most_names) { continue; }
        names += (skipped > 1 ? ", " : "") + shown(element.properties[i].name);
    }
    if (skipped == 0) { return {}; }
    if (skipped > most_names) { names += " and " + std::to_string(skipped - most_names) + " more"; }
    return "skipped properties of " + shown(element.name) + ": " + names;
}

std::vector<std::string> skipped_notes(const Header& header)
{
    std::vector<std::string> notes;
    std::size_t skipped = 0;
    for (const Element& element : header.elements) {
        if (element.name == "vertex" || element.count == 0) { continue; }
        if (element.name != "face") {
            ++skipped;
            continue;
        }
        std::vector<bool> used;
        for (const Property& property : element.properties) {
            used.push_back(property.count &&
                           (property.name == "vertex_indices" || property.name == "vertex_index" ||
                            property.name == "texcoord"));
        }
        if (auto note = skipped_note(element, used)) { notes.push_back(std::move(*note)); }
    }
    if (skipped > 0) {
        notes.push_back("skipped " + std::to_string(skipped) + " elements beside vertex and face");
    }
    return notes;
}

}  // namespace relight::ply
