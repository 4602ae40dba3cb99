// What comes back of a glTF from relight-import, and from one that its file has taken over.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <random>
#include <thread>

#include "server/import/protocol.h"
#include "server/import_process.h"
#include "tests/io/mutants.h"
#include "tests/server/assets.h"
#include "tests/server/rogue.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

namespace relight::test {
namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;
using namespace std::chrono_literals;

const std::string data = RELIGHT_TEST_DATA;

Result<Asset> import(std::string_view file, ImportLimits limits = {})
{
    if (limits.program.empty()) { limits.program = RELIGHT_IMPORT_PROGRAM; }
    Progress progress;
    return import_gltf(std::as_bytes(std::span(file)), limits, progress);
}

TEST(ImportGltf, BringsAMeshBack)
{
    const auto asset = import(contents(data + "/gltf/BoxVertexColors.glb"));
    ASSERT_TRUE(asset) << asset.error().detail;
    EXPECT_EQ(asset->mesh.faces.count(), 12U);
    EXPECT_EQ(asset->mesh.colors.size(), asset->mesh.positions.size());
}

TEST(ImportGltf, UnpacksInsideTheSandbox)
{
    for (const char* name : {"suzi_draco.glb", "BoxMeshopt.glb", "carbon-sphere.glb"}) {
        const auto asset = import(contents(data + "/gltf/" + name));
        ASSERT_TRUE(asset) << name << ": " << asset.error().detail;
        EXPECT_GT(asset->mesh.faces.count(), 0U) << name;
    }
}

TEST(ImportGltf, IsHeldToItsLimits)
{
    const std::string file = contents(data + "/gltf/BoxVertexColors.glb");
    const auto few_vertices = import(file, {.vertices = 23});
    ASSERT_FALSE(few_vertices);
    EXPECT_EQ(few_vertices.error().fault, Fault::TooManyVertices);
    const auto few_faces = import(file, {.faces = 11});
    ASSERT_FALSE(few_faces);
    EXPECT_EQ(few_faces.error().fault, Fault::TooManyFaces);
    EXPECT_TRUE(import(file, {.vertices = 24, .faces = 12}));
}

TEST(ImportGltf, RefusesAndSaysWhy)
{
    const auto empty = import("");
    ASSERT_FALSE(empty);
    EXPECT_EQ(empty.error().fault, Fault::EmptyFile);
    const auto none = import("solid thing");
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().fault, Fault::MalformedHeader) << none.error().detail;
    EXPECT_FALSE(none.error().detail.empty());
}

TEST(ImportGltf, SurvivesFlippedBits)
{
    std::mt19937 random(7);
    for (const char* name : {"suzi_draco.glb", "BoxMeshopt.glb", "BoxVertexColors.glb"}) {
        const std::string good = contents(data + "/gltf/" + name);
        for (int round = 0; round < (sanitized ? 10 : 40); ++round) {
            std::string file = good;
            for (std::size_t flips = 1 + random() % 4; flips > 0; --flips) {
                file[random() % file.size()] ^= static_cast<char>(1U << random() % 8);
            }
            const auto asset = import(file);
            if (!asset) { EXPECT_FALSE(asset.error().detail.empty()) << name << ' ' << round; }
        }
    }
}

/// An importer that hears the file out, says `bytes` and ends with `status`.
Result<Asset> import_by(const std::string& bytes, const std::string& after = "exit 0",
                        ImportLimits limits = {})
{
    const TemporaryFile said(bytes);
    const Rogue rogue("cat >/dev/null; cat " + said.path() + "; " + after);
    limits.program = rogue.path();
    return import("glTF, says its sender", limits);
}

std::string announced(const std::string& archive, std::uint64_t bytes)
{
    const import_protocol::Header header{import_protocol::magic, bytes};
    std::string said(sizeof header, '\0');
    std::memcpy(said.data(), &header, sizeof header);
    return said + archive;
}

std::string announced(const std::string& archive)
{
    return announced(archive, archive.size());
}

void expect_failed(const Result<Asset>& asset, const std::string& what)
{
    ASSERT_FALSE(asset) << what;
    EXPECT_EQ(asset.error().fault, Fault::ImportFailed) << what;
    EXPECT_NE(asset.error().detail.find("GLB"), std::string::npos) << asset.error().detail;
}

TEST(ImportAsset, AnHonestImporterIsBelieved)
{
    const Asset sent = full_asset();
    const auto asset = import_by(announced(archive_of(sent)));
    ASSERT_TRUE(asset) << asset.error().detail;
    EXPECT_EQ(archive_of(*asset).size(), archive_of(sent).size());
    EXPECT_EQ(asset->mesh.positions, sent.mesh.positions);
    EXPECT_EQ(asset->mesh.materials, sent.mesh.materials);
    EXPECT_EQ(asset->lights.size(), sent.lights.size());
}

TEST(ImportAsset, EachBrokenPromiseIsTheFilesFault)
{
    for (const BrokenPromise& broken : broken_promises()) {
        expect_failed(import_by(announced(archive_of(broken.asset))), broken.what);
    }
}

