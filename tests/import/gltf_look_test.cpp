#include "server/import/gltf_look.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/import/gltf_texts.h"

namespace relight::test {
namespace {

using gltf::Look;

/// One material of that text, with `textures` pictures to refer to.
Json with_material(const std::string& material, std::size_t textures = 0)
{
    Json gltf = gltf_with({{"materials", {Json::parse(material)}}});
    for (std::size_t i = 0; i < textures; ++i) {
        gltf["textures"].push_back({{"source", i}});
        gltf["images"].push_back(image(dot(static_cast<std::uint8_t>(10 * i + 1))));
    }
    return gltf;
}

MetallicRoughness factors_of(const std::string& material)
{
    const auto look = look_of(with_material(material));
    EXPECT_TRUE(look) << detail_of(look);
    return look ? look->materials.at(0) : MetallicRoughness{};
}

bool notes_have(const Look& look, std::string_view phrase)
{
    return std::count_if(look.notes.begin(), look.notes.end(), [&](const std::string& note) {
               return note.find(phrase) != std::string::npos;
           }) == 1;
}

TEST(GltfMaterial, ThatSaysNothingIsTheDefaultOfTheSpecification)
{
    const std::string empty = R"({"pbrMetallicRoughness": {}, "extensions": {
        "KHR_materials_clearcoat": {}, "KHR_materials_sheen": {}, "KHR_materials_specular": {},
        "KHR_materials_ior": {}, "KHR_materials_anisotropy": {},
        "KHR_materials_emissive_strength": {}}})";
    for (const std::string& material : {std::string("{}"), empty}) {
        const MetallicRoughness m = factors_of(material);
        EXPECT_EQ(m.base_color, Rgb::grey(1.0));
        EXPECT_FALSE(m.base_color_from_vertex);
        EXPECT_EQ(m.metallic, 1.0);
        EXPECT_EQ(m.roughness, 1.0);
        EXPECT_EQ(m.ior, 1.5);
        EXPECT_EQ(m.specular, 1.0);
        EXPECT_EQ(m.specular_color, Rgb::grey(1.0));
        EXPECT_EQ(m.clearcoat, 0.0);
        EXPECT_EQ(m.clearcoat_roughness, 0.0);
        EXPECT_EQ(m.sheen_color, Rgb{});
        EXPECT_EQ(m.sheen_roughness, 0.0);
        EXPECT_EQ(m.anisotropy_strength, 0.0);
        EXPECT_EQ(m.anisotropy_rotation, 0.0);
        EXPECT_EQ(m.emissive, Rgb{});
        EXPECT_EQ(m.emissive_strength, 1.0);
    }
}

TEST(GltfMaterial, KeepsTheFactorsOfTheCore)
{
    const auto look = look_of(with_material(
        R"({"pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4],
            "metallicFactor": 0.5, "roughnessFactor": 0.6}, "emissiveFactor": [0.7, 0.8, 0.9]})"));
    ASSERT_TRUE(look) << detail_of(look);
    const MetallicRoughness& m = look->materials.at(0);
    EXPECT_EQ(m.base_color, (Rgb{0.1, 0.2, 0.3}));
    EXPECT_EQ(look->maps.at(0).base_color_factor, m.base_color);
    EXPECT_EQ(m.metallic, 0.5);
    EXPECT_EQ(m.roughness, 0.6);
    EXPECT_EQ(m.emissive, (Rgb{0.7, 0.8, 0.9}));
    EXPECT_FALSE(look->maps.at(0).any());
    EXPECT_TRUE(look->textures.empty());
    EXPECT_TRUE(look->notes.empty());
}

