#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/io/photometry.h"
#include "core/io/text_scanner.h"

namespace relight {
namespace {

using Failure = std::optional<Error>;
using Rgbe = std::array<unsigned char, 4>;

// Widths whose lines may be packed a channel at a time; others are texel by texel.
constexpr std::uint64_t narrowest_packed = 8, widest_packed = 0x7FFF;
constexpr std::uint64_t longest_run = 127, longest_literal = 128;
constexpr double least_exposure = 1e-30, largest_exposure = 1e30;  // product of all lines

std::string_view trimmed(std::string_view text)
{
    while (!text.empty() && TextScanner::is_blank(text.front())) { text.remove_prefix(1); }
    while (!text.empty() && TextScanner::is_blank(text.back())) { text.remove_suffix(1); }
    return text;
}

/// Reads a Radiance picture: lines of text up to a blank one, the resolution, then a scanline at a
/// time, each packed in its own way.
class HdrReader {
  public:
    HdrReader(std::span<const std::byte> file, std::uint64_t most_pixels, Progress& progress)
        : file_(file), most_pixels_(most_pixels), progress_(progress)
    {
        // A texel is mantissa / 256 * 2^(e - 128); e = 0 is black. (Radiance's own reader adds half
        // a step to the mantissa; that no other does, and it would turn a stored 1 into 1.004.)
        for (int e = 1; e < 256; ++e) {
            step_[static_cast<std::size_t>(e)] = std::ldexp(1.0, e - 128 - 8);
        }
    }

    Result<Image> read()
    {
        if (auto failure = header()) { return std::move(*failure); }
        Image image{static_cast<int>(width_), static_cast<int>(height_), {}, {}};
        // Packed lines cannot hold more than this; old runs can, and grow as they are read.
        const std::uint64_t least_packed = 4 + 8 * ((width_ + longest_run - 1) / longest_run);
        if (left() / height_ >= least_packed) { image.pixels.reserve(width_ * height_); }
        line_.resize(width_);
        for (std::uint64_t y = 0; y < height_; ++y) {
            if (progress_.stopped()) {
                return Error{Fault::Cancelled, "stopped while reading scanlines", {}, {}, at_};
            }
            if (auto failure = is_packed() ? packed_line(y) : plain_line(y)) {
                return std::move(*failure);
            }
            if (auto failure = append(image.pixels)) { return std::move(*failure); }
        }
        if (left() != 0) {
            return error(Fault::MalformedBody, std::to_string(left()) +
                                                   " bytes follow the last of " +
                                                   std::to_string(height_) + " scanlines");
        }
        return image;
    }

  private:
    Error error(Fault fault, std::string detail) const
    {
        return {fault, std::move(detail), {}, {}, at_};
    }
    std::uint64_t left() const { return file_.size() - at_; }
    unsigned char byte(std::uint64_t i) const { return std::to_integer<unsigned char>(file_[i]); }

    Failure header()
    {
        TextScanner scanner(file_);
        const std::string_view magic = scanner.rest_of_line();
        if (!magic.starts_with("#?")) {
            return scanner.error(
                Fault::MalformedHeader,
                "starts with " + shown(magic) + "; a Radiance picture starts with '#?RADIANCE'");
        }
        for (;;) {
            scanner.next_line();
            if (scanner.at_end()) {
                return scanner.error(Fault::Truncated,
                                     "the file ends within its header, before the blank line and "
                                     "the resolution, '-Y height +X width'");
            }
            const std::string_view line = scanner.rest_of_line();
            if (line.empty()) { break; }
            if (auto failure = variable(line, scanner)) { return failure; }
        }
        scanner.next_line();
        return resolution(scanner);
    }