TEST(ImportAsset, OtherSizesThanAnnouncedAreNotBelieved)
{
    const std::string archive = archive_of(full_asset());
    const std::uint64_t size = archive.size();
    for (const std::uint64_t bytes : {std::uint64_t{0}, size - 1, size + 1, 2 * size, size << 32U,
                                      std::uint64_t{1} << 31U, ~std::uint64_t{0}}) {
        expect_failed(import_by(announced(archive, bytes)), std::to_string(bytes));
    }
    expect_failed(import_by(announced(archive + archive)), "twice");
    expect_failed(import_by(announced(archive.substr(0, size - 1))), "a byte less");
    expect_failed(import_by(announced("")), "nothing");
    expect_failed(import_by(announced(archive).substr(0, sizeof(import_protocol::Header))), "head");
    expect_failed(import_by(announced(archive).substr(0, 20)), "half a head");
    expect_failed(import_by(""), "silence");
    expect_failed(import_by(std::string(1000, 'x')), "no magic");
    expect_failed(import_by(announced(archive), "cat /dev/zero", {.memory = 1ULL << 26U}),
                  "endless");
    expect_failed(import_by(announced(archive, 1ULL << 30U), "cat /dev/zero", {.memory = 1 << 20}),
                  "endless, announced");
}

TEST(ImportAsset, StrangeEndsAreNotBelieved)
{
    const std::string good = announced(archive_of(full_asset()));
    for (const char* end : {"exit 1", "exit 2", "exit 70", "exit 127", "kill -SEGV $$",
                            "kill -SYS $$", "kill -KILL $$", "kill -XCPU $$"}) {
        expect_failed(import_by(good, end), end);
    }
    const auto hanging = import_by(good, "sleep 60", {.time = 300ms});
    ASSERT_FALSE(hanging);
    EXPECT_EQ(hanging.error().fault, Fault::ImportFailed);
}

TEST(ImportAsset, WhatIsBeyondItsLimitsIsNotBelieved)
{
    const std::string good = announced(archive_of(full_asset()));  // 5 vertices, 2 faces, 11 texels
    EXPECT_TRUE(import_by(good, "exit 0", {.vertices = 5, .faces = 2, .pixels = 11}));
    expect_failed(import_by(good, "exit 0", {.vertices = 4}), "vertices");
    expect_failed(import_by(good, "exit 0", {.faces = 1}), "faces");
    expect_failed(import_by(good, "exit 0", {.pixels = 10}), "pixels");
    expect_failed(import_by(good, "exit 0", {.memory = 1000}), "memory");
}

TEST(ImportAsset, EveryRefusalOfAReaderReachesTheClient)
{
    for (const Fault fault :
         {Fault::MalformedHeader, Fault::MalformedBody, Fault::Truncated, Fault::JsonTooDeep,
          Fault::CountExceedsFile, Fault::IndexOutOfRange, Fault::NonFiniteCoordinate,
          Fault::CoordinateTooLarge, Fault::NoGeometry, Fault::TooManyVertices, Fault::TooManyFaces,
          Fault::OutOfRange, Fault::NotAvailable}) {
        const auto asset =
            import_by(std::string(fault_code(fault)) + " /accessors/3: why\n", "exit 2");
        ASSERT_FALSE(asset);
        EXPECT_EQ(fault_code(asset.error().fault), fault_code(fault));
        EXPECT_EQ(asset.error().detail, "/accessors/3: why");
    }
    for (const Fault fault : {Fault::Internal, Fault::Overloaded, Fault::Cancelled}) {
        expect_failed(import_by(std::string(fault_code(fault)) + " so there\n", "exit 2"),
                      std::string(fault_code(fault)));
    }
}

TEST(ImportAsset, TextIsMadeSuchThatJsonCarriesIt)
{
    Asset asset = full_asset();
    asset.mesh.materials[0] = "caf\xe9";
    asset.mesh.notes[0] = "\xff";
    asset.lights[0].name = "\xc3";
    const auto back = import_by(announced(archive_of(asset)));
    ASSERT_TRUE(back) << back.error().detail;
    EXPECT_EQ(back->mesh.materials[0], "caf\u00e9");
    EXPECT_EQ(back->mesh.materials[1], "Gr\u00fcn");
    EXPECT_EQ(back->mesh.notes[0], "\u00ff");
    EXPECT_EQ(back->lights[0].name, "\u00c3");
}

TEST(ImportAsset, MutantsAreRefusedOrSound)
{
    std::mt19937 random(11);
    const std::string archive = archive_of(full_asset());
    for (int round = 0; round < 60; ++round) {
        std::string mutant = archive;
        for (std::size_t flips = 1 + random() % 8; flips > 0; --flips) {
            mutant[random() % mutant.size()] ^= static_cast<char>(1U << random() % 8);
        }
        const auto asset = import_by(announced(mutant));
        if (!asset) { EXPECT_EQ(asset.error().fault, Fault::ImportFailed) << round; }
    }
}

TEST(ImportGltf, CostsLittleBeyondTheDecoding)
{
    const std::string file = contents(data + "/gltf/BoxVertexColors.glb");
    Milliseconds least{1e9}, sum{};
    constexpr int rounds = 50;
    for (int round = 0; round < rounds; ++round) {
        const Clock::time_point begin = Clock::now();
        ASSERT_TRUE(import(file));
        const Milliseconds took = Clock::now() - begin;
        least = std::min(least, took);
        sum += took;
    }
    std::printf("import of a box: least %.2f ms, mean %.2f ms\n", least.count(),
                sum.count() / rounds);
    if (!sanitized) { EXPECT_LT(least, 15ms); }
}

}  // namespace
}  // namespace relight::test