TEST(GltfMaterial, KeepsTheFactorsOfTheExtensions)
{
    const MetallicRoughness m = factors_of(R"({"extensions": {
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.1, "clearcoatRoughnessFactor": 0.2},
        "KHR_materials_sheen": {"sheenColorFactor": [0.3, 0.4, 0.5], "sheenRoughnessFactor": 0.6},
        "KHR_materials_specular": {"specularFactor": 0.7, "specularColorFactor": [0.8, 0.9, 2.5]},
        "KHR_materials_ior": {"ior": 1.33},
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.25, "anisotropyRotation": 0.75},
        "KHR_materials_emissive_strength": {"emissiveStrength": 1000}}})");
    EXPECT_EQ(m.clearcoat, 0.1);
    EXPECT_EQ(m.clearcoat_roughness, 0.2);
    EXPECT_EQ(m.sheen_color, (Rgb{0.3, 0.4, 0.5}));
    EXPECT_EQ(m.sheen_roughness, 0.6);
    EXPECT_EQ(m.specular, 0.7);
    EXPECT_EQ(m.specular_color, (Rgb{0.8, 0.9, 2.5}));
    EXPECT_EQ(m.ior, 1.33);
    EXPECT_EQ(m.anisotropy_strength, 0.25);
    EXPECT_EQ(m.anisotropy_rotation, 0.75);
    EXPECT_EQ(m.emissive_strength, 1000.0);
    EXPECT_EQ(factors_of(R"({"extensions": {"KHR_materials_ior": {"ior": 0}}})").ior, 0.0);
}

TEST(GltfMaterial, TurnsItsAnisotropyByWholeTurnsForNothing)
{
    const MetallicRoughness m = factors_of(
        R"({"extensions": {"KHR_materials_anisotropy": {"anisotropyRotation": 15.066370614359172}}})");
    EXPECT_NEAR(m.anisotropy_rotation, 2.5, 1e-14);  // 4 pi + 2.5
}

TEST(GltfMaterial, OutOfRangeOrOfAnotherTypeIsRefusedWithItsPlace)
{
    const std::string in_pbr = R"({"pbrMetallicRoughness": )", in_ext = R"({"extensions": )";
    const std::vector<std::pair<std::string, std::string>> cases{
        {in_pbr + R"({"metallicFactor": 1.01}})", "/pbrMetallicRoughness/metallicFactor"},
        {in_pbr + R"({"roughnessFactor": -0.1}})", "/pbrMetallicRoughness/roughnessFactor"},
        {in_pbr + R"({"roughnessFactor": "rough"}})", "/pbrMetallicRoughness/roughnessFactor"},
        {in_pbr + R"({"baseColorFactor": [1, 1, 1]}})", "/pbrMetallicRoughness/baseColorFactor"},
        {in_pbr + R"({"baseColorFactor": [1, 2, 1, 1]}})",
         "/pbrMetallicRoughness/baseColorFactor/1"},
        {in_pbr + R"({"baseColorFactor": [1, 1, 1, -1]}})",
         "/pbrMetallicRoughness/baseColorFactor/3"},
        {in_pbr + "3}", "/pbrMetallicRoughness"},
        {R"({"emissiveFactor": [0, 0, 1.5]})", "/emissiveFactor/2"},
        {R"({"emissiveFactor": [null, 0, 0]})", "/emissiveFactor"},
        {R"({"alphaMode": "GLASS"})", "/alphaMode"},
        {R"({"doubleSided": 1})", "/doubleSided"},
        {R"({"name": 5})", "/name"},
        {R"({"normalTexture": {"index": 0, "scale": 1e13}})", "/normalTexture/scale"},
        {R"({"normalTexture": {"scale": 1}})", "/normalTexture: needs \"index\""},
        {R"({"normalTexture": {"index": 1}})", "/normalTexture/index: names element 1"},
        {R"({"normalTexture": {"index": -1}})", "/normalTexture/index"},
        {R"({"normalTexture": {"index": 0, "texCoord": 0.5}})", "/normalTexture/texCoord"},
        {R"({"normalTexture": [0]})", "/normalTexture: must be an object"},
        {in_ext + "[]}", "/extensions"},
        {in_ext + R"({"KHR_materials_unlit": true}})", "/extensions/KHR_materials_unlit"},
        {in_ext + R"({"KHR_materials_clearcoat": {"clearcoatFactor": 2}}})",
         "/KHR_materials_clearcoat/clearcoatFactor"},
        {in_ext + R"({"KHR_materials_clearcoat": {"clearcoatRoughnessFactor": -1}}})",
         "/KHR_materials_clearcoat/clearcoatRoughnessFactor"},
        {in_ext + R"({"KHR_materials_sheen": {"sheenColorFactor": [0, 0, 1.1]}}})",
         "/KHR_materials_sheen/sheenColorFactor/2"},
        {in_ext + R"({"KHR_materials_sheen": {"sheenRoughnessFactor": 1.1}}})",
         "/KHR_materials_sheen/sheenRoughnessFactor"},
        {in_ext + R"({"KHR_materials_specular": {"specularFactor": 1.1}}})",
         "/KHR_materials_specular/specularFactor"},
        {in_ext + R"({"KHR_materials_specular": {"specularColorFactor": [-1, 0, 0]}}})",
         "/KHR_materials_specular/specularColorFactor/0"},
        {in_ext + R"({"KHR_materials_ior": {"ior": 0.99}}})", "/KHR_materials_ior/ior"},
        {in_ext + R"({"KHR_materials_ior": {"ior": -1}}})", "/KHR_materials_ior/ior"},
        {in_ext + R"({"KHR_materials_anisotropy": {"anisotropyStrength": 1.5}}})",
         "/KHR_materials_anisotropy/anisotropyStrength"},
        {in_ext + R"({"KHR_materials_emissive_strength": {"emissiveStrength": -1}}})",
         "/KHR_materials_emissive_strength/emissiveStrength"},
        {in_ext + R"({"KHR_materials_emissive_strength": {"emissiveStrength": 1e300}}})",
         "/KHR_materials_emissive_strength/emissiveStrength"}};
    for (const auto& [material, place] : cases) {
        const auto look = look_of(with_material(material, 1));
        ASSERT_FALSE(look) << material;
        EXPECT_NE(look.error().detail.find("/materials/0"), std::string::npos) << material;
        EXPECT_NE(look.error().detail.find(place), std::string::npos) << look.error().detail;
    }
    EXPECT_FALSE(look_of(gltf_with({{"materials", 4}})));
    EXPECT_FALSE(look_of(gltf_with({{"materials", {4}}})));
    EXPECT_EQ(look_of(with_material(R"({"emissiveFactor": [2, 0, 0]})")).error().fault,
              Fault::OutOfRange);
    EXPECT_EQ(look_of(with_material(R"({"emissiveTexture": {"index": 0}})")).error().fault,
              Fault::IndexOutOfRange);
}

