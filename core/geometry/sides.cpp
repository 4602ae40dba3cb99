#include "core/geometry/sides.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/geometry/filled.h"
#include "core/geometry/radix.h"

namespace relight {
namespace {

constexpr std::size_t block = 4096;  // points

/// How two neighbours' normals go together.
struct Step {
    double cost;   ///< 0 between places of one plane, up to 3
    bool opposed;  ///< one of the normals is on the wrong side
};

Step step(Vec3 between, Dir3 a, Dir3 b)
{
    const Dir3 e = normalize(between);
    const double rise_a = dot(e, a), rise_b = dot(e, b);
    // a as the other end of a circular arc would have it: mirrored in the plane between the two.
    // So the sides of a sharp edge agree, and those of a sheet, one behind the other, do not.
    const double agreement = dot(a, b) - 2.0 * rise_a * rise_b;
    const double cost = 1.0 - std::abs(agreement) + rise_a * rise_a + rise_b * rise_b;
    return {std::clamp(cost, 0.0, 3.0), agreement < 0.0};
}

/// Disjoint sets of points, each of which knows whether it is to be turned over to agree with its
/// set's root.
class Parts {
  public:
    struct Place {
        std::uint32_t root;
        bool opposed;
    };

    Parts(std::size_t count, unsigned threads, Progress& progress)
        : parent_(filled<std::uint32_t>(count, progress)),
          size_(filled<std::uint32_t>(count, progress, 1)),
          opposed_(filled<std::uint8_t>(count, progress))
    {
        parallel_for(count, block, threads, progress, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                parent_[i] = static_cast<std::uint32_t>(i);
            }
        });
    }
    Place find(std::uint32_t i)
    {
        bool opposed = false;
        while (parent_[i] != i) {
            const std::uint32_t up = parent_[i];
            opposed_[i] ^= opposed_[up];  // a root's own is 0, so this is safe below one
            parent_[i] = parent_[up];
            opposed = opposed != (opposed_[i] != 0);
            i = parent_[i];
        }
        return {i, opposed};
    }
    /// find() that leaves everything as it is: many may ask at once.
    std::uint32_t root(std::uint32_t i) const
    {
        while (parent_[i] != i) { i = parent_[i]; }
        return i;
    }
    /// Joins two different parts whose roots agree or do not.
    void join(std::uint32_t a, std::uint32_t b, bool opposed)
    {
        if (size_[a] < size_[b]) { std::swap(a, b); }
        parent_[b] = a;
        size_[a] += size_[b];
        opposed_[b] = opposed ? 1 : 0;
    }

  private:
    std::vector<std::uint32_t> parent_, size_;
    std::vector<std::uint8_t> opposed_;
};

// An edge of the neighbours' graph in one number: its cost (up to 3) in the highest 24 bits, then
// its place (point * most + which neighbour; equal costs go by place), then whether the two normals
// are opposed.
constexpr unsigned cost_at = 40;
constexpr double finest_cost = 1 << 22;

constexpr std::uint64_t highest_cost = (std::uint64_t{1} << (64 - cost_at)) - 1;

/// What neighbours_of() and across() found.
struct Graph {
    std::span<const Point3> points;
    const Neighbours& neighbours;
    const std::vector<Dir3>& normals;

    /// Calls take(edge) for those of a point, neighbours both ways once, that wanted(i, j).
    template <class Wanted, class Take>
    void edges(std::size_t i, const Wanted& wanted, const Take& take) const
    {
        const auto around = neighbours.of(i);
        for (std::size_t k = 0; k < around.size() && normals[i]; ++k) {
            const std::uint32_t j = around[k];
            if (!normals[j] || !wanted(static_cast<std::uint32_t>(i), j)) { continue; }
            const auto back = neighbours.of(j);
            if (j < i && std::find(back.begin(), back.end(), i) != back.end()) { continue; }
            const auto [cost, opposed] = step(points[j] - points[i], normals[i], normals[j]);
            take(static_cast<std::uint64_t>(cost * finest_cost) << cost_at |
                 (i * Neighbours::most + k) << 1 | (opposed ? 1 : 0));
        }
    }
};

/// The cost that half of the edges have at most, of a sample. The answer does not depend on it.
std::uint64_t middling_cost(const Graph& graph)
{
    constexpr std::size_t least_step = 61, most_points = 1 << 14;  // the latter: milliseconds
    const std::size_t every = std::max(least_step, graph.points.size() / most_points);
    std::vector<std::uint64_t> costs;
    for (std::size_t i = 0; i < graph.points.size(); i += every) {
        graph.edges(
            i, [](std::uint32_t, std::uint32_t) { return true; },
            [&](std::uint64_t edge) { costs.push_back(edge >> cost_at); });
    }
    if (costs.empty()) { return 0; }
    const auto middle = costs.begin() + static_cast<std::ptrdiff_t>(costs.size() / 2);
    std::nth_element(costs.begin(), middle, costs.end());
    return *middle;
}

