#include "server/import/archive.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "tests/server/assets.h"

namespace relight::test {
namespace {

std::optional<Asset> read(std::string_view bytes)
{
    // A copy of just that size, so that a sanitizer sees the first byte read beyond it.
    const std::vector<char> copy(bytes.begin(), bytes.end());
    return read_asset(std::as_bytes(std::span(copy)));
}

using Map = std::optional<TextureMap> MaterialMaps::*;
constexpr Map all_maps[] = {&MaterialMaps::base_color,
                            &MaterialMaps::metallic_roughness,
                            &MaterialMaps::emissive,
                            &MaterialMaps::specular,
                            &MaterialMaps::specular_color,
                            &MaterialMaps::clearcoat,
                            &MaterialMaps::clearcoat_roughness,
                            &MaterialMaps::sheen_color,
                            &MaterialMaps::sheen_roughness,
                            &MaterialMaps::anisotropy,
                            &MaterialMaps::normal};

void expect_same_maps(const MaterialMaps& a, const MaterialMaps& b)
{
    EXPECT_EQ(a.base_color_factor, b.base_color_factor);
    EXPECT_EQ(a.normal_scale, b.normal_scale);
    for (const Map map : all_maps) {
        ASSERT_EQ((a.*map).has_value(), (b.*map).has_value());
        if (!(a.*map)) { continue; }
        const TextureMap &x = *(a.*map), &y = *(b.*map);
        EXPECT_EQ(x.texture, y.texture);
        EXPECT_EQ(x.uv_set, y.uv_set);
        EXPECT_EQ(x.wrap_u, y.wrap_u);
        EXPECT_EQ(x.wrap_v, y.wrap_v);
        EXPECT_EQ(x.nearest, y.nearest);
        EXPECT_EQ(x.transform, y.transform);
    }
}

void expect_same_mesh(const Mesh& a, const Mesh& b)
{
    EXPECT_EQ(a.format, b.format);
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.absent, b.absent);
    EXPECT_EQ(a.double_positions, b.double_positions);
    EXPECT_EQ(a.faces.indices, b.faces.indices);
    EXPECT_EQ(a.faces.offsets, b.faces.offsets);
    EXPECT_EQ(a.normals, b.normals);
    EXPECT_EQ(a.colors, b.colors);
    EXPECT_EQ(a.uvs, b.uvs);
    EXPECT_EQ(a.uvs_1, b.uvs_1);
    EXPECT_EQ(a.corner_uvs, b.corner_uvs);
    EXPECT_EQ(a.tangents, b.tangents);
    EXPECT_EQ(a.materials, b.materials);
    EXPECT_EQ(a.face_materials, b.face_materials);
    EXPECT_EQ(a.viewpoint, b.viewpoint);
    EXPECT_EQ(a.notes, b.notes);
    ASSERT_EQ(a.textures.size(), b.textures.size());
    for (std::size_t i = 0; i < a.textures.size(); ++i) {
        EXPECT_EQ(a.textures[i].width, b.textures[i].width);
        EXPECT_EQ(a.textures[i].height, b.textures[i].height);
        EXPECT_EQ(a.textures[i].texels, b.textures[i].texels);
    }
    ASSERT_EQ(a.maps.size(), b.maps.size());
    for (std::size_t i = 0; i < a.maps.size(); ++i) { expect_same_maps(a.maps[i], b.maps[i]); }
    ASSERT_EQ(a.pieces.size(), b.pieces.size());
    for (std::size_t i = 0; i < a.pieces.size(); ++i) {
        EXPECT_EQ(a.pieces[i].node, b.pieces[i].node);
        EXPECT_EQ(a.pieces[i].primitive, b.pieces[i].primitive);
        EXPECT_EQ(a.pieces[i].instance, b.pieces[i].instance);
        EXPECT_EQ(a.pieces[i].first_vertex, b.pieces[i].first_vertex);
        EXPECT_EQ(a.pieces[i].vertices, b.pieces[i].vertices);
    }
}

void expect_same_material(const MetallicRoughness& a, const MetallicRoughness& b)
{
    using M = MetallicRoughness;
    EXPECT_EQ(a.base_color_from_vertex, b.base_color_from_vertex);
    for (Rgb M::*color : {&M::base_color, &M::specular_color, &M::sheen_color, &M::emissive}) {
        EXPECT_EQ(a.*color, b.*color);
    }
    for (double M::*number : {&M::metallic, &M::roughness, &M::ior, &M::specular, &M::clearcoat,
                              &M::clearcoat_roughness, &M::sheen_roughness, &M::anisotropy_strength,
                              &M::anisotropy_rotation, &M::emissive_strength}) {
        EXPECT_EQ(a.*number, b.*number);
    }
}

/// Of unit vectors: they are normalised once more on the way.
void expect_same_direction(Dir3 a, Dir3 b)
{
    EXPECT_LT(length(Vec3(a) - Vec3(b)), 1e-15);
}

void expect_same_light(const Light& a, const Light& b)
{
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.power, b.power);
    EXPECT_EQ(a.enabled, b.enabled);
    EXPECT_EQ(a.cast_shadows, b.cast_shadows);
    ASSERT_EQ(a.shape.index(), b.shape.index());
    if (const auto* point = std::get_if<PointLight>(&a.shape)) {
        EXPECT_EQ(point->position, std::get<PointLight>(b.shape).position);
        EXPECT_EQ(point->range, std::get<PointLight>(b.shape).range);
    } else if (const auto* spot = std::get_if<SpotLight>(&a.shape)) {
        const auto& other = std::get<SpotLight>(b.shape);
        EXPECT_EQ(spot->position, other.position);
        expect_same_direction(spot->axis, other.axis);
        EXPECT_EQ(spot->inner_cone, other.inner_cone);
        EXPECT_EQ(spot->outer_cone, other.outer_cone);
    } else {
        const auto& sun = std::get<DirectionalLight>(a.shape);
        expect_same_direction(sun.travel, std::get<DirectionalLight>(b.shape).travel);
        EXPECT_EQ(sun.half_angle, std::get<DirectionalLight>(b.shape).half_angle);
    }
}