TEST(GltfMaterial, HasANameOfItsOwn)
{
    Json gltf = gltf_with({{"materials",
                            {{{"name", "paint"}},
                             Json::object(),
                             {{"name", "paint"}},
                             {{"name", "material_1"}},
                             {{"name", "paint_2"}},
                             {{"name", "paint"}},
                             {{"name", ""}}}}});
    const auto look = look_of(gltf);
    ASSERT_TRUE(look) << detail_of(look);
    const std::vector<std::string> expected{"paint",     "material_1", "paint_2",   "material_1_2",
                                            "paint_2_2", "paint_3",    "material_6"};
    EXPECT_EQ(look->names, expected);
}

TEST(GltfMaterial, OfALargeFileIsNamedInLinearTime)
{
    Json gltf = gltf_with({});
    for (int i = 0; i < 20'000; ++i) { gltf["materials"].push_back({{"name", "a"}}); }
    const auto look = look_of(gltf);
    ASSERT_TRUE(look) << detail_of(look);
    EXPECT_EQ(look->names.back(), "a_20000");
}

TEST(GltfMaterial, SaysOnceWhatIsPassedOver)
{
    const Json material = Json::parse(R"({"alphaMode": "BLEND", "alphaCutoff": 0.5,
        "doubleSided": true, "occlusionTexture": {"index": 99}, "extensions": {
        "KHR_materials_unlit": {}, "KHR_materials_transmission": {"transmissionTexture":
        {"index": 99}}, "KHR_materials_volume": {}, "KHR_materials_iridescence": {},
        "KHR_materials_dispersion": {}, "KHR_materials_diffuse_transmission": {},
        "KHR_materials_pbrSpecularGlossiness": {},
        "KHR_materials_clearcoat": {"clearcoatNormalTexture": {"index": 99}}}})");
    Json gltf = gltf_with({{"materials", {material, material, {{"alphaMode", "MASK"}}}}});
    gltf["extensions"]["KHR_materials_variants"] = {{"variants", Json::array()}};
    const auto look = look_of(gltf);
    ASSERT_TRUE(look) << detail_of(look);
    for (const char* phrase :
         {"alphaMode BLEND", "alphaMode MASK", "transport.two_sided", "occlusionTexture",
          "KHR_materials_unlit", "KHR_materials_transmission", "KHR_materials_volume",
          "KHR_materials_iridescence", "KHR_materials_dispersion",
          "KHR_materials_diffuse_transmission", "KHR_materials_pbrSpecularGlossiness",
          "clearcoatNormalTexture", "KHR_materials_variants"}) {
        EXPECT_TRUE(notes_have(*look, phrase)) << phrase;
    }
    EXPECT_EQ(look->notes.size(), 13U);
    EXPECT_TRUE(look->textures.empty());
}

