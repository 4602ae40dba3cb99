#pragma once

#include <memory>
#include <utility>

#include "core/transport/transport.h"
#include "tests/shapes.h"

namespace relight::test {

/// A mesh on its stage, ready to be lit.
inline Stage staged(Mesh mesh)
{
    Progress progress;
    Stage stage;
    stage.mesh = std::make_shared<const Mesh>(std::move(mesh));
    stage.surface = std::make_shared<const Surface>(prepare(*stage.mesh, 1, progress));
    stage.bvh = std::make_shared<const Bvh>(*stage.mesh, *stage.surface);
    return stage;
}

inline Light light_of(LightShape shape, Rgb power = Rgb::grey(1.0))
{
    Light light;
    light.name = "light";
    light.shape = std::move(shape);
    light.power = power;
    return light;
}

/// Receivers without faces beside occluders: a grid of virtual light meters.
inline Mesh with_receivers(Mesh occluders, const std::vector<Point3>& places,
                           const std::vector<Vec3>& normals)
{
    occluders.normals.resize(occluders.positions.size());
    occluders.positions.insert(occluders.positions.end(), places.begin(), places.end());
    occluders.normals.insert(occluders.normals.end(), normals.begin(), normals.end());
    occluders.double_positions = true;
    return occluders;
}

/// Such meters on their stage: the last vertices of the mesh.
struct Meters {
    Stage stage;
    std::size_t first, count;

    Meters(const Mesh& occluders, const std::vector<Point3>& places,
           const std::vector<Vec3>& normals)
        : stage(staged(with_receivers(occluders, places, normals))),
          first(occluders.positions.size()),
          count(places.size())
    {
    }
    Column read(const Scene& scene, std::size_t light = 0) const
    {
        return column(stage, scene, light, first, first + count);
    }
};

}  // namespace relight::test
