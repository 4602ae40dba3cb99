#include "core/texture/texture.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>

namespace relight {
namespace {

using Texel = std::array<std::uint8_t, 4>;

constexpr std::array<Wrap, 3> wraps{Wrap::Repeat, Wrap::ClampToEdge, Wrap::MirroredRepeat};

/// 5 x 3 texels, no two alike in any channel.
Texture uneven()
{
    Texture texture{5, 3, {}};
    for (unsigned i = 0; i < 15; ++i) {
        texture.texels.push_back(
            {static_cast<std::uint8_t>(17 * i), static_cast<std::uint8_t>(255 - 13 * i),
             static_cast<std::uint8_t>((97 * i) % 256), static_cast<std::uint8_t>(40 + 7 * i)});
    }
    return texture;
}

TextureMap map_of(Wrap wrap)
{
    TextureMap map;
    map.wrap_u = map.wrap_v = wrap;
    return map;
}

/// The texel's centre.
Uv centre(const Texture& texture, int x, int y)
{
    return {(static_cast<float>(x) + 0.5F) / static_cast<float>(texture.width),
            (static_cast<float>(y) + 0.5F) / static_cast<float>(texture.height)};
}

const Texel& texel(const Texture& texture, int x, int y)
{
    return texture.texels.at(static_cast<unsigned>(y) * 5U + static_cast<unsigned>(x));
}

void expect_near(const TextureSample& a, const TextureSample& b, double most)
{
    EXPECT_NEAR(a.rgb.r, b.rgb.r, most);
    EXPECT_NEAR(a.rgb.g, b.rgb.g, most);
    EXPECT_NEAR(a.rgb.b, b.rgb.b, most);
    EXPECT_NEAR(a.alpha, b.alpha, most);
}

void expect_in_range(const TextureSample& s)
{
    for (const double x : {s.rgb.r, s.rgb.g, s.rgb.b, s.alpha}) {
        EXPECT_TRUE(x >= 0.0 && x <= 1.0) << x;
    }
}

/// IEC 61966-2-1, the way to the codes.
double srgb_encoded(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

TEST(TextureSampling, ShowsTheTexelAtItsCentre)
{
    const Texture texture = uneven();
    for (const Wrap wrap : wraps) {
        for (int y = 0; y < texture.height; ++y) {
            for (int x = 0; x < texture.width; ++x) {
                const Texel& t = texel(texture, x, y);
                expect_near(sample_linear(texture, map_of(wrap), centre(texture, x, y)),
                            {{t[0] / 255.0, t[1] / 255.0, t[2] / 255.0}, t[3] / 255.0}, 1e-6);
            }
        }
    }
}

TEST(TextureSampling, TakesTheFirstRowForTheTop)
{
    Texture texture{1, 2, {{255, 0, 0, 255}, {0, 255, 0, 255}}};
    const TextureSample top = sample_linear(texture, map_of(Wrap::ClampToEdge), {0.5F, 0.0F});
    EXPECT_EQ(top.rgb, (Rgb{1.0, 0.0, 0.0}));
}

TEST(TextureSampling, IsTheMeanHalfwayBetweenTexels)
{
    const Texture texture = uneven();
    for (int x = 0; x + 1 < texture.width; ++x) {
        const Uv left = centre(texture, x, 1);
        const Uv right = centre(texture, x + 1, 1);
        const Uv middle{0.5F * (left[0] + right[0]), left[1]};
        const TextureSample a = sample_linear(texture, {}, left);
        const TextureSample b = sample_linear(texture, {}, right);
        expect_near(sample_linear(texture, {}, middle),
                    {(a.rgb + b.rgb) * 0.5, 0.5 * (a.alpha + b.alpha)}, 1e-6);
    }
}

TEST(TextureSampling, MixesColoursAsLightNotAsCodes)
{
    const Texture texture{2, 1, {{0, 0, 0, 0}, {255, 255, 255, 255}}};
    const TextureSample middle = sample_srgb(texture, {}, {0.5F, 0.5F});
    EXPECT_NEAR(middle.rgb.r, 0.5, 1e-12);
    EXPECT_NEAR(middle.alpha, 0.5, 1e-12);
}

TEST(TextureSampling, DecodesEverySrgbCodeToWhatEncodesToIt)
{
    for (unsigned code = 0; code < 256; ++code) {
        const auto c = static_cast<std::uint8_t>(code), other = static_cast<std::uint8_t>(~code);
        const Texture texture{1, 1, {{c, other, 0, c}}};
        const TextureSample s = sample_srgb(texture, {}, {0.5F, 0.5F});
        EXPECT_NEAR(srgb_encoded(s.rgb.r), code / 255.0, 1e-6);
        EXPECT_NEAR(srgb_encoded(s.rgb.g), other / 255.0, 1e-6);
        EXPECT_EQ(s.rgb.b, 0.0);
        EXPECT_DOUBLE_EQ(s.alpha, code / 255.0);
        EXPECT_DOUBLE_EQ(sample_linear(texture, {}, {0.5F, 0.5F}).rgb.g, other / 255.0);
    }
}

TEST(TextureSampling, OfAConstantPictureIsConstantEverywhere)
{
    Texture texture{7, 4, {}};
    texture.texels.assign(28, {200, 3, 90, 128});
    std::mt19937 random(1);
    std::uniform_real_distribution<float> anywhere(-9.0F, 9.0F);
    for (const Wrap wrap : wraps) {
        const TextureSample first = sample_srgb(texture, map_of(wrap), {0.5F, 0.5F});
        for (int i = 0; i < 200; ++i) {
            const Uv uv{anywhere(random), anywhere(random)};
            const TextureSample s = sample_srgb(texture, map_of(wrap), uv);
            EXPECT_EQ(s.rgb, first.rgb);
            EXPECT_EQ(s.alpha, first.alpha);
        }
    }
}

TEST(TextureWrap, RepeatHasPeriodOneAndMirroredPeriodTwo)
{
    const Texture texture = uneven();
    std::mt19937 random(2);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    const TextureMap repeat = map_of(Wrap::Repeat);
    const TextureMap mirrored = map_of(Wrap::MirroredRepeat);
    for (int i = 0; i < 500; ++i) {
        const Uv uv{unit(random), unit(random)};
        for (const float n : {-3.0F, -1.0F, 1.0F, 2.0F}) {
            expect_near(sample_linear(texture, repeat, {uv[0] + n, uv[1] - n}),
                        sample_linear(texture, repeat, uv), 1e-5);
            expect_near(sample_linear(texture, mirrored, {uv[0] + 2 * n, uv[1] - 2 * n}),
                        sample_linear(texture, mirrored, uv), 1e-5);
        }
        expect_near(sample_linear(texture, mirrored, {-uv[0], 2.0F - uv[1]}),
                    sample_linear(texture, mirrored, uv), 1e-5);
    }
}

TEST(TextureWrap, RepeatMixesTheEdgesThatMeet)
{
    const Texture texture{3, 1, {{0, 0, 0, 255}, {9, 9, 9, 255}, {255, 255, 255, 255}}};
    for (const float edge : {-1.0F, 0.0F, 1.0F, 5.0F}) {
        EXPECT_NEAR(sample_linear(texture, {}, {edge, 0.5F}).rgb.r, 0.5, 1e-6);
    }
}

TEST(TextureWrap, ClampAndMirroredShowTheEdgeTexelAtTheEdge)
{
    const Texture texture = uneven();
    for (const Wrap wrap : {Wrap::ClampToEdge, Wrap::MirroredRepeat}) {
        expect_near(sample_linear(texture, map_of(wrap), {0.0F, 0.5F}),
                    sample_linear(texture, map_of(wrap), centre(texture, 0, 1)), 1e-6);
        expect_near(sample_linear(texture, map_of(wrap), {1.0F, 0.5F}),
                    sample_linear(texture, map_of(wrap), centre(texture, 4, 1)), 1e-6);
    }
    for (const float beyond : {1.5F, 7.0F, 1e30F}) {
        expect_near(sample_linear(texture, map_of(Wrap::ClampToEdge), {beyond, -beyond}),
                    sample_linear(texture, map_of(Wrap::ClampToEdge), centre(texture, 4, 0)), 1e-6);
    }
}

TEST(TextureWrap, HasNoJumpAnywhere)  // a texel is 1/5 wide and differs by at most 1
{
    const Texture texture = uneven();
    for (const Wrap wrap : wraps) {
        double before = sample_linear(texture, map_of(wrap), {-2.0F, 0.4F}).rgb.b;
        for (int i = -1999; i <= 2000; ++i) {
            const Uv uv{static_cast<float>(i) / 1000.0F, 0.4F};
            const double now = sample_linear(texture, map_of(wrap), uv).rgb.b;
            EXPECT_NEAR(now, before, 5.0 / 1000.0 + 1e-5) << uv[0];
            before = now;
        }
    }
}

TEST(TextureNearest, ShowsOneTexelUpToItsEdges)
{
    const Texture texture = uneven();
    TextureMap map;
    map.nearest = true;
    for (int x = 0; x < texture.width; ++x) {
        for (const float within : {0.01F, 0.5F, 0.99F}) {
            const Uv uv{(static_cast<float>(x) + within) / 5.0F, 0.5F};
            EXPECT_EQ(sample_linear(texture, map, uv).rgb.r, texel(texture, x, 1)[0] / 255.0);
        }
    }
    EXPECT_EQ(sample_linear(texture, map, {-0.01F, 0.5F}).rgb.r, texel(texture, 4, 1)[0] / 255.0);
    EXPECT_EQ(sample_linear(texture, map, {-1e-30F, 0.5F}).rgb.r, texel(texture, 4, 1)[0] / 255.0);
}

TEST(TextureTransform, RotationOverAQuarterTurnsThePicture)
{
    const Texture texture = uneven();
    TextureMap quarter = map_of(Wrap::ClampToEdge);  // u' = v, v' = 1 - u
    quarter.transform = {0.0F, 1.0F, 0.0F, -1.0F, 0.0F, 1.0F};
    const TextureMap plain = map_of(Wrap::ClampToEdge);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    for (int i = 0; i < 200; ++i) {
        const Uv uv{unit(random), unit(random)};
        expect_near(sample_srgb(texture, quarter, uv),
                    sample_srgb(texture, plain, {uv[1], 1.0F - uv[0]}), 1e-6);
    }
}

TEST(TextureTransform, IsAppliedBeforeWrapping)
{
    const Texture texture = uneven();
    TextureMap shifted = map_of(Wrap::Repeat);
    shifted.transform = {2.0F, 0.0F, 0.25F, 0.0F, 3.0F, -0.5F};
    expect_near(sample_linear(texture, shifted, {0.7F, 0.9F}),
                sample_linear(texture, map_of(Wrap::Repeat), {0.65F, 0.2F}), 1e-5);
}

TEST(TextureSampling, IsFiniteForAnyFiniteCoordinates)
{
    constexpr float largest = std::numeric_limits<float>::max();
    const Texture texture = uneven();
    const Texture single{1, 1, {{1, 2, 3, 4}}};
    for (const Wrap wrap : wraps) {
        for (const bool nearest : {false, true}) {
            TextureMap map = map_of(wrap);
            map.nearest = nearest;
            TextureMap huge = map;
            huge.transform = {largest, -largest, largest, -largest, largest, -largest};
            for (const float x : {1e30F, -1e30F, largest, -largest, 1e-45F, -1e-45F, 16777217.0F}) {
                for (const TextureMap& each : {map, huge}) {
                    expect_in_range(sample_linear(texture, each, {x, -x}));
                    expect_in_range(sample_srgb(texture, each, {x, x}));
                    expect_in_range(sample_srgb(single, each, {x, x}));
                }
            }
        }
    }
}

}  // namespace
}  // namespace relight
