#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/io/photometry.h"
#include "core/io/text_scanner.h"
#include "core/io/utf8.h"

namespace relight {
namespace {

using Failure = std::optional<Error>;

constexpr std::uint64_t block = 65'536;   // numbers between two looks at Progress
constexpr double most_candela = 1e30;     // the sun has 3e27; squares of it still fit a double
constexpr char end_of_dos_file = '\x1A';  // closes files of the eighties

/// Reads LM-63: label lines, TILT, then numbers that any blanks, commas and line ends part.
class IesReader {
  public:
    IesReader(std::span<const std::byte> file, Progress& progress)
        : scanner_(file), progress_(progress)
    {
    }

    Result<IesProfile> read()
    {
        if (auto failure = tilt()) { return std::move(*failure); }
        if (auto failure = lamp()) { return std::move(*failure); }
        if (auto failure = angles(profile_.vertical_deg, "vertical")) {
            return std::move(*failure);
        }
        if (auto failure = vertical_range()) { return std::move(*failure); }
        if (auto failure = angles(profile_.horizontal_deg, "horizontal")) {
            return std::move(*failure);
        }
        if (auto failure = symmetry()) { return std::move(*failure); }
        if (auto failure = candela()) { return std::move(*failure); }
        const std::string_view rest = word();
        if (!rest.empty() && rest != std::string_view(&end_of_dos_file, 1)) {
            return error(Fault::MalformedBody,
                         shown(rest) + " follows the last candela value; the file must end there");
        }
        return std::move(profile_);
    }

  private:
    Error error(Fault fault, std::string detail) const
    {
        return scanner_.error(fault, std::move(detail));
    }

    /// The next number's text; empty at the end of the file.
    std::string_view word()
    {
        for (;;) {
            pending_.remove_prefix(std::min(pending_.find_first_not_of(','), pending_.size()));
            if (!pending_.empty()) {
                const std::string_view next = pending_.substr(0, pending_.find(','));
                pending_.remove_prefix(next.size());
                return next;
            }
            pending_ = scanner_.word_on_any_line();
            if (pending_.empty()) { return {}; }
        }
    }

    /// How many numbers can still come, at two bytes each; the last may lack its end.
    std::uint64_t most_left() const { return (scanner_.remaining() + pending_.size() + 1) / 2; }

    /// `what` says what the number is.
    Result<double> number(const char* what)
    {
        const std::string_view text = word();
        if (text.empty()) {
            return error(Fault::Truncated, "the file ends where " + std::string(what) + " belongs");
        }
        const Number<double> read = parse_real(text);
        if (read.kind == NumberKind::Malformed) {
            return error(Fault::MalformedBody,
                         shown(text) + " is no number; " + what + " belongs here");
        }
        if (!read) {
            return error(Fault::OutOfRange,
                         std::string(what) + " is " + shown(text) + "; it must be finite");
        }
        return read.value;
    }

    /// A whole number from `least` on, of values that the rest of the file can hold.
    Result<std::uint64_t> count(const char* what, std::uint64_t least)
    {
        const Result<double> read = number(what);
        if (!read) { return read.error(); }
        if (!(*read >= static_cast<double>(least)) || *read != std::floor(*read)) {
            return error(Fault::MalformedBody, std::string(what) + " must be a whole number, " +
                                                   std::to_string(least) + " or more");
        }
        if (*read > static_cast<double>(most_left())) {
            return error(Fault::CountExceedsFile,
                         std::string(what) + " is more than the " +
                             std::to_string(scanner_.remaining()) +
                             " bytes that follow can hold, at two bytes a value");
        }
        return static_cast<std::uint64_t>(*read);
    }

    /// Passes over the label lines (there are none, and no IESNA line, in the oldest files) to
    /// TILT.
    Failure tilt()
    {
        std::string_view value;
        for (;; scanner_.next_line()) {
            if (scanner_.at_end()) {
                return error(Fault::MalformedHeader,
                             "no line starts with 'TILT='; a photometric profile (IESNA LM-63) has "
                             "TILT=NONE or TILT=INCLUDE before its numbers");
            }
            if (scanner_.at_line_end()) { continue; }
            const std::string_view line = scanner_.rest_of_line();
            if (!line.starts_with("TILT=")) { continue; }
            value = line.substr(5, line.find_last_not_of(" \t\v\f") - 4);
            value.remove_prefix(std::min(value.find_first_not_of(" \t\v\f"), value.size()));
            break;
        }
        if (value == "NONE") { return {}; }
        if (value != "INCLUDE") {
            return error(Fault::NotAvailable,
                         "TILT is " + shown(value) +
                             ", a file of its own; send TILT=NONE, or TILT=INCLUDE and its values");
        }
        // How the output falls as the lamp is tilted: geometry, then angles and factors.
        const Result<double> geometry = number("the lamp-to-luminaire geometry of TILT");
        if (!geometry) { return geometry.error(); }
        const Result<std::uint64_t> pairs = count("the number of tilt angles", 0);
        if (!pairs) { return pairs.error(); }
        for (std::uint64_t i = 0; i < 2 * *pairs; ++i) {
            const Result<double> passed = number("an angle or a factor of TILT");
            if (!passed) { return passed.error(); }
        }
        return {};
    }

