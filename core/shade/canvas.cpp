#include "core/shade/canvas.h"

#include <cmath>
#include <limits>

#include "core/shade/pixel_samples.h"
#include "core/transport/budget.h"

namespace relight {
namespace {

/// Standard error of the mean of samples that came in replicates of these sums.
Rgb standard_error(const std::vector<Rgb>& sums, double samples)
{
    const auto n = static_cast<double>(sums.size());
    Rgb sum, squares;
    for (const Rgb& one : sums) {  // from the first one: no rounding where all are the same
        const Rgb d = one - sums.front();
        sum += d;
        squares += d * d;
    }
    const double factor = student_factor(static_cast<unsigned>(sums.size()));
    const auto root = [&](double total, double total_squares) {
        const double variance = std::max(0.0, total_squares - total * total / n) / (n - 1.0);
        return factor * std::sqrt(n * variance) / samples;
    };
    return {root(sum.r, squares.r), root(sum.g, squares.g), root(sum.b, squares.b)};
}

}  // namespace

Block aim(const Canvas& canvas, const Tile& tile)
{
    const RaytraceOptions& options = canvas.options;
    const Point3 eye = canvas.world.scene.camera.eye;
    Block block{tile, {}, {}, {}, {}, {}};
    block.sums.resize(tile.pixels() * canvas.replicates() * canvas.columns());
    block.hits.resize(tile.pixels());
    block.normals.resize(tile.pixels());
    block.samples.reserve(tile.pixels() * canvas.samples());
    block.rays.resize(tile.pixels() * canvas.samples());
    PixelSamples places(canvas.side, options.seed);
    for (std::size_t i = 0; i < tile.pixels(); ++i) {
        const std::size_t x = tile.x + i % tile.width, y = tile.y + i / tile.width;
        const std::size_t pixel = y * static_cast<std::size_t>(options.width) + x;
        places.move_to(pixel);
        const auto column = static_cast<double>(x), row = static_cast<double>(y);
        const Sequence sequence(options.seed, pixel, 0, 0);
        for (int s = 0; s < static_cast<int>(canvas.samples()); ++s) {
            const auto [dx, dy] = places.at(s);
            const auto replicate = static_cast<std::size_t>(places.replicate(s));
            const std::size_t first = (i * canvas.replicates() + replicate) * canvas.columns();
            block.rays[block.samples.size()] = {eye,
                                                canvas.pixel_rays.through(column + dx, row + dy),
                                                0.0, std::numeric_limits<double>::infinity()};
            block.samples.push_back({block.sums.data() + first, i,
                                     sequence.replicate(static_cast<std::uint32_t>(replicate)),
                                     static_cast<std::uint32_t>(places.row(s))});
        }
    }
    return block;
}

void settle(const Canvas& canvas, const Block& block)
{
    Rendered& to = canvas.rendered;
    const auto samples = static_cast<double>(canvas.samples());
    std::vector<Rgb> replicates(canvas.replicates());
    const Tile& tile = block.tile;
    for (std::size_t i = 0; i < tile.pixels(); ++i) {
        const std::size_t pixel =
            (tile.y + i / tile.width) * static_cast<std::size_t>(to.image.width) + tile.x +
            i % tile.width;
        const Rgb* sums = block.sums.data() + i * canvas.replicates() * canvas.columns();
        const auto at = [&](std::size_t r, std::size_t column) {
            return sums[r * canvas.columns() + column];
        };
        Rgb total;
        for (std::size_t r = 0; r < canvas.replicates(); ++r) {
            replicates[r] = {};
            for (std::size_t c = 0; c < canvas.columns(); ++c) { replicates[r] += at(r, c); }
            total += replicates[r];
        }
        const auto hits = static_cast<double>(block.hits[i]);
        to.image.pixels[pixel] = to_float(total / samples);
        to.image.coverage[pixel] = static_cast<float>(hits / samples);
        if (!to.standard_error.empty()) {
            to.standard_error[pixel] = to_float(standard_error(replicates, samples));
        }
        for (std::size_t l = 0; l < to.per_light.size(); ++l) {
            Rgb one;
            for (std::size_t r = 0; r < canvas.replicates(); ++r) { one += at(r, l); }
            to.per_light[l][pixel] = to_float(one / samples);
        }
        if (!to.normal.empty()) {
            const Vec3 n = block.normals[i] / std::max(1.0, hits);
            to.normal[pixel] = to_float({n.x, n.y, n.z});
        }
    }
}

}  // namespace relight
