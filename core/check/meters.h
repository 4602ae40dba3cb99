#pragma once

#include <numbers>
#include <span>
#include <vector>

#include "core/check/cases.h"
#include "core/transport/transport.h"

namespace relight {

/// A light meter: reads E of a place that faces n.
struct Meter {
    Point3 p;
    Vec3 n{0, 0, 1};
};

/// What a meter read, in the first band.
struct Reading {
    Drawn E;
    double Lo{};  ///< toward its normal
    std::vector<double> per_light;
};

Light light_of(LightShape shape, double power = 1.0);
Scene lit_by(std::vector<Light> lights, unsigned samples = 64);

/// Quads, four corners each, fronts where they run counter-clockwise.
Mesh quads(const std::vector<Point3>& corners);
Mesh joined(Mesh a, const Mesh& b);
/// Triangles that close up to the unit sphere, fronts outward: an octahedron split `levels` times.
Mesh ball(int levels);
/// Fronts become backs.
Mesh inside_out(Mesh mesh);

/// A wide floor z = 0 and a block at its far corner: nothing is in the way of lights above the
/// middle, but rays must be asked to know.
Mesh floor_with_block();
/// A speck far above: nothing is in the way of anything near.
Mesh speck();

/// The mesh with the meters as vertices that no face uses, on its stage.
struct Meters {
    Stage stage;
    std::size_t first, count;

    Meters(const Mesh& around, const std::vector<Meter>& places);
};

/// The whole walk of a request: mesh -> Stage -> trace -> shade.
std::vector<Reading> read(const Mesh& around, const std::vector<Meter>& places, const Scene& scene);
/// E of one meter on the floor under one light.
Drawn read_one(const Light& light, Meter meter);

/// The same in empty space, where lights may stand on the receiver's horizon and below.
double read_alone(const Light& light, Meter meter);

/// The first light's column at the meters alone, where lighting every vertex would cost too much:
/// E with its bounces, and what of it is bounced.
struct Bounced {
    Drawn E;
    double bounced{};
};
std::vector<Bounced> read_column(const Meters& meters, const Scene& scene);

/// A light of the mesh's own faces, each of radiance 1.
Light shining(const Mesh& mesh, std::size_t faces, double power);

}  // namespace relight