    /// The ten numbers of the lamp and luminaire, and the three of the ballast.
    Failure lamp()
    {
        for (const char* what : {"the number of lamps", "the lumens per lamp"}) {
            const Result<double> passed = number(what);
            if (!passed) { return passed.error(); }
        }
        const Result<double> multiplier = factor("the candela multiplier");
        if (!multiplier) { return multiplier.error(); }
        const Result<std::uint64_t> vertical = count("the number of vertical angles", 2);
        if (!vertical) { return vertical.error(); }
        const Result<std::uint64_t> horizontal = count("the number of horizontal angles", 1);
        if (!horizontal) { return horizontal.error(); }
        if (*horizontal > most_left() / *vertical) {
            return error(Fault::CountExceedsFile,
                         "announces " + std::to_string(*vertical) + " x " +
                             std::to_string(*horizontal) + " candela values, more than the " +
                             std::to_string(scanner_.remaining()) + " bytes that follow can hold");
        }
        const Result<double> type = number("the photometric type");
        if (!type) { return type.error(); }
        if (*type == 2.0 || *type == 3.0) {
            return error(Fault::NotAvailable, std::string("photometric type ") +
                                                  (*type == 2.0 ? "B" : "A") +
                                                  " is not read; send type C (1)");
        }
        if (*type != 1.0) {
            return error(Fault::MalformedBody, "the photometric type must be 1 (C)");
        }
        for (const char* what : {"the units type", "the width", "the length", "the height"}) {
            const Result<double> passed = number(what);
            if (!passed) { return passed.error(); }
        }
        const Result<double> ballast = factor("the ballast factor");
        if (!ballast) { return ballast.error(); }
        for (const char* what : {"the factor kept for future use", "the input watts"}) {
            const Result<double> passed = number(what);
            if (!passed) { return passed.error(); }
        }
        scale_ = *multiplier * *ballast;
        profile_.vertical_deg.resize(*vertical);
        profile_.horizontal_deg.resize(*horizontal);
        return {};
    }

    Result<double> factor(const char* what)
    {
        Result<double> read = number(what);
        if (read && !(*read >= 0.0 && *read <= most_candela)) {
            return error(Fault::OutOfRange, std::string(what) + " must be from 0 to 1e30");
        }
        return read;
    }

    /// Fills `angles`, which has its size.
    Failure angles(std::vector<double>& angles, const char* which)
    {
        for (std::size_t i = 0; i < angles.size(); ++i) {
            if (i % block == 0 && progress_.stopped()) { return stopped(); }
            const Result<double> angle = number("an angle");
            if (!angle) { return angle.error(); }
            angles[i] = *angle;
            if (i > 0 && !(angles[i] > angles[i - 1])) {
                return error(Fault::MalformedBody, std::string(which) + " angle " +
                                                       std::to_string(i + 1) +
                                                       " is not above the one before it");
            }
        }
        return {};
    }

    Failure vertical_range() const
    {
        const double first = profile_.vertical_deg.front(), last = profile_.vertical_deg.back();
        if ((first == 0.0 || first == 90.0) && (last == 90.0 || last == 180.0)) { return {}; }
        return error(Fault::OutOfRange,
                     "vertical angles must span 0 to 90, 90 to 180 or 0 to 180 degrees");
    }

    Failure symmetry() const
    {
        const double first = profile_.horizontal_deg.front(), last = profile_.horizontal_deg.back();
        const bool from_zero =
            first == 0.0 && (last == 0.0 || last == 90.0 || last == 180.0 || last == 360.0);
        if (from_zero || (first == 90.0 && last == 270.0)) { return {}; }
        return error(Fault::OutOfRange,
                     "horizontal angles must be 0 alone or span 0 to 90, 0 to 180, 0 to 360 or 90 "
                     "to 270 degrees");
    }

    Failure candela()
    {
        const std::size_t values = profile_.vertical_deg.size() * profile_.horizontal_deg.size();
        profile_.candela.reserve(values);
        for (std::size_t i = 0; i < values; ++i) {
            if (i % block == 0 && progress_.stopped()) { return stopped(); }
            const Result<double> value = number("a candela value");
            if (!value) { return value.error(); }
            const double scaled = *value * scale_;
            if (!(*value >= 0.0 && scaled <= most_candela)) {
                return error(Fault::OutOfRange,
                             "candela value " + std::to_string(i + 1) +
                                 " must be from 0 to 1e30, factors multiplied in");
            }
            profile_.candela.push_back(scaled);
        }
        return {};
    }

    Error stopped() const { return error(Fault::Cancelled, "reading was stopped"); }

    TextScanner scanner_;
    Progress& progress_;
    std::string_view pending_;  // of a word, from its next comma on
    double scale_ = 1.0;        // candela multiplier times ballast factor
    IesProfile profile_;
};

}  // namespace

Result<IesProfile> read_ies(std::span<const std::byte> file, Progress& progress)
{
    if (file.empty()) { return Error{Fault::EmptyFile, "the file has no bytes", {}, {}, {}}; }
    return IesReader(without_byte_order_mark(file), progress).read();
}

}  // namespace relight
