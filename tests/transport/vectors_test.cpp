// Loops as compiled for each set of vectors that this processor has: the same bits.
#include "core/base/vectors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "core/transport/draws.h"
#include "core/transport/transport.h"
#include "tests/scenes.h"
#include "tests/shapes.h"

namespace relight {
namespace {

/// Takes the widest again when a test is done.
class Vectors : public ::testing::Test {
  protected:
    ~Vectors() override { vectors_taken() = widest_vectors(); }

    static std::vector<VectorSet> narrower()
    {
        std::vector<VectorSet> sets;
        for (const VectorSet set : {VectorSet::Plain, VectorSet::Avx2}) {
            if (set < widest_vectors()) { sets.push_back(set); }
        }
        return sets;
    }
};

/// A ball with bumps that shade each other.
Stage bumpy_ball()
{
    Mesh mesh = test::icosphere(3);
    for (Point3& p : mesh.positions) {
        const double bump = 1.0 + 0.2 * std::sin(7.0 * p.x) * std::sin(6.0 * p.y + 5.0 * p.z);
        p = Point3{} + (p - Point3{}) * bump;
    }
    return test::staged(std::move(mesh));
}

std::vector<LightShape> shapes()
{
    const Dir3 down = normalize({0.1, -0.2, -1.0});
    Image image{32, 16, {}, {}};
    for (std::uint64_t i = 0; i < 512; ++i) {
        const auto bright = static_cast<float>(uniform(5, i, 0, 0));
        image.pixels.push_back({bright, bright * bright, 1.0F});
    }
    std::vector<Emitter> emitters;
    const Point3 corner{0.5, 0.5, 2.0};
    emitters.push_back({{corner, corner + Vec3{0, 1, 0}, corner + Vec3{1, 0, 0.2}}, 0, {1, 2, 3}});
    return {RectLight{{0.3, -0.2, 1.6}, {0, 1.4, 0}, {1.4, 0, 0.3}, true},
            RectLight{{0.0, 0.0, 1e-3}, {0, 1.4, 0}, {1e-5, 0, 0}, false},
            DiskLight{{0.3, -0.2, 2.0}, down, 0.5},
            SphereLight{{1.3, -0.2, 2.0}, 0.7},
            DirectionalLight{down, 0.1},
            EnvironmentLight{},
            EnvironmentLight{std::make_shared<const EnvironmentMap>(std::move(image)), 0.4},
            make_sky(normalize({0.5, 0.7, 0.3}), 3.0),
            MeshLight{std::make_shared<const EmitterTable>(std::move(emitters))}};
}

TEST_F(Vectors, OfAnySetMakeTheSameColumns)
{
    const Stage stage = bumpy_ball();
    for (const LightShape& shape : shapes()) {
        Scene scene;
        scene.lights = {test::light_of(shape)};
        scene.transport.samples = 16;
        scene.transport.two_sided = std::holds_alternative<SphereLight>(shape);
        const std::size_t count = stage.mesh->positions.size();
        vectors_taken() = widest_vectors();
        const Column widest = column(stage, scene, 0, 0, count);
        for (const VectorSet set : narrower()) {
            vectors_taken() = set;
            const Column other = column(stage, scene, 0, 0, count);
            EXPECT_EQ(other.E, widest.E) << "light " << shape.index();
            EXPECT_EQ(other.standard_error, widest.standard_error) << "light " << shape.index();
            EXPECT_EQ(other.visible, widest.visible) << "light " << shape.index();
            EXPECT_EQ(other.rays, widest.rays) << "light " << shape.index();
        }
    }
}

/// What a draw leaves in a stream, in double: before floats hide what differs.
template <class View>
std::vector<double> drawn(const Stage& stage, const View& view, const Receiver& receiver)
{
    const std::vector<Asker<View>> askers(2, {view, &receiver, Sequence(3, 4, 5, 0)});
    ShadowStream stream(*stage.bvh);
    Brought E;
    std::vector<double> all;
    for (const Lanes& lanes : lanes_of(8, 0, 9)) {
        draw<View>(askers, *stage.bvh, {}, 0, lanes, stream, E);
        const RayFields& f = stream.fields();
        for (std::size_t i = 0; i < stream.size(); ++i) {
            all.insert(all.end(),
                       {E[i], f.origin_x[i], f.origin_y[i], f.origin_z[i], f.direction_x[i],
                        f.direction_y[i], f.direction_z[i], f.distance[i]});
        }
        stream.resize(0);
    }
    return all;
}

TEST_F(Vectors, OfAnySetDrawTheSameRays)
{
    const Stage stage = bumpy_ball();
    for (std::uint64_t item = 0; item < 100; ++item) {
        const auto number = [&](std::uint64_t k) { return 2.0 * uniform(8, item, k, 0) - 1.0; };
        const Point3 p{number(0), number(1), number(2)};
        const Dir3 n = normalize({number(3), number(4), number(5)});
        const Receiver receiver{p, p, frame_around(n), n, {1e-4, 0.0}};
        const RectLight rect{{0.1, 0.2, 1.1}, {number(6), 0, 0}, {0, number(7), 0.1}, true};
        std::vector<RectDirections> directed(1);
        directions(rect, {&p, 1}, directed);
        const auto all = [&] {
            std::vector<double> E(1);
            irradiance(rect, {&p, 1}, {&n, 1}, E);
            std::vector<RectDirections> again(1);
            directions(rect, {&p, 1}, again);
            const RectDirections& of = again[0];
            for (const SphericalTriangle& half : of.halves) {
                E.insert(E.end(), {half.solid_angle, half.T.x, half.T.y, half.T.z, half.sum,
                                   half.sine, half.b_dot_t});
            }
            E.insert(E.end(), {of.whole, of.height, of.farthest});
            const auto add = [&](const auto& view) {
                const std::vector<double> more = drawn(stage, view, receiver);
                E.insert(E.end(), more.begin(), more.end());
            };
            if (directed[0].whole > 0.0) { add(directed[0]); }
            add(DiskView({{0.2, 0.1, 1.5}, normalize({0, 0.1, -1}), 0.4}, p));
            add(SphereView({{0.2, 0.1, 3.0}, 0.4}, p));
            add(CosineView(receiver.frame, item % 2 == 0));
            return E;
        };
        vectors_taken() = widest_vectors();
        const std::vector<double> widest = all();
        for (const VectorSet set : narrower()) {
            vectors_taken() = set;
            ASSERT_EQ(all(), widest) << "item " << item;
        }
    }
}

TEST_F(Vectors, TheInverseRootIsThatOfTheLibrary)
{
    for (std::uint64_t item = 0; item < 100'000; ++item) {
        const double x = std::exp2(1000.0 * uniform(6, item, 0, 0) - 500.0);
        const double expected = 1.0 / std::sqrt(x);
        ASSERT_NEAR(inverse_root(x), expected, 6e-16 * expected) << x;
    }
    EXPECT_EQ(0.0 * inverse_root(0.0), 0.0);
}

}  // namespace
}  // namespace relight