void expect_same(const Asset& a, const Asset& b)
{
    expect_same_mesh(a.mesh, b.mesh);
    ASSERT_EQ(a.materials.size(), b.materials.size());
    for (std::size_t i = 0; i < a.materials.size(); ++i) {
        expect_same_material(a.materials[i], b.materials[i]);
    }
    ASSERT_EQ(a.lights.size(), b.lights.size());
    for (std::size_t i = 0; i < a.lights.size(); ++i) {
        expect_same_light(a.lights[i], b.lights[i]);
    }
}

/// More than the writer gathers into one call of its sink.
Asset large_asset()
{
    Asset asset = full_asset();
    Mesh& m = asset.mesh;
    m.notes.assign(5000, "so it goes");
    for (int i = 0; i < 30'000; ++i) {
        const double x = i;
        m.positions.push_back({x, -x, 1.0});
    }
    m.normals.clear();
    m.tangents.clear();
    m.colors.clear();
    m.uvs.clear();
    m.uvs_1.clear();
    m.pieces.clear();
    return asset;
}

TEST(Archive, BringsBackEveryMember)
{
    for (const Asset& asset : {full_asset(), cloud_asset(), large_asset(), Asset{}}) {
        const std::optional<Asset> back = read(archive_of(asset));
        ASSERT_TRUE(back);
        expect_same(asset, *back);
    }
}

TEST(Archive, SaysTheSameSizeEachTime)
{
    std::size_t calls = 0, size = 0;
    const Asset asset = large_asset();
    EXPECT_TRUE(write_asset(asset, [&](std::span<const std::byte> some) {
        ++calls;
        size += some.size();
        return true;
    }));
    EXPECT_EQ(size, archive_of(asset).size());
    EXPECT_LT(calls, 60U) << "small members go together";
}

TEST(Archive, StopsWhenTheSinkDoes)
{
    for (std::size_t most = 0; most < 5; ++most) {
        std::size_t calls = 0;
        EXPECT_FALSE(write_asset(large_asset(), [&](auto) { return calls++ < most; }));
        EXPECT_EQ(calls, most + 1);
    }
}

TEST(Archive, HoldsNoLightThatNoFileHolds)
{
    Asset asset = full_asset();
    asset.lights[1].shape = SphereLight{};
    EXPECT_FALSE(write_asset(asset, [](auto) { return true; }));
}

TEST(Archive, IsReadWhollyOrNotAtAll)
{
    for (const Asset& asset : {full_asset(), cloud_asset(), Asset{}}) {
        const std::string good = archive_of(asset);
        for (std::size_t size = 0; size < good.size(); ++size) {
            ASSERT_FALSE(read(good.substr(0, size))) << size << " of " << good.size();
        }
        EXPECT_FALSE(read(good + '\0'));
        EXPECT_FALSE(read(good + good));
    }
}

TEST(Archive, IsNoneIfOnePromiseIsBroken)
{
    ASSERT_TRUE(read(archive_of(full_asset())));
    ASSERT_TRUE(read(archive_of(cloud_asset())));
    for (const BrokenPromise& broken : broken_promises()) {
        EXPECT_FALSE(read(archive_of(broken.asset))) << broken.what;
    }
}

TEST(Archive, CountsBeyondTheBytesAskForNoMemory)
{
    const std::string good = archive_of(full_asset());
    for (const std::uint64_t count : {1ULL << 20U, 1ULL << 32U, 1ULL << 61U, ~0ULL, ~0ULL / 24}) {
        for (std::size_t at = 0; at + sizeof count <= good.size(); ++at) {
            std::string bad = good;
            std::memcpy(bad.data() + at, &count, sizeof count);
            static_cast<void>(read(bad));  // would throw std::bad_alloc
        }
    }
}

