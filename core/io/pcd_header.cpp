#include "core/io/pcd_header.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/io/coordinate.h"
#include "core/io/text_scanner.h"

namespace relight::pcd {
namespace {

enum Key { Version, Fields, Size, Type, Count, Width, Height, Viewpoint, Points, Data };
constexpr std::array<std::string_view, 10> keys = {
    "VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};

using Failure = std::optional<Error>;

/// The lines of the header, each cut into words.
struct Lines {
    std::array<std::vector<std::string_view>, keys.size()> words;
    std::array<std::uint64_t, keys.size()> line{};  // 0: not there

    bool has(Key key) const { return line[key] != 0; }
    Error refuse(Key key, std::string detail, Fault fault = Fault::MalformedHeader) const
    {
        return {fault, std::string(keys[key]) + ": " + std::move(detail), {}, line[key], {}};
    }
};

Result<Lines> split(TextScanner& scanner)
{
    Lines lines;
    while (!lines.has(Data)) {
        const std::string_view word = scanner.word_on_any_line();
        if (word.empty()) {
            return scanner.error(Fault::MalformedHeader,
                                 "a PCD file needs a header that ends with DATA ascii, binary or "
                                 "binary_compressed; there is no such line");
        }
        const auto key = std::find(keys.begin(), keys.end(), word);
        if (key == keys.end() && !word.starts_with('#')) {
            return scanner.error(
                Fault::MalformedHeader,
                shown(word) +
                    " begins no line of a PCD header (VERSION, FIELDS, SIZE, TYPE, "
                    "COUNT, WIDTH, HEIGHT, VIEWPOINT, POINTS, DATA)");
        }
        if (key != keys.end()) {
            const auto at = static_cast<std::size_t>(key - keys.begin());
            if (lines.line[at] != 0) {
                return scanner.error(Fault::MalformedHeader, "a second line " + std::string(word));
            }
            lines.line[at] = scanner.line();
            while (!scanner.at_line_end()) { lines.words[at].push_back(scanner.word()); }
        }
        scanner.next_line();
    }
    for (const Key key : {Version, Fields, Size, Type, Width, Height}) {
        if (!lines.has(key)) {
            return lines.refuse(Data, "comes before any line " + std::string(keys[key]));
        }
    }
    for (const Key key : {Version, Width, Height, Points, Data}) {
        if (lines.has(key) && lines.words[key].size() != 1) {
            return lines.refuse(
                key, "expected one word, found " + std::to_string(lines.words[key].size()));
        }
    }
    return lines;
}

/// A whole number, 0 or more.
Result<std::uint64_t> whole(const Lines& lines, Key key, std::string_view word)
{
    const Number<std::int64_t> number = parse_integer(word);
    if (number.kind == NumberKind::OutOfRange && !word.starts_with('-')) {
        return lines.refuse(key, shown(word) + " is more than any file holds",
                            Fault::CountExceedsFile);
    }
    if (!number || number.value < 0) {
        return lines.refuse(key, shown(word) + " is no whole number, 0 or more");
    }
    return static_cast<std::uint64_t>(number.value);
}

Result<std::vector<Field>> fields_of(const Lines& lines)
{
    std::vector<Field> fields;
    const std::vector<std::string_view>& names = lines.words[Fields];
    for (const Key key : {Size, Type, Count}) {
        if (lines.has(key) && lines.words[key].size() != names.size()) {
            return lines.refuse(key, std::to_string(lines.words[key].size()) + " entries for the " +
                                         std::to_string(names.size()) + " names of FIELDS");
        }
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string_view type = lines.words[Type][i];
        const Result<std::uint64_t> size = whole(lines, Size, lines.words[Size][i]);
        if (!size) { return size.error(); }
        if (type != "I" && type != "U" && type != "F") {
            return lines.refuse(Type, shown(type) + " is none of I, U and F");
        }
        const bool is_float = type == "F";
        if (*size != 4 && *size != 8 && (is_float || (*size != 1 && *size != 2))) {
            return lines.refuse(Size, std::to_string(*size) + " bytes for " + shown(names[i]) +
                                          (is_float ? "; F has 4 or 8" : "; I and U have 1 to 8"));
        }
        Field field{names[i], type[0], *size, 1, 0, 0};
        if (lines.has(Count)) {
            const Result<std::uint64_t> count = whole(lines, Count, lines.words[Count][i]);
            if (!count) { return count.error(); }
            constexpr std::uint64_t most = 1
                                           << 30;  // so that sums of a 1 MiB header stay in 64 bits
            if (*count < 1 || *count > most) {
                return lines.refuse(Count, shown(lines.words[Count][i]) + " numbers of " +
                                               shown(names[i]) + "; allowed are 1 to 2^30");
            }
            field.count = *count;
        }
        if (!fields.empty()) {
            const Field& before = fields.back();
            field.offset = before.offset + before.size * before.count;
            field.column = before.column + before.count;
        }
        fields.push_back(field);
    }
    if (fields.empty()) { return lines.refuse(Fields, "no names"); }
    return fields;
}

Result<std::uint64_t> points_of(const Lines& lines)
{
    const Result<std::uint64_t> width = whole(lines, Width, lines.words[Width][0]);
    if (!width) { return width.error(); }
    const Result<std::uint64_t> height = whole(lines, Height, lines.words[Height][0]);
    if (!height) { return height.error(); }
    if (*height != 0 && *width > UINT64_MAX / *height) {
        return lines.refuse(Height, "WIDTH times HEIGHT is more than any file holds",
                            Fault::CountExceedsFile);
    }
    const std::uint64_t points = *width * *height;
    if (lines.has(Points)) {
        const Result<std::uint64_t> said = whole(lines, Points, lines.words[Points][0]);
        if (!said) { return said.error(); }
        if (*said != points) {
            return lines.refuse(Points, std::to_string(*said) +
                                            " points, but WIDTH times HEIGHT is " +
                                            std::to_string(points));
        }
    }
    if (points == 0) { return lines.refuse(Width, "no points", Fault::NoGeometry); }
    return points;
}

/// tx ty tz qw qx qy qz: where the scanner stood, and how it was turned, which nothing here needs.
Result<std::optional<Point3>> viewpoint_of(const Lines& lines)
{
    if (!lines.has(Viewpoint)) { return std::optional<Point3>(); }
    std::array<double, 7> n{};
    if (lines.words[Viewpoint].size() != n.size()) {
        return lines.refuse(Viewpoint, "expected the seven numbers tx ty tz qw qx qy qz, found " +
                                           std::to_string(lines.words[Viewpoint].size()));
    }
    for (std::size_t i = 0; i < n.size(); ++i) {
        const Result<double> number = parse_coordinate(
            lines.words[Viewpoint][i], "VIEWPOINT tx ty tz qw qx qy qz", lines.line[Viewpoint]);
        if (!number) { return number.error(); }
        n[i] = *number;
    }
    return std::optional<Point3>({n[0], n[1], n[2]});
}

}  // namespace

Result<Header> read_header(std::span<const std::byte> file)
{
    TextScanner scanner(file.first(std::min(file.size(), longest_header)));
    const Result<Lines> lines = split(scanner);
    if (!lines) { return lines.error(); }
    constexpr std::array<std::string_view, 6> versions = {".5", ".6", ".7", "0.5", "0.6", "0.7"};
    const std::string_view version = lines->words[Version][0];
    if (std::find(versions.begin(), versions.end(), version) == versions.end()) {
        return lines->refuse(Version, shown(version) + " is not read; 0.5, 0.6 and 0.7 are");
    }
    Header header;
    const std::string_view data = lines->words[Data][0];
    if (data != "ascii" && data != "binary" && data != "binary_compressed") {
        return lines->refuse(Data, shown(data) + " is none of ascii, binary, binary_compressed");
    }
    header.encoding = data == "ascii"    ? Encoding::Ascii
                      : data == "binary" ? Encoding::Binary
                                         : Encoding::Compressed;
    Result<std::vector<Field>> fields = fields_of(*lines);
    if (!fields) { return fields.error(); }
    const Result<std::uint64_t> points = points_of(*lines);
    if (!points) { return points.error(); }
    const Result<std::optional<Point3>> viewpoint = viewpoint_of(*lines);
    if (!viewpoint) { return viewpoint.error(); }
    header.fields = std::move(*fields);
    header.points = *points;
    header.stride =
        header.fields.back().offset + header.fields.back().size * header.fields.back().count;
    header.columns = header.fields.back().column + header.fields.back().count;
    header.viewpoint = *viewpoint;
    header.body = scanner.offset();
    header.body_line = scanner.line();
    return header;
}

}  // namespace relight::pcd
