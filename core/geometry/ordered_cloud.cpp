#include "core/geometry/ordered_cloud.h"

namespace relight {
namespace {

std::vector<std::uint32_t> without(std::span<const std::uint32_t> absent,
                                   const std::vector<std::uint32_t>& order,
                                   const Progress& progress)
{
    auto is_absent = filled<std::uint8_t>(absent.empty() ? 0 : order.size(), progress);
    std::vector<std::uint32_t> present;
    if (progress.stopped()) { return present; }
    for (const std::uint32_t i : absent) { is_absent[i] = 1; }
    present.reserve(order.size() - absent.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
        if (k % OrderedCloud::block == 0 && progress.stopped()) { break; }
        if (is_absent.empty() || is_absent[order[k]] == 0) { present.push_back(order[k]); }
    }
    return present;
}

}  // namespace

OrderedCloud ordered_cloud(const Mesh& cloud, const std::vector<std::uint32_t>& order,
                           unsigned threads, Progress& progress)
{
    OrderedCloud ordered;
    ordered.places = without(cloud.absent, order, progress);
    ordered.positions = ordered.taken(cloud.positions, threads, progress);
    ordered.neighbours = neighbours_of(ordered.positions, threads, progress);
    return ordered;
}

}  // namespace relight
