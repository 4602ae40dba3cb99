#include "core/display/display.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "tests/oracle.h"

namespace relight {
namespace {

using nlohmann::json;

constexpr ToneMap maps[] = {ToneMap::Reinhard, ToneMap::ReinhardExtended, ToneMap::AcesNarkowicz,
                            ToneMap::AcesHill, ToneMap::PbrNeutral};
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr float infinity_f = std::numeric_limits<float>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(DisplayOracle, EveryCaseAgrees)
{
    const json file = test::oracle("color_tonemap");
    const test::Tolerance tolerance(file["tolerance"]);
    std::size_t checked = 0;
    const auto near = [&](double x, const json& expected) {
        EXPECT_TRUE(tolerance.holds(x, expected.get<double>())) << x << " for " << expected;
        ++checked;
    };
    const auto curve = [&](const json& c, const char* from, const char* to, auto function) {
        ASSERT_EQ(c[from].size(), c[to].size());
        for (std::size_t i = 0; i < c[from].size(); ++i) { near(function(c[from][i]), c[to][i]); }
    };
    const auto colors = [&](const json& c, ToneMap map) {
        ASSERT_EQ(c["rgb"].size(), c["out"].size());
        for (std::size_t i = 0; i < c["rgb"].size(); ++i) {
            SCOPED_TRACE(c["rgb"][i].dump());
            const Rgb out = tone_map(test::rgb_of(c["rgb"][i]), map, c.value("white", 4.0));
            near(out.r, c["out"][i][0]);
            near(out.g, c["out"][i][1]);
            near(out.b, c["out"][i][2]);
        }
    };
    for (const json& c : file["cases"]) {
        const std::string kind = c["kind"];
        SCOPED_TRACE(kind);
        const std::size_t before = checked;
        if (kind == "srgb_oetf") {
            curve(c, "x", "y", srgb_oetf);
            for (std::size_t i = 0; i < c["x"].size(); ++i) {
                const double x = c["x"][i];
                EXPECT_EQ(to_srgb8(Rgb::grey(x), {})[0], c["y_8bit"][i].get<int>()) << x;
            }
        } else if (kind == "srgb_eotf") {
            curve(c, "y", "x", [](double y) { return srgb_eotf(y); });
        } else if (kind == "exposure_compensation") {
            curve(c, "ev", "scale", exposure_scale);
        } else if (kind == "exposure_ev100") {
            const auto ev = [](const json& s) { return ev100(s[0], s[1], s[2]); };
            curve(c, "N_t_S", "EV100", ev);
            curve(c, "N_t_S", "scale", [&](const json& s) { return ev100_scale(ev(s)); });
            for (std::size_t i = 0; i < c["scale"].size(); ++i) {  // they are small: relatively too
                const double expected = c["scale"][i];
                EXPECT_NEAR(ev100_scale(ev(c["N_t_S"][i])) / expected, 1.0, 1e-9);
            }
        } else if (kind == "aces_narkowicz") {
            colors(c, ToneMap::AcesNarkowicz);
        } else if (kind == "aces_hill") {
            colors(c, ToneMap::AcesHill);
        } else if (kind == "pbr_neutral") {
            colors(c, ToneMap::PbrNeutral);
        } else if (kind == "reinhard") {
            colors(c, ToneMap::Reinhard);
        } else if (kind == "reinhard_extended_luminance") {
            colors(c, ToneMap::ReinhardExtended);
        } else if (kind == "luminance_rec709") {
            curve(c, "rgb", "Y", [](const json& rgb) { return luminance(test::rgb_of(rgb)); });
        }
        EXPECT_GT(checked, before) << "a kind this test does not know";
    }
    EXPECT_EQ(file["cases"].size(), file["case_count"].get<std::size_t>());
}

TEST(Srgb, DecodingUndoesEncoding)
{
    for (int i = 0; i <= 100'000; ++i) {
        const double x = i / 100'000.0;
        EXPECT_NEAR(srgb_eotf(srgb_oetf(x)), x, 1e-6);
    }
}

TEST(Srgb, Keeps256CodesExactly)
{
    for (int code = 0; code < 256; ++code) {
        const auto byte = static_cast<unsigned char>(code);
        const Rgb linear = srgb_eotf(Rgb8{byte, byte, 0});
        EXPECT_EQ(to_srgb8(linear, {}), (Rgb8{byte, byte, 0}));
        EXPECT_EQ(linear.r, srgb_eotf(code / 255.0));
        EXPECT_EQ(to_code(code / 255.0), code);
    }
}

TEST(Srgb, EncodingIsContinuousWhereItsPiecesMeet)
{
    EXPECT_NEAR(srgb_oetf(0.0031308), srgb_oetf(std::nextafter(0.0031308, 1.0)), 1e-6);
    EXPECT_NEAR(srgb_eotf(0.04045), srgb_eotf(std::nextafter(0.04045, 1.0)), 1e-6);
}

TEST(Code, RoundsToTheNearestAndClampsTheRest)
{
    EXPECT_EQ(to_code(0.4 / 255.0), 0);
    EXPECT_EQ(to_code(0.6 / 255.0), 1);
    EXPECT_EQ(to_code(254.6 / 255.0), 255);
    for (const double dark : {-1.0, -infinity, nan, 0.0}) { EXPECT_EQ(to_code(dark), 0) << dark; }
    for (const double bright : {1.0, 1.5, 1e300, infinity}) { EXPECT_EQ(to_code(bright), 255); }
}

TEST(ToneMaps, AreMonotoneOnGreysAndStayInZeroToOne)
{
    for (const ToneMap map : maps) {
        const double white = 1e30;  // of ReinhardExtended: maps to 1
        double before = tone_map(Rgb{}, map, white).g;
        EXPECT_EQ(before, 0.0);
        for (int i = 0; i < 3300; ++i) {
            const double x = 1e-6 * std::pow(1.01, i);
            const Rgb y = tone_map(Rgb::grey(x), map, white);
            ASSERT_GE(y.g, before - 1e-15) << static_cast<int>(map) << ' ' << x;
            ASSERT_LE(y.g, 1.0) << static_cast<int>(map) << ' ' << x;
            before = y.g;
        }
    }
}

TEST(ToneMaps, NoneChangesNothing)
{
    const Rgb x{-0.5, 3.0, 0.2};
    EXPECT_EQ(tone_map(x, ToneMap::None, 4.0), x);
}

TEST(ToneMaps, ReinhardExtendedShowsItsWhiteAsOneAndKeepsHue)
{
    EXPECT_NEAR(luminance(tone_map(Rgb::grey(6.0), ToneMap::ReinhardExtended, 6.0)), 1.0, 1e-12);
    const Rgb y = tone_map({1.0, 2.0, 4.0}, ToneMap::ReinhardExtended, 6.0);
    EXPECT_NEAR(y.g / y.r, 2.0, 1e-12);
    EXPECT_NEAR(y.b / y.r, 4.0, 1e-12);
}

TEST(ToneMaps, PbrNeutralTakesFourPercentAwayBelowItsShoulder)
{
    for (int percent = 8; percent <= 80; ++percent) {
        const double c = percent / 100.0;
        EXPECT_NEAR(tone_map(Rgb::grey(c), ToneMap::PbrNeutral, 4.0).r, c - 0.04, 1e-12) << c;
    }
}

TEST(ToneMaps, OfAnyInputGiveNumbersNotBelowZero)
{
    const double values[] = {nan, infinity, -infinity, -1.0, 0.0, 1e-320, 0.5, 1e30, 1e300};
    for (const ToneMap map : maps) {
        for (const double r : values) {
            for (const double g : values) {
                const Rgb y = tone_map({r, g, 0.1}, map, 4.0);
                for (const double band : {y.r, y.g, y.b}) {
                    ASSERT_TRUE(std::isfinite(band))
                        << static_cast<int>(map) << ' ' << r << ' ' << g;
                    ASSERT_GE(band, 0.0) << static_cast<int>(map) << ' ' << r << ' ' << g;
                }
            }
        }
    }
}

TEST(Picture, IsExposedThenToneMappedThenEncodedOnce)
{
    const Display display{.exposure_ev = 1.5, .tone_map = ToneMap::AcesNarkowicz};
    const Rgb L{0.05, 0.3, 1.7};
    const Rgb shown = tone_map(L * std::exp2(1.5), ToneMap::AcesNarkowicz, display.white);
    const auto code = [](double y) {
        return static_cast<int>(std::floor(255.0 * srgb_oetf(y) + 0.5));
    };
    const Rgb8 bytes = to_srgb8(L, display);
    EXPECT_EQ(bytes[0], code(shown.r));
    EXPECT_EQ(bytes[1], code(shown.g));
    EXPECT_EQ(bytes[2], code(shown.b));
}

TEST(Picture, ShowsWhatIsNoNumberAsBlackAndInfinityAsWhite)
{
    for (const double ev : {0.0, -2000.0, 2000.0}) {
        EXPECT_EQ(to_srgb8({nan, -1.0, -infinity}, {.exposure_ev = ev}), (Rgb8{0, 0, 0}));
    }
    EXPECT_EQ(to_srgb8({infinity, 1e300, 2.0}, {}), (Rgb8{255, 255, 255}));
    for (const ToneMap map : maps) {
        EXPECT_EQ(to_srgb8({nan, nan, nan}, {.tone_map = map}), (Rgb8{0, 0, 0}));
        EXPECT_GE(to_srgb8({infinity, infinity, infinity}, {.tone_map = map})[0], 250);
    }
}

std::vector<Rgbf> noise(std::size_t count)
{
    std::mt19937 random(1);
    std::uniform_real_distribution<float> stops(-12.0F, 6.0F);
    std::vector<Rgbf> L(count);
    for (Rgbf& x : L) { x = {std::exp2(stops(random)), std::exp2(stops(random)), 0.0F}; }
    return L;
}

TEST(Picture, HasTheCodesOfTheFormulaToTheLastFloatOnEveryInstructionSet)
{
    for (const double ev : {0.0, -0.3, 7.3, -40.0, 64.0, 99.9, 110.0, -101.0}) {
        std::vector<float> bands{0.0F,  -0.0F,      -1.0F,       1e-45F,
                                 3e38F, infinity_f, -infinity_f, static_cast<float>(nan)};
        for (int code = 1; code < 256; ++code) {  // where it begins, and the floats on both sides
            const double begin = srgb_eotf((code - 0.5) / 255.0) / exposure_scale(ev);
            auto x = static_cast<float>(begin);
            for (int k = 0; k < 3; ++k) { x = std::nextafter(x, 0.0F); }
            for (int k = 0; k < 7; ++k) {
                bands.push_back(x);
                x = std::nextafter(x, infinity_f);
            }
        }
        bands.resize((bands.size() + 2) / 3 * 3);
        std::vector<Rgbf> L;
        for (std::size_t i = 0; i < bands.size(); i += 3) {
            L.push_back({bands[i], bands[i + 1], bands[i + 2]});
        }
        const Display display{.exposure_ev = ev};
        for (const auto target : hwy::SupportedAndGeneratedTargets()) {
            hwy::SetSupportedTargetsForTest(target);
            Progress progress;
            const UnsetVector<Rgb8> codes = to_srgb8(L, display, 1, progress);
            for (std::size_t i = 0; i < L.size(); ++i) {
                EXPECT_EQ(codes[i], to_srgb8(to_double(L[i]), display))
                    << hwy::TargetName(target) << ", EV " << ev << ": " << L[i][0] << " " << L[i][1]
                    << " " << L[i][2];
            }
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}

TEST(Picture, HasTheSameBytesOnAnyNumberOfThreads)
{
    const std::vector<Rgbf> L = noise(100'003);
    const Display display{.exposure_ev = -0.3, .tone_map = ToneMap::PbrNeutral};
    Progress progress;
    const UnsetVector<Rgb8> alone = to_srgb8(L, display, 1, progress);
    ASSERT_EQ(alone.size(), L.size());
    for (std::size_t i = 0; i < L.size(); i += 997) {
        EXPECT_EQ(alone[i], to_srgb8(to_double(L[i]), display));
    }
    EXPECT_EQ(alone, to_srgb8(L, display, 2, progress));
    EXPECT_EQ(alone, to_srgb8(L, display, 8, progress));
    EXPECT_TRUE(to_srgb8(std::span<const Rgbf>{}, display, 2, progress).empty());
}

/// What the table gives for many against what the formula gives for each. Workers flush subnormal
/// numbers: those count as zero.
void expect_the_codes_of_the_formula(const std::vector<float>& values, const Display& display)
{
    std::vector<Rgbf> L;
    for (std::size_t i = 0; i < values.size(); ++i) {
        L.push_back({values[i], values[(i + 1) % values.size()], values[(i + 2) % values.size()]});
    }
    Progress progress;
    const UnsetVector<Rgb8> codes = to_srgb8(L, display, 1, progress);
    for (std::size_t i = 0; i < L.size(); ++i) {
        Rgbf flushed = L[i];
        for (float& band : flushed) {
            if (std::fpclassify(band) == FP_SUBNORMAL) { band = 0.0F; }
        }
        ASSERT_EQ(codes[i], to_srgb8(to_double(flushed), display))
            << L[i][0] << ' ' << L[i][1] << ' ' << L[i][2] << ", EV " << display.exposure_ev;
    }
}

TEST(Picture, HasTheCodesOfTheFormulaOnBothSidesOfEachStep)
{
    for (const double ev : {0.0, 0.3, -7.7, 12.0, 100.0}) {
        const Display display{.exposure_ev = ev};
        std::vector<float> values;
        std::uint32_t begin = 0;  // a float above zero is ordered as its bits are
        for (int code = 1; code < 256; ++code) {
            std::uint32_t end = std::bit_cast<std::uint32_t>(infinity_f);
            while (begin < end) {
                const std::uint32_t middle = begin + (end - begin) / 2;
                const double x = std::bit_cast<float>(middle);
                const bool there = to_srgb8(Rgb::grey(x), display)[0] >= code;
                (there ? end : begin) = there ? middle : middle + 1;
            }
            for (std::uint32_t bits = begin - std::min(begin, 4U); bits <= begin + 4; ++bits) {
                values.push_back(std::bit_cast<float>(bits));
            }
        }
        expect_the_codes_of_the_formula(values, display);
    }
}

TEST(Picture, HasTheCodesOfTheFormulaForAnyFloat)
{
    std::mt19937 random(5);
    std::vector<float> values{-0.0F,      0.0F,       1.0F,   std::nextafter(1.0F, 0.0F),
                              0.0031308F, -1.0F,      1e-45F, 0x1p-13F,
                              infinity_f, -infinity_f};
    for (int i = 0; i < 200'000; ++i) {
        values.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random())));
    }
    for (const Rgbf& x : noise(100'000)) { values.push_back(x[0]); }
    for (const double ev : {0.0, 1.1, -2000.0, 2000.0}) {
        expect_the_codes_of_the_formula(values, {.exposure_ev = ev});
    }
    values.resize(20'000);
    for (const ToneMap map : maps) {
        expect_the_codes_of_the_formula(values, {.exposure_ev = 0.5, .tone_map = map});
    }
}

TEST(AutoExposure, PutsTheNinetyFifthPercentileAtFourFifths)
{
    std::vector<Rgbf> L;
    for (int i = 1; i <= 100; ++i) {
        const float x = 0.01F * static_cast<float>(i);
        L.push_back({x, x, x});
    }
    L.resize(5000);  // darkness around does not count
    L.push_back({std::numeric_limits<float>::infinity(), 0.0F, 0.0F});
    L.push_back({std::numeric_limits<float>::quiet_NaN(), 1.0F, 1.0F});
    EXPECT_NEAR(0.95 * exposure_scale(auto_exposure_ev(L)), 0.8, 1e-6);
}

TEST(AutoExposure, UndoesTheScaleOfTheLight)
{
    std::vector<Rgbf> L = noise(1000);
    const double ev = auto_exposure_ev(L);
    for (Rgbf& x : L) { x = {x[0] * 8.0F, x[1] * 8.0F, x[2] * 8.0F}; }
    EXPECT_NEAR(auto_exposure_ev(L), ev - 3.0, 1e-9);
}

TEST(AutoExposure, LeavesTheDarkAlone)
{
    EXPECT_EQ(auto_exposure_ev({}), 0.0);
    EXPECT_EQ(auto_exposure_ev(std::vector<Rgbf>(10)), 0.0);
}

}  // namespace
}  // namespace relight
