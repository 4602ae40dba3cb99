#include "server/check_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/trace/bvh.h"
#include "server/json_text.h"

namespace relight {
namespace {

std::string number_or_null(double x)
{
    return std::isfinite(x) ? decimal(x) : "null";
}

std::string formatted(const char* format, double x)
{
    char text[32];
    std::snprintf(text, sizeof text, format, x);
    return text;
}

std::string painted(const std::string& text, std::string_view color, bool coloured)
{
    constexpr std::string_view plain = "\033[0m";
    return coloured ? std::string(color).append(text).append(plain) : text;
}

/// A case's cells: name, expected, computed, error, tolerance, unit, formula.
constexpr std::size_t columns = 7;
using Row = std::array<std::string, columns>;
constexpr std::array<bool, columns> is_number{false, true, true, true, true, false, false};
const Row titles{"", "expected", "computed", "error", "allowed", "unit", "formula"};

Row row_of(const CheckCase& c)
{
    return {c.name,
            formatted("%.9g", c.expected),
            formatted("%.9g", c.computed),
            formatted("%.1e", c.error()),
            formatted("%.1e", c.tolerance),
            c.unit,
            c.formula};
}

std::string line(const Row& row, const std::array<std::size_t, columns>& widths)
{
    std::string text;
    for (std::size_t i = 0; i < columns; ++i) {
        const std::string gap(widths[i] - row[i].size(), ' ');
        text += "  ";
        text += is_number[i] ? gap + row[i] : row[i] + gap;
    }
    return text.substr(0, text.find_last_not_of(' ') + 1);
}

}  // namespace

std::size_t failures(std::span<const CheckCase> cases)
{
    return static_cast<std::size_t>(
        std::count_if(cases.begin(), cases.end(), [](const CheckCase& c) { return !c.pass(); }));
}

std::string check_json(std::span<const CheckCase> cases, std::string_view version)
{
    std::string rows = "[";
    for (const CheckCase& c : cases) {
        rows += rows.size() == 1 ? "" : ",";
        rows += ObjectWriter()
                    .text("name", c.name)
                    .text("group", c.group)
                    .text("formula", c.formula)
                    .text("unit", c.unit)
                    .raw("expected", number_or_null(c.expected))
                    .raw("computed", number_or_null(c.computed))
                    .raw("error", number_or_null(c.error()))
                    .raw("tolerance", number_or_null(c.tolerance))
                    .text("tolerance_kind", c.tolerance_kind)
                    .flag("pass", c.pass())
                    .done();
    }
    return ObjectWriter()
        .text("version", version)
        .text("kernel", Bvh::kernel())
        .count("passed", cases.size() - failures(cases))
        .count("failed", failures(cases))
        .raw("cases", rows + "]")
        .done();
}

std::string check_table(std::span<const CheckCase> cases, std::string_view version, bool coloured)
{
    constexpr std::string_view green = "\033[32m", red = "\033[31m", bold = "\033[1m";
    std::array<std::size_t, columns> widths{};
    const auto widen = [&](const Row& row) {
        for (std::size_t i = 0; i < columns; ++i) {
            widths[i] = std::max(widths[i], row[i].size());
        }
    };
    widen(titles);
    for (const CheckCase& c : cases) { widen(row_of(c)); }
    std::string text = "    " + line(titles, widths) + '\n';
    std::string_view group;
    for (const CheckCase& c : cases) {
        if (c.group != group) { text += painted(c.group, bold, coloured) + '\n'; }
        group = c.group;
        text += c.pass() ? painted("  ok", green, coloured) : painted("FAIL", red, coloured);
        text += line(row_of(c), widths) + '\n';
    }
    const std::size_t failed = failures(cases);
    const std::string summary =
        std::to_string(cases.size() - failed) + " passed, " + std::to_string(failed) + " failed";
    text += '\n' + painted(summary, failed == 0 ? green : red, coloured);
    text.append(" (relight ").append(version).append(", ").append(Bvh::kernel()).append(")\n");
    return text;
}

}  // namespace relight
