#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/geometry/filled.h"
#include "core/geometry/mesh.h"
#include "core/geometry/neighbours.h"

namespace relight {

/// A cloud's points, without the absent ones, in the order of the Morton curve: so what looks at
/// each point's neighbours finds them in the processor's cache, whatever the order of the file.
struct OrderedCloud {
    std::vector<std::uint32_t> places;  ///< of each point in the file
    std::vector<Point3> positions;
    Neighbours neighbours;

    /// Values of these points, from the file's order into this one …
    template <class T>
    std::vector<T> taken(const std::vector<T>& from, unsigned threads, Progress& progress) const
    {
        auto values = filled<T>(places.size(), progress);
        parallel_for(places.size(), block, threads, progress,
                     [&](std::size_t begin, std::size_t end) {
                         for (std::size_t i = begin; i < end; ++i) { values[i] = from[places[i]]; }
                     });
        return values;
    }
    /// … and back.
    template <class T>
    void put(const std::vector<T>& values, std::vector<T>& to, unsigned threads,
             Progress& progress) const
    {
        parallel_for(places.size(), block, threads, progress,
                     [&](std::size_t begin, std::size_t end) {
                         for (std::size_t i = begin; i < end; ++i) { to[places[i]] = values[i]; }
                     });
    }

    static constexpr std::size_t block = 65'536;
};

/// @param order Surface::order
OrderedCloud ordered_cloud(const Mesh& cloud, const std::vector<std::uint32_t>& order,
                           unsigned threads, Progress& progress);

}  // namespace relight
