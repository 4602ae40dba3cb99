#include "core/light/environment.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <span>

#include "core/base/warp.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;

/// The cell of [0, n) that t lies in, its upper end and rounding beyond either end included.
std::size_t cell(double t, int n)
{
    return static_cast<std::size_t>(t < n ? std::max(0, static_cast<int>(t)) : n - 1);
}

/// Appends the guide of such sums.
void append_guide(std::span<const double> sums, std::vector<int>& guide)
{
    const double n = static_cast<double>(sums.size());
    std::size_t i = 0;
    for (std::size_t part = 0; part < sums.size(); ++part) {
        const double t = static_cast<double>(part) / n * sums.back();
        while (i + 1 < sums.size() && !(sums[i] > t)) { ++i; }
        guide.push_back(static_cast<int>(i));
    }
}

constexpr int guides_a_row = 4;  // of equal height: as rows are thinnest at the poles

/// Turned about +Y by an angle of this cosine and sine, counter-clockwise seen from above.
Vec3 turned(Vec3 w, double c, double s)
{
    return {c * w.x + s * w.z, w.y, c * w.z - s * w.x};
}

}  // namespace

EnvironmentMap::EnvironmentMap(Image image) : image_(std::move(image))
{
    assert(image_.width > 0 && image_.height > 0 &&
           image_.pixels.size() == image_.at(0, image_.height));
    row_cdf_.reserve(static_cast<std::size_t>(image_.height));
    texel_cdf_.reserve(image_.pixels.size());
    texel_guide_.reserve(image_.pixels.size());
    for (int y = 0; y < image_.height; ++y) {
        const double Omega = texel_solid_angle(y);
        double row = 0.0;
        for (int x = 0; x < image_.width; ++x) {
            row += Omega * luminance(to_double(image_.pixels[image_.at(x, y)]));
            texel_cdf_.push_back(row);
        }
        row_sums_.push_back(row);
        total_ += row;
        row_cdf_.push_back(total_);
        append_guide(std::span(texel_cdf_).last(static_cast<std::size_t>(image_.width)),
                     texel_guide_);
    }
    append_guide(row_cdf_, row_guide_);
    const double step = pi / image_.height;
    for (int y = 0; y <= image_.height; ++y) { row_cos_.push_back(std::cos(y * step)); }
    const int parts = guides_a_row * image_.height;
    for (int part = 0, row = 0; part <= parts; ++part) {
        const double y = 1.0 - 2.0 * part / parts;
        while (row + 1 < image_.height && row_cos_[static_cast<std::size_t>(row) + 1] > y) {
            ++row;
        }
        height_guide_.push_back(row);
    }
    const double twice_the_mean = 2.0 * total_ / (4.0 * pi);
    even_ = std::all_of(image_.pixels.begin(), image_.pixels.end(), [&](const Rgbf& texel) {
        return luminance(to_double(texel)) <= twice_the_mean;
    });
}

double EnvironmentMap::texel_solid_angle(int row) const
{
    // cos a - cos b = 2 sin((a + b) / 2) sin((b - a) / 2), without its cancellation at the poles
    const double half = 0.5 * pi / image_.height;
    const double across = 2.0 * pi / image_.width;
    return across * 2.0 * std::sin((2.0 * row + 1.0) * half) * std::sin(half);
}

std::size_t EnvironmentMap::row_along(double y) const
{
    const double part = (1.0 - y) * (0.5 * guides_a_row * image_.height);
    std::size_t row =
        static_cast<std::size_t>(height_guide_[cell(part, static_cast<int>(height_guide_.size()))]);
    const auto last = static_cast<std::size_t>(image_.height) - 1;
    while (row < last && row_cos_[row + 1] >= y) { ++row; }
    while (row > 0 && row_cos_[row] < y) { --row; }
    return row;
}

EnvironmentMap::Seen EnvironmentMap::seen(std::size_t texel, Vec3 w) const
{
    const Rgb L = to_double(image_.pixels[texel]);
    return {w, L, total_ > 0.0 ? luminance(L) / total_ : 0.0};
}

std::size_t EnvironmentMap::texel_at(double turns, double y) const
{
    // The seam's two names, 0 and 1, are one place.
    return row_along(y) * static_cast<std::size_t>(image_.width) +
           cell(turns < 1.0 ? turns * image_.width : 0.0, image_.width);
}

std::size_t EnvironmentMap::texel_along(Vec3 w) const
{
    const double angle = std::copysign(warp::angle_above(std::abs(w.z), w.x), w.z);
    return texel_at(0.5 + angle * (0.5 / pi), w.y);
}

EnvironmentMap::Seen EnvironmentMap::sample(Sample2 s) const
{
    if (!(total_ > 0.0)) { return {}; }
    const Cell row = draw_row(s.v), column = draw_column(row.index, s.u);
    const double turns =
        (static_cast<double>(column.index) + column.fraction()) / image_.width - 0.5;
    const warp::SineCosine phi = warp::sine_cosine_of_turns(turns);
    const double top = upper_edge(row.index), bottom = upper_edge(row.index + 1);
    const double y = top + row.fraction() * (bottom - top);
    const double sine = std::sqrt(std::max(0.0, (1.0 - y) * (1.0 + y)));
    return seen(row.index * static_cast<std::size_t>(image_.width) + column.index,
                {sine * phi.cosine, y, sine * phi.sine});
}

std::uint64_t EnvironmentMap::bytes() const
{
    return image_.pixels.capacity() * sizeof(Rgbf) + image_.coverage.capacity() * sizeof(float) +
           (row_cdf_.capacity() + texel_cdf_.capacity() + row_sums_.capacity() +
            row_cos_.capacity()) *
               sizeof(double) +
           (row_guide_.capacity() + texel_guide_.capacity() + height_guide_.capacity()) *
               sizeof(int);
}

EnvironmentView::EnvironmentView(const EnvironmentLight& light)
    : map_(light.map.get()), cosine_(std::cos(light.rotation)), sine_(std::sin(light.rotation))
{
}

LightSample EnvironmentView::sample(Sample2 s) const
{
    if (map_ == nullptr) {
        constexpr double sphere = 2.0;  // a cap as high as this is all of it
        return look(unit_already(warp::cap(s, sphere)));
    }
    const EnvironmentMap::Seen seen = map_->sample(s);
    if (seen.w == Vec3{}) { return {}; }
    return {unit_already(turned(seen.w, cosine_, sine_)), std::numeric_limits<double>::infinity(),
            seen.L, seen.pdf};
}

Vec3 EnvironmentView::in_map(Dir3 wi) const
{
    return turned(wi, cosine_, -sine_);
}

LightSample EnvironmentView::look(Dir3 wi) const
{
    if (!wi) { return {}; }
    constexpr double far = std::numeric_limits<double>::infinity();
    if (map_ == nullptr) { return {wi, far, Rgb::grey(1.0), 0.25 * std::numbers::inv_pi}; }
    const EnvironmentMap::Seen seen = map_->look(in_map(wi));
    return {wi, far, seen.L, seen.pdf};
}

LightSample sample(const EnvironmentLight& light, Sample2 s)
{
    return EnvironmentView(light).sample(s);
}

LightSample look(const EnvironmentLight& light, Dir3 wi)
{
    return EnvironmentView(light).look(wi);
}

}  // namespace relight