TEST(Archive, ChoicesAndDirectionsAreLookedAt)
{
    const std::string good = archive_of(full_asset());  // ends with the sun's two flags
    for (const char flag : {'\0', '\1'}) {
        EXPECT_TRUE(read(good.substr(0, good.size() - 1) + flag));
    }
    for (const char flag : {'\2', '\xff'}) {
        EXPECT_FALSE(read(good.substr(0, good.size() - 1) + flag));
    }
    const Vec3 down{0, -1, 0};  // where the sun shines
    const std::size_t at =
        good.rfind(std::string(reinterpret_cast<const char*>(&down), sizeof down));
    ASSERT_NE(at, std::string::npos);
    for (const Vec3 other : {Vec3{0, -2, 0}, Vec3{0, -0.999, 0}, Vec3{0, -1, 1e-3}, Vec3{}}) {
        std::string bad = good;
        std::memcpy(bad.data() + at, &other, sizeof other);
        EXPECT_FALSE(read(bad)) << other.y;
    }
    std::string bad = good;
    ASSERT_EQ(bad[at - 1], 2) << "the kind of light";
    for (const char kind : {'\0', '\1', '\3', '\7', '\xff'}) {
        bad[at - 1] = kind;
        EXPECT_FALSE(read(bad)) << int{kind};
    }
}

/// What uses an asset may do without looking; the first number that it would trip over.
std::string trip(const Asset& asset)
{
    const Mesh& m = asset.mesh;
    double sum = 0.0;
    for (std::size_t f = 0; f < m.faces.count(); ++f) {
        for (std::size_t corner = m.faces.begin(f); corner < m.faces.end(f); ++corner) {
            sum += m.positions.at(m.faces.indices.at(corner)).x;
            if (!m.corner_uvs.empty()) { sum += double{m.corner_uvs.at(corner)[0]}; }
        }
        if (!m.face_materials.empty()) {
            const std::uint32_t material = m.face_materials.at(f);
            sum += static_cast<double>(m.materials.at(material).size());
            for (const Map map : all_maps) {
                if (m.maps.empty() || !(m.maps.at(material).*map)) { continue; }
                const TextureMap& texture_map = *(m.maps.at(material).*map);
                const Texture& texture = m.textures.at(texture_map.texture);
                const auto texels = static_cast<std::size_t>(texture.width) *
                                    static_cast<std::size_t>(texture.height);
                sum += texture.texels.at(texels - 1)[3];
                sum += sample_linear(texture, texture_map, {0.3F, -7.0F}).rgb.g;
            }
        }
    }
    for (std::size_t v = 0; v < m.positions.size(); ++v) {
        sum += m.positions[v].y + (m.normals.empty() ? 0.0 : m.normals.at(v).z) +
               (m.colors.empty() ? 0.0 : double{m.colors.at(v)[2]}) +
               (m.uvs.empty() ? 0.0 : double{m.uvs.at(v)[1]}) +
               (m.uvs_1.empty() ? 0.0 : double{m.uvs_1.at(v)[1]}) +
               (m.tangents.empty() ? 0.0 : double{m.tangents.at(v)[3]});
    }
    for (const std::uint32_t v : m.absent) { sum += m.positions.at(v).z; }
    for (const GltfPiece& piece : m.pieces) {
        if (piece.vertices == 0) { continue; }
        sum += m.positions.at(piece.first_vertex + piece.vertices - 1).x;
    }
    for (const Light& light : asset.lights) {
        const Arrival arrival = arrive(light.shape, {1.0, 0.0, 0.0});
        sum += arrival.per_unit * luminance(light.power);
    }
    for (const MetallicRoughness& material : asset.materials) {
        const Vec3 wi{0.6, 0.0, 0.8}, wo{0.0, 0.6, 0.8};
        sum += luminance(f(material, wi, wo, Rgb::grey(0.5)).value);
    }
    return is_finite(sum) ? "" : "a number that is not finite";
}

TEST(Archive, MutantsAreNoneOrSound)
{
    std::mt19937 random(4);
    int sound = 0;
    for (const Asset& asset : {full_asset(), cloud_asset()}) {
        const std::string good = archive_of(asset);
        for (int round = 0; round < 20'000; ++round) {
            std::string mutant = good;
            for (std::size_t edits = 1 + random() % 3; edits > 0; --edits) {
                char& byte = mutant[random() % mutant.size()];
                byte = round % 2 == 0 ? static_cast<char>(byte ^ (1 << random() % 8))
                                      : static_cast<char>(random());
            }
            const std::optional<Asset> read_back = read(mutant);
            if (!read_back) { continue; }
            ++sound;
            ASSERT_EQ(trip(*read_back), "") << round;
        }
    }
    EXPECT_GT(sound, 1000) << "the mutants say nothing about what is accepted";
}

}  // namespace
}  // namespace relight::test
