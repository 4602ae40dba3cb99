#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/geometry/surface.h"

namespace relight {

/// How far a set of places reaches along some direction, above and below the origin.
struct Slab {
    Vec3 along;  ///< any length
    double least{}, most{};
};

/// A convex body around a set of places: slabs along the 26 directions of {-1, 0, 1}^3 and along a
/// few directions that matter to the caller (the normals of a flat model, so that a tilted plane is
/// as tight as a level one). Tells in some ten nanoseconds what cannot lie above a plane.
class Extent {
  public:
    /// @param favoured unit directions to be tight along; those that repeat are kept once, as many
    /// as `most_favoured`
    explicit Extent(std::span<const Dir3> favoured = {});

    /// One more of them, while nothing was added. False: it has all that it keeps.
    bool favour(Dir3 n);

    /// Takes in a disc of this radius around a place; radius 0: the place alone.
    void add(Vec3 place, double radius = 0.0, Dir3 normal = {});

    /// Takes in what another, made with the same favoured directions, holds.
    void add(const Extent& other);

    /// Not less than the largest dot(x, n) of everything added, and equal to it along the 26 and
    /// the favoured directions; -infinity of nothing. To within a rounding of double.
    double reach(Dir3 n) const;

    static constexpr std::size_t most_favoured = 8;

  private:
    /// @param index 9 x + 3 y + z of a lattice direction that is not 0: -13 .. 13
    double lattice_reach(int index) const;

    std::vector<Slab> slabs_;  // 13 of the lattice, the favoured after them
    double radius_ = -1.0;     // of the ball around the origin that holds everything
};

/// Of all that casts shadows, around `centre`: the corners of triangles, or the discs of a cloud
/// (of radius `point_radius_scale` x spacing). Not to be used once progress is stopped.
Extent extent_of(const Mesh& mesh, const Surface& surface, Point3 centre, double point_radius_scale,
                 Progress& progress);

}  // namespace relight