    /// FORMAT, EXPOSURE and COLORCORR; other lines say nothing about radiance.
    Failure variable(std::string_view line, const TextScanner& scanner)
    {
        const std::size_t equals = line.find('=');
        if (equals == std::string_view::npos) { return {}; }
        const std::string_view name = line.substr(0, equals);
        const std::string_view value = trimmed(line.substr(equals + 1));
        if (name == "FORMAT") {
            if (value == "32-bit_rle_rgbe") { return {}; }
            return scanner.error(
                value == "32-bit_rle_xyze" ? Fault::NotAvailable : Fault::MalformedHeader,
                "FORMAT is " + shown(value) + "; only 32-bit_rle_rgbe is read");
        }
        if (name != "EXPOSURE" && name != "COLORCORR") { return {}; }
        const bool all_bands = name == "EXPOSURE";
        TextScanner numbers(std::as_bytes(std::span(value)));
        Number<double> factor;
        for (std::size_t band = 0; band < 3; ++band) {
            if (band == 0 || !all_bands) { factor = parse_real(numbers.word()); }
            exposure_[band] *= factor.value;
            if (!factor || !(exposure_[band] >= least_exposure) ||
                !(exposure_[band] <= largest_exposure)) {
                return scanner.error(Fault::OutOfRange,
                                     std::string(name) + " is " + shown(value) +
                                         "; each factor, and the product of all, must be from "
                                         "1e-30 to 1e30");
            }
        }
        if (!numbers.at_line_end()) {
            return scanner.error(Fault::MalformedHeader,
                                 std::string(name) + " is " + shown(value) + "; expected " +
                                     (all_bands ? "one number" : "three numbers"));
        }
        return {};
    }

    Failure resolution(TextScanner& scanner)
    {
        const std::string_view text = scanner.rest_of_line();
        TextScanner words(std::as_bytes(std::span(text)));
        const std::string_view y = words.word();
        const Number<std::int64_t> height = parse_integer(words.word());
        const std::string_view x = words.word();
        const Number<std::int64_t> width = parse_integer(words.word());
        const bool turned = (y == "+Y" || y == "-X" || y == "+X" || x == "-X") && height && width;
        if (turned) {
            return scanner.error(
                Fault::NotAvailable,
                shown(text) + " is a picture turned or mirrored; send it as '-Y height +X width'");
        }
        const auto bad = [](const Number<std::int64_t>& n) {
            return n.kind == NumberKind::Malformed || (n && n.value < 1);
        };
        if (y != "-Y" || x != "+X" || bad(height) || bad(width) || !words.at_line_end()) {
            return scanner.error(
                Fault::MalformedHeader,
                shown(text) + " is no resolution; expected '-Y height +X width', both 1 or more");
        }
        scanner.next_line();
        at_ = scanner.offset();
        const auto side = [](const Number<std::int64_t>& n) {
            return n ? static_cast<std::uint64_t>(n.value) : std::uint64_t{1} << 63U;
        };
        width_ = side(width);
        height_ = side(height);
        std::uint64_t least = 4;  // one texel, then runs: the k-th in a row counts in 256^k
        for (std::uint64_t rest = width_; rest > 1; rest = (rest + 255) / 256) { least += 4; }
        if (height_ > left() / least) {
            return scanner.error(Fault::CountExceedsFile,
                                 "announces " + shown(text) + ", more scanlines than the " +
                                     std::to_string(left()) + " bytes that follow can hold");
        }
        const auto most = std::min<std::uint64_t>(most_pixels_, std::numeric_limits<int>::max());
        if (width_ > most / height_) {
            return scanner.error(Fault::OutOfRange, "announces " + shown(text) + "; the limit is " +
                                                        std::to_string(most) + " texels");
        }
        return {};
    }

    /// True if the line that begins here is packed a channel at a time (2, 2, width in 15 bits).
    bool is_packed() const
    {
        return width_ >= narrowest_packed && width_ <= widest_packed && left() >= 4 &&
               byte(at_) == 2 && byte(at_ + 1) == 2 && byte(at_ + 2) < 128;
    }

