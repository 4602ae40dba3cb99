#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/geometry/precision.h"
#include "core/io/coordinate.h"
#include "core/io/point_columns.h"
#include "core/io/readers.h"
#include "core/io/row_scanner.h"
#include "core/io/utf8.h"

namespace relight {
namespace {

constexpr std::size_t block = 65'536;  // rows between two looks at Progress

using Failure = std::optional<Error>;
using Row = std::span<const std::string_view>;

Error at_line(Fault fault, std::uint64_t line, std::string detail)
{
    return {fault, std::move(detail), {}, line, {}};
}

bool is_number(std::string_view field)
{
    return parse_real(field).kind != NumberKind::Malformed;
}

/// The mesh as it grows, a point a row.
class Points {
  public:
    Points(const ReadLimits& limits, Progress& progress)
        : most_(std::min<std::uint64_t>(limits.vertices, 0xFFFFFFFF)), progress_(progress)
    {
    }

    bool laid_out() const { return !columns_.slots.empty(); }
    std::size_t count() const { return mesh_.positions.size(); }

    Failure lay_out(Result<Columns> columns, std::uint64_t line)
    {
        if (!columns) {
            Error error = std::move(columns).error();
            error.line = line;
            return error;
        }
        columns_ = std::move(*columns);
        first_.kind = columns_.first;
        second_.kind = columns_.second;
        line_ = line;
        return {};
    }

    Failure add(Row row, std::uint64_t line)
    {
        if (count() % block == 0 && progress_.stopped()) {
            return Error{Fault::Cancelled, "reading was stopped", {}, {}, {}};
        }
        if (count() >= most_) {
            return at_line(Fault::TooManyVertices, line,
                           "more points than the limit of " + std::to_string(most_) +
                               "; send a thinner cloud or one in parts");
        }
        if (row.size() != columns_.slots.size()) {
            return at_line(Fault::MalformedBody, line,
                           "a row of " + std::to_string(row.size()) + " fields; line " +
                               std::to_string(line_) + " has " +
                               std::to_string(columns_.slots.size()) +
                               ", and all rows must have the same");
        }
        std::array<double, 10> n{};
        for (std::size_t i = 0; i < row.size(); ++i) {
            const std::size_t slot = columns_.slots[i];
            if (slot == Columns::anything) { continue; }
            if (row[i].empty()) {
                return at_line(Fault::MalformedBody, line,
                               "nothing stands between two separators; a number is needed there");
            }
            const Number<double> number = parse_real(row[i]);  // many: a Result each takes time
            if (!number || std::abs(number.value) > largest_coordinate) {
                return parse_coordinate(row[i], "a row of numbers", line).error();
            }
            n[slot] = number.value;
        }
        mesh_.positions.push_back({n[0], n[1], n[2]});
        if (first_.kind != TripleKind::Unused) { first_.add({n[3], n[4], n[5]}, line); }
        if (second_.kind != TripleKind::Unused) { second_.add({n[6], n[7], n[8]}, line); }
        return {};
    }

    Result<Mesh> finish(std::string_view format)
    {
        if (mesh_.positions.empty()) {
            return Error{Fault::NoGeometry, "the file has no points", {}, {}, {}};
        }
        const bool guessed = first_.kind == TripleKind::Either;
        if (Failure failure = tell_apart(first_, second_)) {
            failure->line = line_;
            return std::move(*failure);
        }
        if (guessed) {
            const bool normals = first_.kind == TripleKind::Normal;
            columns_.notes.push_back("columns without names: 4 to 6 read as " +
                                     std::string(normals ? "normals" : "colours"));
        }
        for (Triple* const triple : {&first_, &second_}) {
            if (Failure failure = triple->give_to(mesh_)) { return std::move(*failure); }
        }
        mesh_.format = format;
        mesh_.double_positions = float_loses_text(mesh_.positions);
        mesh_.notes = std::move(columns_.notes);
        return std::move(mesh_);
    }

