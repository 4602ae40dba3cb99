// Ways to ask the same: in streams, one by one, through either tree.
#include "core/trace/shadow_stream.h"
#include "tests/trace/model.h"

namespace relight {
namespace {

using namespace test;

Mesh as_cloud(Mesh mesh)
{
    mesh.faces = {};
    for (const Point3 p : mesh.positions) { mesh.normals.push_back(p - Point3{}); }
    return mesh;
}

/// Two balls over a floor that is filed twice; and a ball as a cloud.
std::vector<Mesh> meshes()
{
    const Mesh floor = test::grid(12);
    const Mesh balls =
        test::joined(test::moved(test::icosphere(2), test::upright(), 0.3, {0.1, 0.05, 0.4}),
                     test::moved(test::latlong_sphere(16, 32), test::upright(), 0.2, {-0.4, 0, 1}));
    return {test::joined(floor, test::joined(balls, floor)), test::joined(floor, floor),
            as_cloud(test::icosphere(4))};
}

/// Anywhere.
std::vector<ShadowRay> rays_at_random()
{
    Numbers numbers;
    constexpr std::size_t count = 10000;
    std::vector<ShadowRay> rays;
    rays.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
        rays.push_back({{numbers.in(-1, 1), numbers.in(-1, 1), numbers.in(-0.2, 1)},
                        numbers.direction(),
                        numbers.in(0.0, 0.2),
                        numbers.in(0.3, 2.0)});
    }
    return rays;
}

/// At every corner and at the middle of every edge, exactly, from a round place and from any.
std::vector<ShadowRay> rays_at_edges(const Model& model)
{
    Numbers numbers;
    std::vector<ShadowRay> rays;
    const auto aim = [&](Point3 target) {
        for (const Point3 eye : {Point3{0, 0, 4}, Point3{3, -2, 2.5},
                                 target + Vec3(numbers.direction()) * numbers.in(0.01, 3.0)}) {
            const Dir3 toward = normalize(target - eye);
            if (!toward) { continue; }
            rays.push_back({eye, toward, 0.0, far});
            rays.push_back({eye, toward, 0.0, length(target - eye) - 1e-6});
            rays.push_back({target, toward, 1e-6, far});
        }
    };
    for (const Point3 p : model.mesh.positions) { aim(p); }
    for (const Triangle& t : model.surface.triangles) {
        const Point3 a = model.mesh.positions[t[0]];
        aim(a + (model.mesh.positions[t[1]] - a) * 0.5);
    }
    return rays;
}

std::vector<std::uint8_t> blocked(const Bvh& bvh, const std::vector<ShadowRay>& rays)
{
    std::vector<std::uint8_t> answers(rays.size());
    bvh.occluded(rays, answers);
    return answers;
}

TEST(Streams, AnswerInTheOrderInWhichRaysArePutAndSkipWhatIsPassedOver)
{
    for (const Mesh& mesh : meshes()) {
        const Model model(mesh);
        const auto rays = rays_at_random();
        const auto expected = blocked(model.bvh, rays);
        ShadowStream stream(model.bvh);
        std::vector<std::uint8_t> answers;
        const auto trace = [&] {
            const auto some = stream.trace();
            for (std::size_t i = 0; i < some.size(); i += 2) {
                answers.push_back(some[i]);
                EXPECT_EQ(some[i + 1], 1);
            }
        };
        EXPECT_TRUE(stream.trace().empty());
        for (const ShadowRay& ray : rays) {
            stream.put(ray);
            stream.pass_over();
            if (stream.full()) { trace(); }
        }
        trace();
        EXPECT_EQ(stream.size(), 0U);
        EXPECT_EQ(answers, expected);
    }
}

/// How many of the rays have other answers.
std::size_t apart(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b)
{
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) { count += a[i] != b[i] ? 1 : 0; }
    return count;
}

// Where a ray runs along a silhouette, to the last bits of a float, either answer is right.
constexpr std::size_t one_in = 1000;

