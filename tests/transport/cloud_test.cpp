#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/clouds.h"
#include "tests/scenes.h"

namespace relight {
namespace {

using test::light_of;
using test::staged;

/// A sphere, and in the way of the light another.
constexpr Point3 other_centre{1.9, 0.3, 1.1};
Mesh spheres(bool with_other)
{
    const Mesh one = test::icosphere(5);
    return with_other ? test::joined(one, test::moved(test::icosphere(4), test::upright(), 0.5,
                                                      other_centre - Point3{}))
                      : one;
}
enum class Kind { Mesh, FiledNormals, EstimatedNormals };

Stage stage_of(Mesh mesh, Kind kind)
{
    for (const Point3 p : mesh.positions) {  // the first sphere's lie on it
        const bool first = std::abs(length(p - Point3{}) - 1.0) < 1e-9;
        mesh.normals.push_back(p - (first ? Point3{} : other_centre));
    }
    if (kind != Kind::Mesh) { mesh.faces = {}; }
    if (kind == Kind::EstimatedNormals) { mesh.normals = {}; }
    return staged(std::move(mesh));
}

/// E per vertex and what is visible.
Column lit(const Stage& stage, const LightShape& shape)
{
    Scene scene;
    scene.lights = {light_of(shape)};
    return column(stage, scene, 0, 0, stage.mesh->positions.size());
}

/// How a cloud's light differs from the mesh's.
struct Difference {
    double rms = 0.0;        ///< in units of the mesh's largest E, where not misplaced
    double misplaced = 0.0;  ///< share of the points that are in shadow in one of them alone
};

Difference compare(const Column& mesh, const Column& cloud)
{
    const double peak = static_cast<double>(*std::max_element(mesh.E.begin(), mesh.E.end()));
    Difference difference;
    double squares = 0.0;
    for (std::size_t v = 0; v < mesh.E.size(); ++v) {
        const double d = std::abs(static_cast<double>(mesh.E[v] - cloud.E[v])) / peak;
        // E alone tells: where it is 0 in one of them only, by more than a grazing ray brings.
        if ((mesh.E[v] > 0.0F) != (cloud.E[v] > 0.0F) && d > 0.02) {
            difference.misplaced += 1.0;
        } else {
            squares += d * d;
        }
    }
    const auto n = static_cast<double>(mesh.E.size());
    difference.rms = std::sqrt(squares / (n - difference.misplaced));
    difference.misplaced /= n;
    return difference;
}

const std::vector<std::pair<const char*, LightShape>> lights{
    {"sun", DirectionalLight{normalize({-1.9, -0.3, -1.1})}},
    {"lamp", PointLight{{3.8, 0.6, 2.2}, {}}}};

TEST(Cloud, OfASphereTakesTheLightOfItsMesh)
{
    for (const auto& [name, light] : lights) {
        for (const bool with_other : {false, true}) {
            const Column mesh = lit(stage_of(spheres(with_other), Kind::Mesh), light);
            const Difference filed =
                compare(mesh, lit(stage_of(spheres(with_other), Kind::FiledNormals), light));
            const Difference estimated =
                compare(mesh, lit(stage_of(spheres(with_other), Kind::EstimatedNormals), light));
            // Filed normals are the mesh's own, so light differs by shadows alone, and a convex
            // body has none of its own. Estimated ones lean by some 0.1 degrees.
            EXPECT_LT(filed.rms, with_other ? 0.001 : 1e-7) << name << with_other;
            EXPECT_LT(estimated.rms, 0.003) << name << with_other;
            // At a shadow's edge discs and facets differ by a few hundredths of a spacing (0.035):
            // a disc of 1.5 spacings touches a sphere of radius 0.5 and rises R^2 / 2 r = 0.003
            // over it. So wide a band is 2 pi 0.5 0.003 / 4 pi = 0.0008 of the points.
            const double band = with_other ? 0.002 : 0.0;
            EXPECT_LE(filed.misplaced, band) << name << with_other;
            EXPECT_LE(estimated.misplaced, band) << name << with_other;
        }
    }
}

TEST(Cloud, OfARandomSphereTakesTheLightThatItsNormalsSay)
{
    test::Draws draws(31);
    const Stage stage = staged(test::cloud_of(test::random_sphere(10000, draws)));
    const Dir3 sun = normalize({0.2, 0.5, 0.8});
    const Column column = lit(stage, DirectionalLight{-sun});
    std::size_t wrong = 0;
    for (std::size_t v = 0; v < column.E.size(); ++v) {
        const double cos = dot(stage.mesh->positions[v] - Point3{}, sun);
        wrong += std::abs(static_cast<double>(column.E[v]) - std::max(0.0, cos)) > 0.05 ? 1 : 0;
    }
    EXPECT_LT(wrong, 20U);
}

}  // namespace
}  // namespace relight