  private:
    std::uint64_t most_;
    Progress& progress_;
    Columns columns_;
    std::uint64_t line_ = 0;  // that the columns were laid out by
    Triple first_, second_;
    Mesh mesh_;
};

/// Names in a comment right before the rows, as CloudCompare writes them, if they are that.
std::optional<Columns> columns_of_comment(std::string_view comment, std::size_t count)
{
    const std::size_t start = comment.find_first_not_of("#/");
    if (start == std::string_view::npos) { return {}; }
    comment.remove_prefix(start);
    RowScanner words(std::as_bytes(std::span(comment)));
    const Row names = words.next();
    if (names.size() != count) { return {}; }
    Result<Columns> columns = columns_named(names);
    if (!columns) { return {}; }
    return std::move(*columns);
}

/// The rows of `announced` points that follow their number.
Failure read_block(RowScanner& rows, Points& points, std::uint64_t announced)
{
    const std::uint64_t line = rows.line();
    const std::size_t left = rows.remaining() + 1;  // the last line may lack its end
    constexpr std::size_t least_row = 6;            // "0 0 0" and a line's end
    if (announced > left / least_row) {
        return at_line(Fault::CountExceedsFile, line,
                       "announces " + std::to_string(announced) + " points, more than the " +
                           std::to_string(left - 1) + " bytes that follow can hold");
    }
    for (std::uint64_t i = 0; i < announced; ++i) {
        const Row row = rows.next();
        const auto early = [&](const char* what) {
            return what + std::to_string(i) + " of the " + std::to_string(announced) +
                   " points that line " + std::to_string(line) + " announces";
        };
        if (row.empty()) {
            return at_line(Fault::Truncated, rows.line(), early("the file ends after "));
        }
        if (row.size() == 1) {
            return at_line(Fault::MalformedBody, rows.line(),
                           early("a line of one field comes after "));
        }
        if (!points.laid_out()) {
            if (Failure failure = points.lay_out(columns_numbered(row.size()), rows.line())) {
                return failure;
            }
        }
        if (Failure failure = points.add(row, rows.line())) { return failure; }
    }
    return {};
}

}  // namespace

Result<Mesh> read_xyz(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
{
    if (file.empty()) { return Error{Fault::EmptyFile, "the file has no bytes", {}, {}, {}}; }
    RowScanner rows(without_byte_order_mark(file));
    Points points(limits, progress);
    for (Row row = rows.next(); !row.empty(); row = rows.next()) {
        if (!points.laid_out()) {
            const bool named = !row.front().empty() && !is_number(row.front());
            auto told = columns_of_comment(rows.comment(), row.size());
            Result<Columns> columns = named  ? columns_named(row)
                                      : told ? std::move(*told)
                                             : columns_numbered(row.size());
            if (Failure failure = points.lay_out(std::move(columns), rows.line())) {
                return std::move(*failure);
            }
            if (named) { continue; }
        }
        if (Failure failure = points.add(row, rows.line())) { return std::move(*failure); }
    }
    return points.finish("xyz");
}

Result<Mesh> read_pts(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
{
    if (file.empty()) { return Error{Fault::EmptyFile, "the file has no bytes", {}, {}, {}}; }
    RowScanner rows(without_byte_order_mark(file));
    Points points(limits, progress);
    for (Row row = rows.next(); !row.empty(); row = rows.next()) {
        const Number<std::int64_t> count = parse_integer(row.front());
        if (row.size() != 1 || count.kind == NumberKind::Malformed || count.value < 0) {
            const bool begins = !points.laid_out();
            return at_line(begins ? Fault::MalformedHeader : Fault::MalformedBody, rows.line(),
                           "expected the number of points, alone on its line, before " +
                               std::string(begins ? "the rows (rows alone are format xyz)"
                                                  : "more rows than were announced"));
        }
        // A number that no integer holds is more than any file does.
        const auto announced = count ? static_cast<std::uint64_t>(count.value) : UINT64_MAX;
        if (Failure failure = read_block(rows, points, announced)) { return std::move(*failure); }
    }
    return points.finish("pts");
}

}  // namespace relight