TEST(GltfMaps, ComeEachFromItsOwnTexture)
{
    const auto look = look_of(with_material(R"({
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
                                 "metallicRoughnessTexture": {"index": 1}},
        "emissiveTexture": {"index": 2}, "normalTexture": {"index": 3, "scale": -0.5},
        "extensions": {
        "KHR_materials_specular": {"specularTexture": {"index": 4},
                                   "specularColorTexture": {"index": 5}},
        "KHR_materials_clearcoat": {"clearcoatTexture": {"index": 6},
                                    "clearcoatRoughnessTexture": {"index": 7}},
        "KHR_materials_sheen": {"sheenColorTexture": {"index": 8},
                                "sheenRoughnessTexture": {"index": 9}},
        "KHR_materials_anisotropy": {"anisotropyTexture": {"index": 10, "texCoord": 1}}}})",
                                            11));
    ASSERT_TRUE(look) << detail_of(look);
    const MaterialMaps& maps = look->maps.at(0);
    const std::array<std::optional<TextureMap>, 11> shown{
        maps.base_color,  maps.metallic_roughness, maps.emissive,  maps.normal,
        maps.specular,    maps.specular_color,     maps.clearcoat, maps.clearcoat_roughness,
        maps.sheen_color, maps.sheen_roughness,    maps.anisotropy};
    ASSERT_EQ(look->textures.size(), 11U);
    for (std::size_t i = 0; i < shown.size(); ++i) {
        ASSERT_TRUE(shown[i]) << i;
        EXPECT_EQ(look->textures.at(shown[i]->texture).texels.at(0)[0], 10 * i + 1) << i;
    }
    EXPECT_EQ(maps.normal_scale, -0.5F);
    EXPECT_EQ(look_of(with_material(R"({"normalTexture": {"index": 0}})", 1))->maps[0].normal_scale,
              1.0F);
    EXPECT_EQ(maps.anisotropy->uv_set, 1);
    EXPECT_EQ(maps.normal->uv_set, 0);
}

/// Of the normal texture with these members beside its index.
Result<TextureMap> map_of(const std::string& members, const std::string& sampler = "{}")
{
    Json gltf = with_material(R"({"normalTexture": {"index": 0, )" + members + "}}", 1);
    gltf["textures"][0]["sampler"] = 0;
    gltf["samplers"] = {Json::parse(sampler)};
    return look_of(gltf).transform([](Look&& look) { return look.maps.at(0).normal.value(); });
}

std::array<double, 2> moved(const TextureMap& map, double u, double v)
{
    const auto& m = map.transform;
    return {m[0] * u + m[1] * v + m[2], m[3] * u + m[4] * v + m[5]};
}

/// KHR_texture_transform's three matrices, multiplied out one after the other.
std::array<double, 2> by_the_specification(double tx, double ty, double r, double sx, double sy,
                                           double u, double v)
{
    const double x = sx * u, y = sy * v;  // scale first
    // rotation, GLSL's columns (cos, -sin, 0) and (sin, cos, 0)
    return {std::cos(r) * x + std::sin(r) * y + tx, -std::sin(r) * x + std::cos(r) * y + ty};
}