    Error truncated(std::uint64_t y) const
    {
        return error(Fault::Truncated, "the file ends in scanline " + std::to_string(y) + " of " +
                                           std::to_string(height_));
    }

    Failure packed_line(std::uint64_t y)
    {
        const std::uint64_t width = byte(at_ + 2) * 256ULL + byte(at_ + 3);
        if (width != width_) {
            return error(Fault::MalformedBody, "scanline " + std::to_string(y) + " says it has " +
                                                   std::to_string(width) + " texels; the header, " +
                                                   std::to_string(width_));
        }
        at_ += 4;
        for (std::size_t channel = 0; channel < 4; ++channel) {
            for (std::uint64_t x = 0; x < width_;) {
                if (left() == 0) { return truncated(y); }
                const std::uint64_t code = byte(at_);
                const bool run = code > longest_literal;
                const std::uint64_t count = run ? code - longest_literal : code;
                if (count == 0 || count > width_ - x) {
                    return error(Fault::MalformedBody,
                                 "a run of " + std::to_string(count) + " at texel " +
                                     std::to_string(x) + " of scanline " + std::to_string(y) +
                                     "; from 1 to " + std::to_string(width_ - x) + " fit");
                }
                if (left() < (run ? 2 : 1 + count)) { return truncated(y); }
                for (std::uint64_t i = 0; i < count; ++i) {
                    line_[x + i][channel] = byte(at_ + 1 + (run ? 0 : i));
                }
                at_ += run ? 2 : 1 + count;
                x += count;
            }
        }
        return {};
    }

    /// Texel by texel; (1, 1, 1, n) repeats the last one n times, and a second such one n * 256.
    Failure plain_line(std::uint64_t y)
    {
        std::uint64_t unit = 1;
        for (std::uint64_t x = 0; x < width_; at_ += 4) {
            if (left() < 4) { return truncated(y); }
            const Rgbe texel{byte(at_), byte(at_ + 1), byte(at_ + 2), byte(at_ + 3)};
            if (texel[0] != 1 || texel[1] != 1 || texel[2] != 1) {
                line_[x++] = texel;
                unit = 1;
                continue;
            }
            const std::uint64_t count = texel[3] * unit;
            if (x == 0 || count > width_ - x || unit > width_) {
                return error(Fault::MalformedBody,
                             "a run of " + std::to_string(count) + " at texel " +
                                 std::to_string(x) + " of scanline " + std::to_string(y) +
                                 "; it must follow a texel and end within the " +
                                 std::to_string(width_) + " of the line");
            }
            std::fill_n(line_.begin() + static_cast<std::ptrdiff_t>(x), count, line_[x - 1]);
            x += count;
            unit *= 256;
        }
        return {};
    }

    Failure append(std::vector<Rgbf>& pixels)
    {
        for (const Rgbe& texel : line_) {
            Rgbf& out = pixels.emplace_back();
            for (std::size_t band = 0; band < 3; ++band) {
                const double value = texel[band] * step_[texel[3]] / exposure_[band];
                if (value > std::numeric_limits<float>::max()) {
                    return error(Fault::OutOfRange,
                                 "a texel of the scanline before is too bright for a float");
                }
                out[band] = static_cast<float>(value);
            }
        }
        return {};
    }

    std::span<const std::byte> file_;
    std::uint64_t most_pixels_;
    Progress& progress_;
    std::uint64_t at_ = 0;  // next byte of the body
    std::uint64_t width_ = 0, height_ = 0;
    std::array<double, 3> exposure_{1.0, 1.0, 1.0};
    std::array<double, 256> step_{};  // of a mantissa, by exponent
    std::vector<Rgbe> line_;
};

}  // namespace

Result<Image> read_hdr(std::span<const std::byte> file, std::uint64_t most_pixels,
                       Progress& progress)
{
    if (file.empty()) { return Error{Fault::EmptyFile, "the file has no bytes", {}, {}, {}}; }
    return HdrReader(file, most_pixels, progress).read();
}

}  // namespace relight