/// Those edges between different parts that cost at most this, cheapest first. They are counted
/// before they are written: they take more memory than all else.
std::vector<std::uint64_t> cheapest_edges(const Graph& graph, const Parts& parts,
                                          std::uint64_t most_cost, unsigned threads,
                                          Progress& progress)
{
    const std::size_t count = graph.points.size();
    const auto apart = [&](std::uint32_t i, std::uint32_t j) {
        return parts.root(i) != parts.root(j);
    };
    const auto each = [&](std::size_t begin, std::size_t end, const auto& take) {
        for (std::size_t i = begin; i < end; ++i) {
            graph.edges(i, apart, [&](std::uint64_t edge) {
                if (edge >> cost_at <= most_cost) { take(edge); }
            });
        }
    };
    std::vector<std::size_t> places((count + block - 1) / block);
    parallel_for(count, block, threads, progress, [&](std::size_t begin, std::size_t end) {
        std::size_t found = 0;
        each(begin, end, [&](std::uint64_t /*edge*/) { ++found; });
        places[begin / block] = found;
    });
    std::size_t before = 0;
    for (std::size_t& place : places) { before += std::exchange(place, before); }
    auto edges = filled<std::uint64_t>(before, progress);
    parallel_for(count, block, threads, progress, [&](std::size_t begin, std::size_t end) {
        std::size_t place = places[begin / block];
        each(begin, end, [&](std::uint64_t edge) { edges[place++] = edge; });
    });
    auto sorted = filled<std::uint64_t>(edges.size(), progress);
    sort_by_highest_30_bits(edges, sorted, threads, progress);
    return sorted;
}

/// Kruskal's minimum spanning tree over the neighbours, cheapest steps first. In two halves: of the
/// second, few edges still join anything.
Parts agree(const Graph& graph, unsigned threads, Progress& progress)
{
    Parts parts(graph.points.size(), threads, progress);
    if (progress.stopped()) { return parts; }
    for (const std::uint64_t most_cost : {middling_cost(graph), highest_cost}) {
        for (const std::uint64_t edge :
             cheapest_edges(graph, parts, most_cost, threads, progress)) {
            if (progress.stopped()) { return parts; }
            const std::uint64_t place = edge % (std::uint64_t{1} << cost_at) >> 1;
            const auto i = static_cast<std::uint32_t>(place / Neighbours::most);
            const Parts::Place a = parts.find(i);
            const Parts::Place b = parts.find(graph.neighbours.of(i)[place % Neighbours::most]);
            if (a.root == b.root) { continue; }
            parts.join(a.root, b.root, (a.opposed != b.opposed) != ((edge & 1) != 0));
        }
    }
    return parts;
}

/// What decides the side of a part: sums over its surface, from its root.
struct Part {
    double area = 0.0, squares = 0.0, flux = 0.0;
    Vec3 moment, normal;

    void add(Vec3 from_root, Dir3 n, double a)
    {
        area += a;
        squares += a * dot(from_root, from_root);
        flux += a * dot(from_root, n);
        moment += from_root * a;
        normal += Vec3(n) * a;
    }

    /// A closed surface has a mean normal of 0 and lets the flux of p out, three times its volume;
    /// a sheet has a mean normal of 1, and no flux from its centre. In units of the radius, the
    /// flux decides if it is more than half of the other: of a sphere's cap, as a scan from one
    /// side shows it, from 38 degrees around its axis on. Hollows of a terrain are flatter.
    bool is_inside_out() const
    {
        if (!(area > 0.0)) { return false; }
        const Vec3 centre = moment / area;
        const Vec3 mean = normal / area;
        const double radius = std::sqrt(std::max(0.0, squares / area - dot(centre, centre)));
        const double outward = flux / area - dot(centre, mean);
        if (std::abs(outward) > 0.5 * radius * length(mean)) { return outward < 0.0; }
        constexpr double same = 1.0 + 1e-9;  // a tie but for rounding is z's, then y's
        double most = mean.z;
        for (const double along : {mean.y, mean.x}) {
            if (std::abs(along) > same * std::abs(most)) { most = along; }
        }
        return most < 0.0;
    }
};

void turn_outward(std::span<const Point3> points, std::span<const float> spacing, Parts& parts,
                  const Progress& progress, std::vector<Dir3>& normals)
{
    // Those without a normal are no part: there may be as many as points, and sums are large.
    const auto each = [&](const auto& body) {
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            if (i % block == 0 && progress.stopped()) { return; }
            if (normals[i]) { body(i); }
        }
    };
    auto number = filled<std::uint32_t>(points.size(), progress);  // of the part, at its root
    std::vector<Part> sums;
    each([&](std::uint32_t i) {
        if (parts.find(i).root != i) { return; }
        number[i] = static_cast<std::uint32_t>(sums.size());
        sums.emplace_back();
    });
    each([&](std::uint32_t i) {
        const auto [root, opposed] = parts.find(i);
        if (opposed) { normals[i] = -normals[i]; }
        const auto s = static_cast<double>(spacing[i]);
        sums[number[root]].add(points[i] - points[root], normals[i], s * s);
    });
    std::vector<bool> inside_out(sums.size());
    std::transform(sums.begin(), sums.end(), inside_out.begin(),
                   [](const Part& part) { return part.is_inside_out(); });
    each([&](std::uint32_t i) {
        if (inside_out[number[parts.find(i).root]]) { normals[i] = -normals[i]; }
    });
}

}  // namespace

void choose_sides(std::span<const Point3> points, const Neighbours& neighbours,
                  std::span<const float> spacing, unsigned threads, Progress& progress,
                  std::vector<Dir3>& normals)
{
    Parts parts = agree({points, neighbours, normals}, threads, progress);
    turn_outward(points, spacing, parts, progress, normals);
}

}  // namespace relight