TEST(GltfMaps, AreMovedAsTheTextureTransformSays)
{
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-3.0, 3.0);
    for (int i = 0; i < 50; ++i) {
        const double tx = any(random), ty = any(random), r = any(random), sx = any(random),
                     sy = any(random), u = any(random), v = any(random);
        const Json transform{{"offset", {tx, ty}}, {"rotation", r}, {"scale", {sx, sy}}};
        const auto map =
            map_of(R"("extensions": {"KHR_texture_transform": )" + transform.dump() + "}");
        ASSERT_TRUE(map) << detail_of(map);
        const auto found = moved(*map, u, v),
                   expected = by_the_specification(tx, ty, r, sx, sy, u, v);
        EXPECT_NEAR(found[0], expected[0], 1e-5);
        EXPECT_NEAR(found[1], expected[1], 1e-5);
    }
}

TEST(GltfMaps, ShowTheLowerLeftQuarterInTheSpecificationsExample)
{
    const auto map = map_of(R"("extensions": {"KHR_texture_transform":
        {"offset": [0, 1], "rotation": 1.57079632679, "scale": [0.5, 0.5]}})");
    ASSERT_TRUE(map) << detail_of(map);
    for (const auto& [u, v] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}}) {
        const auto [x, y] = moved(*map, u, v);  // v points down: the lower half is [0.5, 1]
        EXPECT_TRUE(x > -1e-6 && x < 0.5 + 1e-6) << x;
        EXPECT_TRUE(y > 0.5 - 1e-6 && y < 1.0 + 1e-6) << y;
    }
}

TEST(GltfMaps, LieAsFiledWithoutATransform)
{
    for (const char* members :
         {R"("texCoord": 0)", R"("extensions": {"KHR_texture_transform": {}})"}) {
        const auto map = map_of(members);
        ASSERT_TRUE(map) << detail_of(map);
        EXPECT_EQ(map->transform, TextureMap{}.transform);
    }
}

TEST(GltfMaps, TakeTheCoordinatesThatTheTransformNames)
{
    const auto map =
        map_of(R"("texCoord": 3, "extensions": {"KHR_texture_transform": {"texCoord": 1}})");
    ASSERT_TRUE(map) << detail_of(map);
    EXPECT_EQ(map->uv_set, 1);
}

TEST(GltfMaps, RefuseATransformBeyondAllNumbers)
{
    for (const char* wrong : {R"({"offset": [1e13, 0]})", R"({"scale": [1, -1e300]})",
                              R"({"rotation": 1e13})", R"({"offset": [1]})", R"({"scale": 2})"}) {
        const auto map =
            map_of(R"("extensions": {"KHR_texture_transform": )" + std::string(wrong) + "}");
        ASSERT_FALSE(map) << wrong;
        EXPECT_NE(map.error().detail.find("/materials/0/normalTexture/extensions"),
                  std::string::npos)
            << map.error().detail;
    }
}

TEST(GltfMaps, OfTexCoord2AreDroppedAndNotDecoded)
{
    const auto look = look_of(with_material(R"({"normalTexture": {"index": 0, "texCoord": 2},
                          "emissiveTexture": {"index": 0, "texCoord": 300}})",
                                            1));
    ASSERT_TRUE(look) << detail_of(look);
    EXPECT_FALSE(look->maps.at(0).any());
    EXPECT_TRUE(look->textures.empty());
    EXPECT_TRUE(notes_have(*look, "TEXCOORD_2"));
}

