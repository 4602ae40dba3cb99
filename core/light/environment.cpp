#include "core/light/environment.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numbers>
#include <span>

#include "core/base/warp.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;

/// What numbers of [0, 1) are multiplied by, so that they stay below the sum.
double reach_of(double sum)
{
    return std::nextafter(sum, 0.0);
}

/// Which of `steps`, whose running sum is `end(step)`, each part of [0, 1) begins in:
/// `put(part, step)`.
template <class End, class Put>
void guide(int steps, double reach, int parts, const End& end, const Put& put)
{
    int at = 0;
    for (int part = 0; part < parts; ++part) {
        const double t = static_cast<double>(part) / parts * reach;
        while (at + 1 < steps && end(at) <= t) { ++at; }
        put(part, at);
    }
}

int power_of_two(int least)
{
    return static_cast<int>(std::bit_ceil(static_cast<unsigned>(least)));
}

constexpr int parts_a_row = 2;  // of the rows' guide, which is small

std::vector<double> edges_of(int height)
{
    std::vector<double> edges;
    edges.reserve(static_cast<std::size_t>(height) + 1);
    const double step = pi / height;
    for (int y = 0; y <= height; ++y) { edges.push_back(std::cos(y * step)); }
    return edges;
}

/// The row that each part of the heights begins in.
std::vector<int> guide_of_heights(std::span<const double> edges)
{
    const auto height = static_cast<int>(edges.size()) - 1;
    std::vector<int> guide;
    guide.reserve(2 * edges.size());
    for (int part = 0, row = 0; part < 2 * height; ++part) {
        const auto edge = [&] { return edges[static_cast<std::size_t>(row) + 1]; };
        while (row + 1 < height && MapTables::part_of_heights(height, edge()) < part) { ++row; }
        guide.push_back(row);
    }
    return guide;
}

/// Turned about +Y by an angle of this cosine and sine, counter-clockwise seen from above.
Vec3 turned(Vec3 w, double c, double s)
{
    return {c * w.x + s * w.z, w.y, c * w.z - s * w.x};
}

}  // namespace

EnvironmentMap::EnvironmentMap(const Image& image)
{
    const int width = image.width, height = image.height;
    assert(width > 0 && height > 0 && image.pixels.size() == image.at(0, height));
    const int blocks = (width - 1) / MapTables::Block::texels + 1;
    const int parts = power_of_two(blocks);
    tables_.width = width;
    tables_.height = height;
    tables_.blocks = blocks;
    tables_.block_parts = parts;
    const auto rows = static_cast<std::size_t>(height);
    blocks_.resize(rows * static_cast<std::size_t>(blocks));
    assert(blocks_.size() < (1U << 27U));
    block_reach_.reserve(rows);
    row_sums_.reserve(rows + 1);
    block_guide_.resize((rows * static_cast<std::size_t>(parts) + 1) / 2);
    double brightest = 0.0, total = 0.0;
    auto block = blocks_.begin();
    row_sums_.push_back(total);
    for (int y = 0; y < height; ++y) {
        const auto first = block;
        double sum = 0.0;
        for (int x = 0; x < width; x += MapTables::Block::texels, ++block) {
            block->before = sum;
            for (int i = 0; i < std::min(MapTables::Block::texels, width - x); ++i) {
                const Rgbf texel = image.pixels[image.at(x + i, y)];
                const double L = luminance(to_double(texel));
                std::copy(texel.begin(), texel.end(), block->L[i]);
                sum += L;
                brightest = std::max(brightest, L);
            }
            block->end = sum;
        }
        block_reach_.push_back(reach_of(sum));
        total += texel_solid_angle(y) * sum;
        row_sums_.push_back(total);
        const auto put = [&](int part, int at) {
            const std::size_t of = static_cast<std::size_t>(y) * static_cast<std::size_t>(parts) +
                                   static_cast<std::size_t>(part);
            // An earlier one will do: whoever seeks goes on from there.
            block_guide_[of / 2] |= static_cast<std::uint32_t>(std::min(at, 0xffff))
                                    << (of % 2 * 16);
        };
        guide(
            blocks, block_reach_.back(), parts, [&](int at) { return first[at].end; }, put);
    }
    const int row_parts = power_of_two(parts_a_row * height);
    row_guide_.reserve(static_cast<std::size_t>(row_parts));
    guide(
        height, reach_of(total), row_parts,
        [&](int at) { return row_sums_[static_cast<std::size_t>(at) + 1]; },
        [&](int /*part*/, int at) { row_guide_.push_back(at); });
    edges_ = edges_of(height);
    height_guide_ = guide_of_heights(edges_);
    even_ = brightest <= 2.0 * total / (4.0 * pi);
    MapTables::Block& of = blocks_.front();
    for (int texel = 0; texel < MapTables::Block::texels; ++texel) {
        for (int band = 0; band < 3; ++band) { tables_.L[texel][band] = &of.L[texel][band]; }
    }
    tables_.before = &of.before;
    tables_.end = &of.end;
    tables_.block_reach = block_reach_.data();
    tables_.row_sums = row_sums_.data();
    tables_.row_reach = reach_of(total);
    tables_.total = total;
    tables_.row_guide = row_guide_.data();
    tables_.row_parts = row_parts;
    tables_.block_guide = block_guide_.data();
    tables_.edges = edges_.data();
    tables_.height_guide = height_guide_.data();
}

double EnvironmentMap::texel_solid_angle(int row) const
{
    // cos a - cos b = 2 sin((a + b) / 2) sin((b - a) / 2), without its cancellation at the poles
    const double half = 0.5 * pi / tables_.height;
    const double across = 2.0 * pi / tables_.width;
    return across * 2.0 * std::sin((2.0 * row + 1.0) * half) * std::sin(half);
}

Image EnvironmentMap::image() const
{
    Image image{tables_.width, tables_.height, {}, {}};
    image.pixels.reserve(image.at(0, image.height));
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            image.pixels.push_back(to_float(tables_.radiance(y * tables_.texels_a_row() + x)));
        }
    }
    return image;
}

EnvironmentMap::Seen EnvironmentMap::seen(int texel, Vec3 w) const
{
    const Rgb L = tables_.radiance(texel);
    return {w, L, tables_.total > 0.0 ? luminance(L) / tables_.total : 0.0};
}

EnvironmentMap::Seen EnvironmentMap::look(Vec3 w) const
{
    return seen(tables_.texel_at(turns_along(w.x, w.z), w.y), w);
}

EnvironmentMap::Seen EnvironmentMap::sample(Sample2 s) const
{
    const MapTables& map = tables_;
    if (!(map.total > 0.0)) { return {}; }
    const double down = s.v * map.row_reach;
    const int row = map.settled_row(map.near_row(s.v, down), down);
    const double along = s.u * map.block_reach[row];
    const int block = map.settled_block(row, map.near_block(row, s.u), along);
    const MapTables::Across across = map.in_block(row, block, along);
    return seen(across.texel, direction_at(across.turns, map.height_in(row, down)));
}

std::uint64_t EnvironmentMap::bytes() const
{
    return blocks_.capacity() * sizeof(MapTables::Block) +
           (block_reach_.capacity() + row_sums_.capacity() + edges_.capacity()) * sizeof(double) +
           (row_guide_.capacity() + height_guide_.capacity() + block_guide_.capacity()) *
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
