#include "server/cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace relight {
namespace {

/// The model of one triangle.
Result<Model> triangle()
{
    Asset asset;
    asset.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    asset.mesh.faces.indices = {0, 1, 2};
    Progress progress;
    Model model;
    model.asset = std::make_shared<const Asset>(std::move(asset));
    Stage& stage = model.stage;
    stage.mesh = std::shared_ptr<const Mesh>(model.asset, &model.asset->mesh);
    stage.surface = std::make_shared<const Surface>(prepare(*stage.mesh, 1, progress));
    stage.bvh = std::make_shared<const Bvh>(*stage.mesh, *stage.surface);
    return model;
}

/// Counts builds.
struct Builder {
    int builds = 0;
    std::function<Result<Model>()> operator()()
    {
        return [this] {
            ++builds;
            return triangle();
        };
    }
};

TEST(ModelCache, BuildsAModelOnceForAllWhoAskAtOnce)
{
    ModelCache cache(1U << 30U);
    std::atomic<int> builds{0};
    std::vector<std::jthread> threads;
    threads.reserve(8);
    for (int i = 0; i < 8; ++i) {
        threads.emplace_back([&] {
            const auto stage = cache.get("a", [&] {
                ++builds;
                std::this_thread::sleep_for(std::chrono::milliseconds(20));
                return triangle();
            });
            EXPECT_TRUE(stage);
        });
    }
    threads.clear();
    EXPECT_EQ(builds, 1);
}

TEST(ModelCache, HoldsNoMoreThanItsBytesAndDropsTheLeastRecentlyUsed)
{
    const std::uint64_t one = bytes_of(*triangle());
    ModelCache cache(2 * one + one / 2);
    Builder a;
    Builder b;
    Builder c;
    for (int i = 0; i < 2; ++i) { ASSERT_TRUE(cache.get("a", a())); }
    ASSERT_TRUE(cache.get("b", b()));
    ASSERT_TRUE(cache.get("a", a()));
    ASSERT_TRUE(cache.get("c", c()));  // b goes: a was used after it
    EXPECT_LE(cache.bytes(), 2 * one + one / 2);
    ASSERT_TRUE(cache.get("a", a()));
    EXPECT_EQ(a.builds, 1);
    ASSERT_TRUE(cache.get("b", b()));
    EXPECT_EQ(b.builds, 2);
}

TEST(ModelCache, DoesNotKeepWhatFailedToBuild)
{
    ModelCache cache(1U << 30U);
    const auto fail = []() -> Result<Model> { return Error{Fault::NoGeometry, "x", {}, {}, {}}; };
    EXPECT_FALSE(cache.get("a", fail));
    EXPECT_THROW(static_cast<void>(cache.get("a", []() -> Result<Model> { throw 1; })), int);
    EXPECT_EQ(cache.bytes(), 0U);
    EXPECT_TRUE(cache.get("a", triangle));
}

TEST(ModelCache, ForgetsEveryModelOfAMesh)
{
    ModelCache cache(1U << 30U);
    Builder built;
    for (const char* key : {"m 1", "m 2", "n 1"}) { ASSERT_TRUE(cache.get(key, built())); }
    cache.forget("m");
    EXPECT_EQ(cache.bytes(), bytes_of(*triangle()));
    ASSERT_TRUE(cache.get("n 1", built()));
    EXPECT_EQ(built.builds, 3);
}

}  // namespace
}  // namespace relight
