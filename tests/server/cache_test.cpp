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

Result<Model> model(Cache& cache, const std::string& key,
                    const std::function<Result<Model>()>& build)
{
    Progress progress;
    return cache.get<Model>(key, progress, build);
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

TEST(Cache, BuildsAModelOnceForAllWhoAskAtOnce)
{
    Cache cache(1U << 30U);
    std::atomic<int> builds{0};
    std::vector<std::jthread> threads;
    threads.reserve(8);
    for (int i = 0; i < 8; ++i) {
        threads.emplace_back([&] {
            const auto stage = model(cache, "a", [&] {
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

/// A column of this many bytes that took so long to trace.
std::function<Result<SharedColumn>()> column(std::size_t bytes, std::chrono::milliseconds time)
{
    return [=]() -> Result<SharedColumn> {
        std::this_thread::sleep_for(time);
        Column made;
        made.E.resize(bytes / sizeof(float));
        return std::make_shared<const Column>(std::move(made));
    };
}

/// Asks for a column, and says whether it had to be made.
bool makes(Cache& cache, const std::string& key, std::size_t bytes, std::chrono::milliseconds time)
{
    Progress progress;
    bool made = false;
    EXPECT_TRUE(cache.get<SharedColumn>(key, progress, [&] {
        made = true;
        return column(bytes, time)();
    }));
    return made;
}

TEST(Cache, LetsGoWhatIsSoonMadeAgainBeforeWhatIsNot)
{
    using std::chrono::milliseconds;
    Cache cache(3000);
    EXPECT_TRUE(makes(cache, "dear", 1000, milliseconds(200)));
    EXPECT_TRUE(makes(cache, "cheap", 1000, milliseconds(0)));
    EXPECT_TRUE(makes(cache, "large", 1600, milliseconds(100)));  // one has to go
    EXPECT_LE(cache.bytes(), 3000U);
    EXPECT_FALSE(makes(cache, "dear", 1000, milliseconds(200)));
    EXPECT_FALSE(makes(cache, "large", 1600, milliseconds(100)));
    EXPECT_TRUE(makes(cache, "cheap", 1000, milliseconds(0)));
}

TEST(Cache, LetsTheDearestGoInTheEndIfNobodyAsksForIt)
{
    using std::chrono::milliseconds;
    Cache cache(3000);
    EXPECT_TRUE(makes(cache, "asked for", 1000, milliseconds(30)));
    EXPECT_TRUE(makes(cache, "forgotten", 1000, milliseconds(30)));
    for (int i = 0; i < 60; ++i) {
        makes(cache, std::to_string(i), 1000, milliseconds(3));
        EXPECT_FALSE(makes(cache, "asked for", 1000, milliseconds(30))) << i;
        EXPECT_LE(cache.bytes(), 3000U);
    }
    EXPECT_TRUE(makes(cache, "forgotten", 1000, milliseconds(30)));
}

TEST(Cache, DoesNotEmptyItselfForWhatIsTooLarge)
{
    Cache cache(3000);
    Progress progress;
    ASSERT_TRUE(cache.get<SharedColumn>("small", progress, column(1000, {})));
    ASSERT_TRUE(cache.get<SharedColumn>("huge", progress, column(4000, {})));
    EXPECT_EQ(cache.bytes(), 1000U);
}

TEST(Cache, LetsAWaitingRequestGoWhenItIsStoppedAndTakesOverFromABuilderThatWas)
{
    Cache cache(3000);
    Progress builder;
    std::atomic<bool> building{false};
    std::jthread first([&] {
        EXPECT_FALSE(cache.get<SharedColumn>("a", builder, [&]() -> Result<SharedColumn> {
            building = true;
            while (!builder.stopped()) { std::this_thread::yield(); }
            return Error{Fault::Cancelled, "x", {}, {}, {}};
        }));
    });
    while (!building) { std::this_thread::yield(); }
    Progress stopped;
    stopped.stop();
    const auto none = cache.get<SharedColumn>("a", stopped, column(1000, {}));
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().fault, Fault::Cancelled);
    std::jthread other([&] {
        Progress progress;
        EXPECT_TRUE(cache.get<SharedColumn>("a", progress, column(1000, {})));
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    builder.stop();
    first.join();
    other.join();
    EXPECT_EQ(cache.bytes(), 1000U);  // what the second made is kept
}

TEST(Cache, DoesNotKeepWhatFailedToBuild)
{
    Cache cache(1U << 30U);
    const auto fail = []() -> Result<Model> { return Error{Fault::NoGeometry, "x", {}, {}, {}}; };
    EXPECT_FALSE(model(cache, "a", fail));
    EXPECT_THROW(static_cast<void>(model(cache, "a", []() -> Result<Model> { throw 1; })), int);
    EXPECT_EQ(cache.bytes(), 0U);
    EXPECT_TRUE(model(cache, "a", triangle));
}

TEST(Cache, ForgetsEveryModelOfAMesh)
{
    Cache cache(1U << 30U);
    Builder built;
    for (const char* key : {"m 1", "m 2", "n 1"}) { ASSERT_TRUE(model(cache, key, built())); }
    cache.forget("m");
    EXPECT_EQ(cache.bytes(), bytes_of(Kept(*triangle())));
    ASSERT_TRUE(model(cache, "n 1", built()));
    EXPECT_EQ(built.builds, 3);
}

}  // namespace
}  // namespace relight