TEST(Patterns, AnswerAlike)
{
    for (const Mesh& mesh : meshes()) {
        const Model model(mesh);
        Progress progress;
        const auto handed = [&](RayPattern pattern) {
            return Bvh(model.mesh, model.surface, 1.5, TreeQuality::Good, progress, pattern);
        };
        const Bvh stream = handed(RayPattern::Streams);
        const Bvh single = handed(RayPattern::OneByOne);
        for (const bool at_edges : {false, true}) {
            const auto rays = at_edges ? rays_at_edges(model) : rays_at_random();
            const auto in_streams = blocked(stream, rays);
            const auto one_by_one = blocked(single, rays);
            EXPECT_LE(apart(in_streams, one_by_one), at_edges ? rays.size() / one_in : 0);
        }
    }
}

TEST(TreeQuality, ChangesNoAnswerAtCornersAtEdgesAndOfFacesFiledTwice)
{
    for (const Mesh& mesh : meshes()) {
        const Model good(mesh);
        Progress progress;
        const Bvh fast(good.mesh, good.surface, 1.5, TreeQuality::Fast, progress);
        EXPECT_EQ(good.bvh.quality(), TreeQuality::Good);
        EXPECT_EQ(fast.quality(), TreeQuality::Fast);
        for (const bool at_edges : {false, true}) {
            const auto rays = at_edges ? rays_at_edges(good) : rays_at_random();
            const bool curved = mesh.positions.size() > 400 && !good.surface.triangles.empty();
            const std::size_t grazing = at_edges && curved ? rays.size() / one_in : 0;
            EXPECT_LE(apart(blocked(fast, rays), blocked(good.bvh, rays)), grazing);
            const auto expected = good.nearest(rays);
            std::vector<Hit> hits(rays.size());
            fast.nearest(rays, hits);
            std::size_t met = 0;
            std::size_t other = 0;
            for (std::size_t i = 0; i < rays.size(); ++i) {
                const Hit &a = hits[i], &b = expected[i];
                met += a.primitive != ~0U ? 1 : 0;
                const bool same = a.primitive == b.primitive && a.distance == b.distance &&
                                  a.u == b.u && a.v == b.v;
                other += same ? 0 : 1;
            }
            EXPECT_LE(other, grazing) << "of " << rays.size();
            EXPECT_GT(met, rays.size() / 20);
        }
    }
}

TEST(Nearest, OfAFaceFiledTwiceIsTheFirst)
{
    const Mesh floor = test::grid(8);
    for (const TreeQuality quality : {TreeQuality::Fast, TreeQuality::Good}) {
        const Model once(floor);
        const Mesh mesh = test::joined(floor, floor);
        const Surface surface = Model::prepared(mesh);
        Progress progress;
        const Bvh twice(mesh, surface, 1.5, quality, progress);
        Numbers numbers;
        for (int k = 0; k < 1000; ++k) {
            const Point3 eye{numbers.in(-0.9, 0.9), numbers.in(-0.9, 0.9), 1.0};
            EXPECT_EQ(twice.nearest(eye, -up).primitive, once.bvh.nearest(eye, -up).primitive);
        }
    }
}

TEST(TreeQuality, IsGoodWhereManyRaysPayForIt)
{
    EXPECT_EQ(tree_for(700'000, 2'000'000), TreeQuality::Fast);     // a point light
    EXPECT_EQ(tree_for(64'000'000, 2'000'000), TreeQuality::Good);  // a sky
}

TEST(Building, OfAStoppedTreeEndsAtOnce)
{
    const Mesh mesh = test::icosphere(6);
    const Surface surface = Model::prepared(mesh);
    for (const TreeQuality quality : {TreeQuality::Fast, TreeQuality::Good}) {
        Progress progress;
        progress.stop();
        const Bvh stopped(mesh, surface, 1.5, quality, progress);
        EXPECT_TRUE(progress.stopped());
        Progress goes_on;
        const Bvh whole(mesh, surface, 1.5, quality, goes_on);
        EXPECT_NE(whole.nearest({0, 0, 3}, -up).primitive, ~0U);
    }
}

}  // namespace
}  // namespace relight
