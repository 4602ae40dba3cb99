#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <semaphore>
#include <stdexcept>
#include <thread>

#include "core/io/fields_writer.h"
#include "core/io/writers.h"
#include "tests/io/full_mesh.h"

namespace relight {
namespace {

constexpr std::uint32_t many = 30'000;  // vertices: some blocks of any encoding

/// Meshes that differ in what a PLY of them holds.
std::vector<Mesh> all_kinds(std::uint32_t vertices)
{
    const Mesh polygons = test::full_mesh(vertices);
    Mesh materials = polygons, corner_uvs = polygons, long_face = polygons, triangles = polygons;
    materials.materials = {"wall", "floor"};
    materials.face_materials.resize(materials.faces.count(), 1);
    corner_uvs.corner_uvs.resize(corner_uvs.faces.indices.size(), {0.5F, 0.25F});
    for (std::uint32_t i = 0; i < 300; ++i) { long_face.faces.indices.push_back(i % vertices); }
    long_face.faces.offsets.push_back(static_cast<std::uint32_t>(long_face.faces.indices.size()));
    Mesh long_uvs = long_face;
    long_uvs.corner_uvs.resize(long_uvs.faces.indices.size(), {0.5F, 0.25F});
    long_uvs.materials = {"one"};
    long_uvs.face_materials.resize(long_uvs.faces.count());
    test::drop_polygons(triangles);
    Mesh bare = triangles;
    bare.normals.clear();
    bare.uvs.clear();
    bare.colors.clear();
    Mesh floats = triangles;
    floats.colors[1] = {0.123F, 4.0F, 0.0F};  // no 8-bit code
    floats.double_positions = true;
    Mesh cloud = floats;
    cloud.faces = {};
    cloud.absent = {1, vertices - 1};
    return {polygons, materials, corner_uvs, long_face, long_uvs, triangles, bare, floats, cloud};
}

/// What a sink that takes `calls` of `write`'s blocks is given, and whether write says so.
struct Refusal {
    std::size_t calls = 0;
    bool done = false;
};

Refusal refused_after(const Encoding& encoding, std::size_t calls)
{
    Refusal seen;
    seen.done = encoding.write([&](std::string_view) { return ++seen.calls <= calls; });
    return seen;
}

/// Three of them, large: polygons, triangles, a cloud.
std::vector<Mesh> large_kinds()
{
    std::vector<Mesh> all = all_kinds(many);
    return {std::move(all.front()), std::move(all[5]), std::move(all.back())};
}

struct Encoder {
    const char* name;
    bool text;  // its length is not known beforehand
    Encoding (*encode)(const LitMesh&);
};
const std::vector<Encoder> encoders{
    {"ply", false, [](const LitMesh& lit) { return encode_ply(lit); }},
    {"ascii ply", true, [](const LitMesh& lit) { return encode_ply(lit, PlyEncoding::Ascii); }},
    {"npz", false, encode_npz},
    {"vtp", false, encode_vtp},
    {"glb", false, encode_glb},
    {"obj", true, encode_obj},
    {"off", true, encode_off},
};

TEST(Encode, GivesAsManyBytesAsItPromisesAndTheSameAtEachCall)
{
    for (const std::uint32_t vertices : {8U, many}) {
        const std::vector<float> E(3 * std::size_t{vertices}, 0.5F), visible(vertices, 1.0F);
        const std::vector<Rgb8> color(vertices);
        const std::vector<Dir3> normals(vertices, normalize({1, 2, 3}));
        int kind = 0;
        for (const Mesh& mesh : vertices == many ? large_kinds() : all_kinds(vertices)) {
            SCOPED_TRACE(kind++);
            const LitMesh all{mesh,
                              normals,
                              color,
                              {{"irradiance", 3, E}, {"visibility_key", 1, visible}},
                              {"units W/m2"}};
            for (const LitMesh& lit : {LitMesh{mesh, {}, {}, {}, {}}, all}) {
                for (const Encoder& encoder : encoders) {
                    SCOPED_TRACE(encoder.name);
                    const Encoding encoding = encoder.encode(lit);
                    std::string sent;
                    EXPECT_TRUE(encoding.write([&](std::string_view bytes) {
                        EXPECT_FALSE(bytes.empty());
                        sent += bytes;
                        return true;
                    }));
                    EXPECT_EQ(encoding.bytes, encoder.text ? 0 : sent.size());
                    EXPECT_TRUE(sent == whole(encoding));
                }
            }
        }
    }
}

TEST(Encode, NeedsTheMeshAndTheSpansAndNothingElse)
{
    const Mesh mesh = test::full_mesh(20);
    const std::vector<float> E(60, 0.5F);
    const std::vector<Rgb8> color(20);
    const std::vector<Dir3> normals(20, normalize({1, 2, 3}));
    const LitMesh lit{mesh, normals, color, {{"irradiance", 3, E}}, {"units W/m2"}};
    for (const Encoder& encoder : encoders) {
        auto gone = std::make_unique<LitMesh>(lit);
        const Encoding encoding = encoder.encode(*gone);
        gone.reset();
        EXPECT_EQ(whole(encoding), whole(encoder.encode(lit))) << encoder.name;
    }
}

TEST(Encode, StopsWhenTheReceiverIsGone)
{
    for (const Encoder& encoder : encoders) {
        for (const Mesh& mesh : large_kinds()) {
            const Encoding encoding = encoder.encode({mesh, {}, {}, {}, {}});
            const std::size_t blocks = refused_after(encoding, 1000).calls;
            const bool by_vtk = encoder.encode == encode_vtp;  // held whole
            EXPECT_GE(blocks, by_vtk ? 1U : 2U) << encoder.name;
            for (const std::size_t taken : {std::size_t{0}, blocks / 2, blocks - 1}) {
                const Refusal refusal = refused_after(encoding, taken);
                EXPECT_EQ(refusal.calls, taken + 1) << encoder.name;
                EXPECT_FALSE(refusal.done) << encoder.name;
            }
            EXPECT_TRUE(refused_after(encoding, blocks).done) << encoder.name;
        }
    }
}

TEST(EncodeFields, StopsWhenTheReceiverIsGone)
{
    const std::vector<float> E(3 * std::size_t{many}, 0.5F);
    for (const FieldType type : {FieldType::Float32, FieldType::Float16, FieldType::UInt8}) {
        const Encoding encoding = encode_fields(many, {{"a", type, 3, E, ""},
                                                       {"b", type, 3, E, ""},
                                                       {"c", type, 3, E, ""},
                                                       {"d", type, 3, E, ""}});
        const std::size_t blocks = refused_after(encoding, 1000).calls;
        EXPECT_GE(blocks, 2U);
        for (std::size_t taken = 0; taken < blocks; ++taken) {
            const Refusal refusal = refused_after(encoding, taken);
            EXPECT_EQ(refusal.calls, taken + 1);
            EXPECT_FALSE(refusal.done);
        }
        EXPECT_TRUE(refused_after(encoding, blocks).done);
    }
}

TEST(BlockOut, TakesPiecesOfAnySizeInOrder)
{
    std::string sent, expected;
    const Sink sink = [&](std::string_view bytes) {
        sent += bytes;
        return true;
    };
    BlockOut out(sink);
    for (const std::size_t size : {1U, 0U, 100'000U, 3U, 200'000U, 60'000U, 262'144U, 5U}) {
        const std::string piece(size, static_cast<char>('a' + size % 23));
        out.bytes(piece);
        std::copy(piece.begin(), piece.end(), out.room(size));
        out.number(std::uint16_t{0x4142});
        out.back() = 'C';
        char* const room = out.room(20);
        *room = '.';
        out.end_at(room + 1);  // of 20, one
        expected += piece + piece + "BC.";
    }
    const std::size_t row = 3 * BlockOut::block_bytes;  // larger than a block
    std::fill_n(out.room(row), row, 'z');
    expected += std::string(row, 'z');
    EXPECT_TRUE(out.flush());
    EXPECT_EQ(sent, expected);
}

TEST(BlockOut, WaitsForASinkThatKeepsTheBytesInMemory)
{
    std::string kept;
    const Sink sink = Append{&kept};
    BlockOut out(sink);
    for (std::size_t blocks = 0; blocks < 3; ++blocks) {
        std::fill_n(out.room(BlockOut::block_bytes), BlockOut::block_bytes, 'a');
        EXPECT_EQ(kept.size(), blocks * BlockOut::block_bytes);
    }
    EXPECT_TRUE(out.flush());
    EXPECT_EQ(kept, std::string(3 * BlockOut::block_bytes, 'a'));
}

TEST(BlockOut, FillsTheNextBlockWhileOneIsSent)
{
    std::binary_semaphore filled{0};
    std::size_t calls = 0;
    const Sink sink = [&](std::string_view) {
        return ++calls > 1 || filled.try_acquire_for(std::chrono::seconds(30));
    };
    BlockOut out(sink);
    out.room(BlockOut::block_bytes);
    out.room(1);  // the first is being sent
    filled.release();
    EXPECT_TRUE(out.flush());
    EXPECT_EQ(calls, 2U);
}

TEST(BlockOut, NeedsNoThreadForWhatFitsInABlock)
{
    std::thread::id sender;
    const Sink sink = [&](std::string_view) {
        sender = std::this_thread::get_id();
        return true;
    };
    BlockOut out(sink);
    out.room(BlockOut::block_bytes);
    EXPECT_TRUE(out.flush());
    EXPECT_EQ(sender, std::this_thread::get_id());
}

TEST(BlockOut, CallsNoSinkAgainThatRefusedALargePiece)
{
    const std::string large(BlockOut::block_bytes, 'x');
    std::size_t calls = 0;
    const Sink sink = [&](std::string_view) { return ++calls < 3; };
    BlockOut out(sink);
    out.room(BlockOut::block_bytes);
    out.bytes("small");
    out.bytes(large);  // the third call
    EXPECT_FALSE(out.open());
    out.bytes("small");
    EXPECT_FALSE(out.flush());
    out.bytes(large);
    EXPECT_FALSE(out.flush());
    EXPECT_EQ(calls, 3U);
}

TEST(BlockOut, ThrowsWhatItsSinkThrows)
{
    const Mesh mesh = test::full_mesh(many);
    const Encoding encoding = encode_obj({mesh, {}, {}, {}, {}});
    const std::size_t blocks = refused_after(encoding, 1000).calls;
    ASSERT_GE(blocks, 3U);
    for (std::size_t last = 1; last <= blocks; ++last) {
        std::size_t calls = 0;
        const auto throws = [&](std::string_view) {
            if (++calls == last) { throw std::length_error("full"); }
            return true;
        };
        EXPECT_THROW(encoding.write(throws), std::length_error);
        EXPECT_EQ(calls, last);
    }
}

TEST(BlockOut, EndsWithItsWriter)
{
    std::size_t sent = 0;
    const Sink sink = [&](std::string_view bytes) {
        sent += bytes.size();
        return true;
    };
    const auto fails = [&] {
        BlockOut out(sink);
        for (int block = 0; block < 3; ++block) { out.room(BlockOut::block_bytes); }
        throw std::runtime_error("amid the third block");
    };
    EXPECT_THROW(fails(), std::runtime_error);
    EXPECT_EQ(sent, 2 * BlockOut::block_bytes);
}

}  // namespace
}  // namespace relight
