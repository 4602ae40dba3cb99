// Long work on a mesh ends soon after it is asked to: within a block of work on each thread.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <random>
#include <thread>

#include "core/geometry/copied.h"
#include "core/geometry/from_faces.h"
#include "core/geometry/refine.h"
#include "core/geometry/surface.h"
#include "tests/shapes.h"

namespace relight {
namespace {

TEST(Stopping, InTheFirstSumsOfVerticesLeavesAtMostOnePieceToEachThread)
{
    // Faces in no order: a thread has half of the vertices to itself.
    Mesh mesh = test::grid(400);
    std::shuffle(mesh.faces.indices.begin(), mesh.faces.indices.end(), std::mt19937(3));
    std::vector<Triangle> triangles(mesh.faces.count());
    for (std::size_t f = 0; f < triangles.size(); ++f) {
        std::copy_n(&mesh.faces.indices[3 * f], 3, triangles[f].begin());
    }
    for (const unsigned threads : {1U, 2U}) {
        Progress progress;
        const VertexRanges ranges(triangles, mesh.positions.size(), threads, progress);
        std::atomic<unsigned> pieces = 0;
        std::atomic<std::size_t> vertices = 0;
        sum_faces(mesh.positions, triangles, {}, ranges, progress,
                  [&](std::size_t /*first*/, std::span<const AtVertex> some) {
                      ++pieces;
                      vertices += some.size();
                      progress.stop();
                  });
        EXPECT_LE(pieces, threads);
        EXPECT_LT(vertices, mesh.positions.size() / 2);
    }
}

TEST(Stopping, ACopyEndsItWhereItIs)
{
    const std::vector<double> values(3'000'000, 1.0);
    Progress progress;
    EXPECT_EQ(copied(values, progress), values);
    EXPECT_GE(copied(values, progress, 4'000'000).capacity(), 4'000'000U);
    progress.stop();
    EXPECT_TRUE(copied(values, progress).empty());
}

TEST(Stopping, InspectionSaysNoMoreThanPrepareDid)
{
    const Mesh mesh = test::grid(30);
    Progress progress;
    const Surface surface = prepare(mesh, 1, progress);
    EXPECT_EQ(inspect(mesh, surface, progress).boundary_edges, 120U);
    progress.stop();
    EXPECT_EQ(inspect(mesh, surface, progress).boundary_edges, 0U);
}

TEST(Stopping, RefiningAtAnyMomentIsCancelledOrDone)
{
    const Mesh triangles = test::icosphere(4);
    Mesh polygons = triangles;
    for (std::uint32_t c = 0; c <= triangles.faces.indices.size(); c += 3) {
        polygons.faces.offsets.push_back(c);
    }
    Progress never_stopped;
    for (const Mesh& mesh : {triangles, polygons}) {
        const auto whole = refine(mesh, 0.02, 1U << 30, 1U << 30, never_stopped);
        ASSERT_TRUE(whole);
        for (int microseconds = 0; microseconds < 20'000; microseconds += 1'000) {
            Progress progress;
            std::jthread stopper([&] {
                std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
                progress.stop();
            });
            const auto result = refine(mesh, 0.02, 1U << 30, 1U << 30, progress);
            if (!result) {
                EXPECT_EQ(result.error().fault, Fault::Cancelled);
                continue;
            }
            EXPECT_EQ(result->positions, whole->positions);
            EXPECT_EQ(result->faces.indices, whole->faces.indices);
        }
    }
}

}  // namespace
}  // namespace relight
