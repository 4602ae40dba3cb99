#include "core/geometry/morton.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include "core/geometry/filled.h"
#include "core/geometry/radix.h"

namespace relight {
namespace {

constexpr unsigned cells = 1024;       // along the longest side: 10 bits an axis
constexpr std::size_t block = 65'536;  // points: 0.3 ms
constexpr std::size_t crowd = 256;     // points in a cell
constexpr int most_divisions = 4;      // of crowds: 2^-50 of the longest side

using Item = std::uint64_t;  ///< Morton code << 34 | index
constexpr unsigned code_at = 34;

std::uint32_t index_of(Item item)
{
    return static_cast<std::uint32_t>(item);
}

bool in_earlier_cell(Item a, Item b)
{
    return a >> code_at < b >> code_at;
}

/// Room for two bits after each of ten.
constexpr std::uint32_t spread(std::uint32_t x)
{
    x = (x | x << 16) & 0x030000FF;
    x = (x | x << 8) & 0x0300F00F;
    x = (x | x << 4) & 0x030C30C3;
    return (x | x << 2) & 0x09249249;
}

struct Sorting {
    std::span<const Point3> points;
    unsigned threads;
    Progress& progress;

    Bounds box_of(std::span<const Item> items) const
    {
        Bounds box{points[index_of(items[0])], points[index_of(items[0])]};
        for (std::size_t i = 0; i < items.size(); ++i) {
            if (i % block == 0 && progress.stopped()) { break; }
            box.add(points[index_of(items[i])]);
        }
        return box;
    }

    /// Morton codes of the items' points, in cubic cells of this box.
    void encode(const Bounds& box, std::span<const Item> from, std::span<Item> to) const
    {
        const Vec3 side = box.max - box.min;
        const double per_unit = cells / std::max({side.x, side.y, side.z});  // maybe infinite
        const auto cell = [per_unit](double from_min) {
            const double c = from_min * per_unit;  // so maybe no number
            return !(c > 0.0) ? 0U : c < cells ? static_cast<std::uint32_t>(c) : cells - 1;
        };
        parallel_for(
            from.size(), block, threads, progress, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    const std::uint32_t index = index_of(from[i]);
                    const Vec3 d = points[index] - box.min;
                    const Item code =
                        spread(cell(d.x)) | spread(cell(d.y)) << 1 | spread(cell(d.z)) << 2;
                    to[i] = code << code_at | index;
                }
            });
    }

    /// Items in the order of their indices, into that of the curve. Scratch is as long.
    void sort(const Bounds& box, std::span<Item> items, std::span<Item> scratch,
              int divisions) const
    {
        encode(box, items, scratch);
        sort_by_highest_30_bits(scratch, items, threads, progress);
        auto rest = items.begin();  // of this level's codes: a crowd's are made anew
        for (std::size_t i = crowd; i < items.size() && divisions < most_divisions; i += crowd) {
            if (progress.stopped()) { return; }
            if (in_earlier_cell(items[i - crowd], items[i])) { continue; }
            const auto [first, last] =
                std::equal_range(rest, items.end(), items[i], in_earlier_cell);
            rest = last;
            const auto begin = static_cast<std::size_t>(first - items.begin());
            const std::span crowded(first, last);
            sort(box_of(crowded), crowded, scratch.subspan(begin, crowded.size()), divisions + 1);
            i = begin + crowded.size();
        }
    }
};

}  // namespace

std::vector<std::uint32_t> morton_order(std::span<const Point3> points, const Bounds& box,
                                        unsigned threads, Progress& progress)
{
    const std::size_t count = points.size();
    const auto items = std::make_unique_for_overwrite<Item[]>(count);
    const auto scratch = std::make_unique_for_overwrite<Item[]>(count);
    parallel_for(count, block, threads, progress, [&](std::size_t begin, std::size_t end) {
        std::iota(items.get() + begin, items.get() + end, Item{begin});
    });
    Sorting{points, threads, progress}.sort(box, {items.get(), count}, {scratch.get(), count}, 0);
    auto order = filled<std::uint32_t>(count, progress);
    parallel_for(count, block, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) { order[i] = index_of(items[i]); }
    });
    return order;
}

}  // namespace relight
