#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <string>
#include <utility>

#include "core/io/point_columns.h"
#include "core/io/readers.h"
#include "core/io/row_scanner.h"
#include "core/io/text_scanner.h"
#include "core/io/utf8.h"

namespace relight {
namespace {

using Named = std::pair<std::string_view, MeshFormat>;

constexpr Named names[] = {
    {"ply", MeshFormat::Ply}, {"obj", MeshFormat::Obj}, {"off", MeshFormat::Off},
    {"stl", MeshFormat::Stl}, {"xyz", MeshFormat::Xyz}, {"txt", MeshFormat::Xyz},
    {"pts", MeshFormat::Pts}, {"pcd", MeshFormat::Pcd}, {"las", MeshFormat::Las},
    {"laz", MeshFormat::Las}};  // whose reader says what to do

// IANA has model/stl, model/obj, text/prs.wavefront-obj, application/vnd.las and vnd.laszip; the
// rest is what clients send. text/plain and text/csv leave it to the bytes.
constexpr Named media_types[] = {{"model/ply", MeshFormat::Ply},
                                 {"application/ply", MeshFormat::Ply},
                                 {"application/x-ply", MeshFormat::Ply},
                                 {"model/obj", MeshFormat::Obj},
                                 {"text/prs.wavefront-obj", MeshFormat::Obj},
                                 {"application/x-obj", MeshFormat::Obj},
                                 {"model/off", MeshFormat::Off},
                                 {"application/off", MeshFormat::Off},
                                 {"application/x-off", MeshFormat::Off},
                                 {"model/stl", MeshFormat::Stl},
                                 {"model/x.stl-ascii", MeshFormat::Stl},
                                 {"model/x.stl-binary", MeshFormat::Stl},
                                 {"application/sla", MeshFormat::Stl},
                                 {"application/vnd.ms-pki.stl", MeshFormat::Stl},
                                 {"application/vnd.las", MeshFormat::Las},
                                 {"application/x-las", MeshFormat::Las},
                                 {"application/vnd.laszip", MeshFormat::Las},
                                 {"application/x-pcd", MeshFormat::Pcd},
                                 {"application/pcd", MeshFormat::Pcd},
                                 {"application/x-pts", MeshFormat::Pts},
                                 {"application/x-xyz", MeshFormat::Xyz},
                                 {"chemical/x-xyz", MeshFormat::Xyz}};  // as systems map .xyz

constexpr std::string_view off_words[] = {"OFF",   "COFF",   "NOFF",   "CNOFF",
                                          "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
constexpr std::string_view obj_words[] = {"v", "vn", "vt", "vp", "f",      "o",
                                          "g", "s",  "l",  "p",  "mtllib", "usemtl"};

std::optional<MeshFormat> find(std::span<const Named> table, std::string_view name)
{
    const auto it =
        std::find_if(table.begin(), table.end(), [&](const Named& n) { return n.first == name; });
    if (it == table.end()) { return {}; }
    return it->second;
}

/// A binary STL is 80 bytes of anything, a count, and 50 bytes a facet: its length gives it away.
bool is_binary_stl(std::span<const std::byte> file)
{
    if (file.size() < 84) { return false; }
    std::uint32_t facets = 0;
    std::memcpy(&facets, file.data() + 80, sizeof(facets));
    return file.size() == 84 + 50 * static_cast<std::uint64_t>(facets);
}

/// First word that is not in a comment.
std::string_view first_word(std::span<const std::byte> file)
{
    TextScanner scanner(file);
    for (;; scanner.next_line()) {
        const std::string_view word = scanner.word_on_any_line();
        if (!word.starts_with('#')) { return word; }
    }
}

bool starts_with(std::span<const std::byte> file, std::string_view magic)
{
    return file.size() >= magic.size() && std::memcmp(file.data(), magic.data(), magic.size()) == 0;
}

/// Rows of numbers, perhaps under a line of names, or under the number of points.
std::optional<MeshFormat> format_of_rows(std::span<const std::byte> file)
{
    using Row = std::span<const std::string_view>;
    const auto is_point = [](Row row) {
        return row.size() >= 3 && parse_real(row[0]) && parse_real(row[1]) && parse_real(row[2]);
    };
    RowScanner rows(without_byte_order_mark(file));
    const Row first = rows.next();
    if (is_point(first)) { return MeshFormat::Xyz; }
    const bool counted = first.size() == 1 && parse_integer(first[0]);
    const bool named = first.size() >= 3 && columns_named(first);
    if ((counted || named) && is_point(rows.next())) {
        return counted ? MeshFormat::Pts : MeshFormat::Xyz;
    }
    return {};
}

}  // namespace

std::optional<MeshFormat> mesh_format_named(std::string_view name)
{
    return find(names, name);
}

std::optional<MeshFormat> mesh_format_of_media(std::string_view media)
{
    std::string type(media.substr(0, media.find_first_of("; \t")));  // without parameters
    std::transform(type.begin(), type.end(), type.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return find(media_types, type);
}

std::optional<MeshFormat> mesh_format_of_bytes(std::span<const std::byte> file)
{
    const std::string_view word = first_word(file);
    const auto is_among = [&](std::span<const std::string_view> words) {
        return std::find(words.begin(), words.end(), word) != words.end();
    };
    if (starts_with(file, "LASF")) { return MeshFormat::Las; }
    if (starts_with(file, "# .PCD") || word == "VERSION") { return MeshFormat::Pcd; }
    if (word == "ply") { return MeshFormat::Ply; }
    if (is_binary_stl(file) || word == "solid") { return MeshFormat::Stl; }
    if (is_among(off_words)) { return MeshFormat::Off; }
    if (is_among(obj_words)) { return MeshFormat::Obj; }
    return format_of_rows(file);
}

std::string_view name_of(MeshFormat format)
{
    return std::find_if(std::begin(names), std::end(names),
                        [&](const Named& n) { return n.second == format; })
        ->first;
}

Result<Mesh> read_mesh(MeshFormat format, std::span<const std::byte> file, const ReadLimits& limits,
                       Progress& progress)
{
    switch (format) {
        case MeshFormat::Ply:
            return read_ply(file, limits, progress);
        case MeshFormat::Obj:
            return read_obj(file, limits, progress);
        case MeshFormat::Off:
            return read_off(file, limits, progress);
        case MeshFormat::Xyz:
            return read_xyz(file, limits, progress);
        case MeshFormat::Pts:
            return read_pts(file, limits, progress);
        case MeshFormat::Pcd:
            return read_pcd(file, limits, progress);
        case MeshFormat::Las:
            return read_las(file, limits, progress);
        case MeshFormat::Stl:
            break;
    }
    return read_stl(file, limits, progress);
}

}  // namespace relight