TEST(GltfMaps, WrapAndFilterAsTheirSamplerSays)
{
    const auto plain = map_of(R"("texCoord": 0)", R"({"minFilter": 9987})");
    ASSERT_TRUE(plain) << detail_of(plain);
    EXPECT_EQ(plain->wrap_u, Wrap::Repeat);
    EXPECT_EQ(plain->wrap_v, Wrap::Repeat);
    EXPECT_FALSE(plain->nearest);
    const auto map =
        map_of(R"("texCoord": 0)", R"({"wrapS": 33071, "wrapT": 33648, "magFilter": 9728})");
    ASSERT_TRUE(map) << detail_of(map);
    EXPECT_EQ(map->wrap_u, Wrap::ClampToEdge);
    EXPECT_EQ(map->wrap_v, Wrap::MirroredRepeat);
    EXPECT_TRUE(map->nearest);
    for (const auto& [sampler, place] :
         {std::pair{R"({"wrapS": 1})", "/samplers/0/wrapS"},
          {R"({"wrapT": 33069})", "/samplers/0/wrapT"},
          {R"({"magFilter": 9987})", "/samplers/0/magFilter"},
          {R"({"magFilter": "NEAREST"})", "/samplers/0/magFilter"}}) {
        const auto refused = map_of(R"("texCoord": 0)", sampler);
        ASSERT_FALSE(refused) << sampler;
        EXPECT_NE(refused.error().detail.find(place), std::string::npos);
    }
}

TEST(GltfLook, OfAFileWithoutMaterialsIsEmpty)
{
    const auto look = look_of(gltf_with({}));
    ASSERT_TRUE(look) << detail_of(look);
    EXPECT_TRUE(look->names.empty() && look->materials.empty() && look->maps.empty() &&
                look->textures.empty() && look->notes.empty());
}

TEST(GltfLook, OfARealSphereHasItsLayersAndTextures)
{
    const auto look = look_of(embedded_gltf("pbr_sphere/sphere.gltf"), 1U << 25U);
    ASSERT_TRUE(look) << detail_of(look);
    ASSERT_EQ(look->materials.size(), 1U);
    const MetallicRoughness& m = look->materials[0];
    EXPECT_EQ(m.metallic, 0.0);
    EXPECT_EQ(m.sheen_color, (Rgb{1.0, 0.329, 0.1}));
    EXPECT_EQ(m.sheen_roughness, 0.8);
    EXPECT_EQ(m.clearcoat, 0.95);
    EXPECT_EQ(m.clearcoat_roughness, 0.03);
    EXPECT_EQ(m.ior, 1.55);
    EXPECT_EQ(m.specular, 0.3);
    EXPECT_EQ(m.specular_color, (Rgb{0.212, 0.521, 0.051}));
    const MaterialMaps& maps = look->maps.at(0);
    EXPECT_TRUE(maps.normal && maps.base_color && maps.sheen_color && maps.sheen_roughness &&
                maps.clearcoat && maps.clearcoat_roughness && maps.specular && maps.specular_color);
    EXPECT_FALSE(maps.metallic_roughness || maps.emissive || maps.anisotropy);
    EXPECT_EQ(look->textures.size(), 8U);  // not transmission's, thickness', the coat's normals
    const auto at_1_0 = moved(*maps.sheen_color, 1.0, 0.0);
    EXPECT_NEAR(at_1_0[0], 0.2 + 0.3 * std::cos(1.5), 1e-6);
    EXPECT_NEAR(at_1_0[1], 0.8 - 0.3 * std::sin(1.5), 1e-6);
    EXPECT_EQ(look->notes.size(), 3U);  // transmission, volume, clearcoatNormalTexture
}

TEST(GltfLook, OfTheKhronosExtensionTestsIsRead)
{
    for (const auto& [name, textures] : {std::pair{"AnisotropyStrengthTest.glb", 1U},
                                         {"AttenuationTest.glb", 2U},
                                         {"ClearCoatTest.glb", 6U},
                                         {"NormalTangentTest.glb", 3U},
                                         {"SpecularTest.glb", 4U}}) {
        const auto look = look_of_bytes(
            file_bytes(std::filesystem::path(RELIGHT_TEST_DATA) / "gltf" / name), 1U << 25U);
        ASSERT_TRUE(look) << name << detail_of(look);
        EXPECT_EQ(look->maps.size(), look->materials.size());
        EXPECT_EQ(look->textures.size(), textures) << name;
    }
}

}  // namespace
}  // namespace relight::test
