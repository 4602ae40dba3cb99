#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/io/photometry.h"
#include "core/io/utf8.h"

namespace relight::test {

using HdrReader = Result<Image> (*)(std::span<const std::byte>, std::uint64_t, Progress&);
using IesReader = Result<IesProfile> (*)(std::span<const std::byte>, Progress&);

inline constexpr std::uint64_t few_pixels = 1U << 20U;

inline Result<Image> hdr(std::string_view file, std::uint64_t most_pixels = few_pixels)
{
    Progress progress;
    return read_hdr(std::as_bytes(std::span(file)), most_pixels, progress);
}

inline Result<IesProfile> ies(std::string_view file)
{
    Progress progress;
    return read_ies(std::as_bytes(std::span(file)), progress);
}

/// An error has a text, and a place unless there is no byte to point at.
inline std::string broken_promise(const Error& error)
{
    if (error.detail.empty() || !is_utf8(error.detail)) {
        return "an error without a readable text";
    }
    if (error.fault != Fault::EmptyFile && !error.line && !error.byte) {
        return "an error without a place";
    }
    return {};
}

/// The first promise of photometry.h that a reader breaks on `text`; empty if it keeps them all.
inline std::string broken_promise(HdrReader reader, std::string_view text)
{
    Progress progress;
    const Result<Image> image = reader(std::as_bytes(std::span(text)), few_pixels, progress);
    if (!image) { return broken_promise(image.error()); }
    if (image->width < 1 || image->height < 1 || image->pixels.size() > few_pixels ||
        image->at(0, image->height) != image->pixels.size()) {
        return "the picture has not the size it says";
    }
    const auto good = [](const Rgbf& texel) {
        return std::all_of(texel.begin(), texel.end(),
                           [](float x) { return std::isfinite(x) && x >= 0.0F; });
    };
    if (!std::all_of(image->pixels.begin(), image->pixels.end(), good)) {
        return "a texel is negative or not finite";
    }
    return {};
}

inline std::string broken_promise(IesReader reader, std::string_view text)
{
    Progress progress;
    const Result<IesProfile> profile = reader(std::as_bytes(std::span(text)), progress);
    if (!profile) { return broken_promise(profile.error()); }
    const std::vector<double>&vertical = profile->vertical_deg,
          &horizontal = profile->horizontal_deg;
    if (vertical.empty() || horizontal.empty() ||
        profile->candela.size() != vertical.size() * horizontal.size()) {
        return "an array has the wrong length";
    }
    const auto ascend = [](const std::vector<double>& angles) {
        return std::adjacent_find(angles.begin(), angles.end(), std::greater_equal<>()) ==
               angles.end();
    };
    if (!ascend(vertical) || !ascend(horizontal) || vertical.front() < 0.0 ||
        vertical.back() > 180.0 || horizontal.front() < 0.0 || horizontal.back() > 360.0) {
        return "angles do not ascend within their range";
    }
    if (!std::all_of(profile->candela.begin(), profile->candela.end(),
                     [](double I) { return I >= 0.0 && I <= 1e30; })) {
        return "a candela value is negative or too large";
    }
    if (8 * profile->candela.size() > 4 * text.size() + 4) {
        return "the profile takes more than four times its file";
    }
    return {};
}

}  // namespace relight::test
