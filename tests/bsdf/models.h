#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/base/quantity.h"
#include "core/base/vec.h"
#include "core/bsdf/terms.h"
#include "tests/bsdf/quadrature.h"

/// What every material model promises, whatever it computes.
namespace relight::test {

using Random = std::mt19937_64;

inline double unit(Random& random)
{
    return std::uniform_real_distribution<double>(0.0, 1.0)(random);
}
inline Rgb any_color(Random& random)
{
    return {unit(random), unit(random), unit(random)};
}
/// 0 and 1 are worth more than chance gives them.
inline double any_weight(Random& random)
{
    const double x = 2.0 * unit(random) - 0.5;
    return std::min(1.0, std::max(0.0, x));
}
inline Vec3 any_direction(Random& random)
{
    return direction(std::max(1e-3, unit(random)), 2.0 * std::numbers::pi * unit(random));
}

/// int f(wi, wo) cos_i dwi over the hemisphere, by Gauss in theta and azimuth. Where wi faces wo
/// the half vector turns fast, the faster the nearer both are to the plane: panels crowd there.
template <class Model>
Rgb albedo(const Model& model, Vec3 wo, int panels = 32)
{
    constexpr double pi = std::numbers::pi;
    const double facing = std::atan2(wo.y, wo.x) + pi;
    const auto ring = [&](double theta) {
        const auto around = [&](double t) {
            const Vec3 wi = direction(std::cos(theta), facing + pi * t * t * t);
            return f(model, wi, wo, {}).value * (3.0 * pi * t * t);
        };
        return over_interval(around, -1.0, 1.0, 16) * (std::cos(theta) * std::sin(theta));
    };
    return over_interval(ring, 0.0, 0.5 * pi, panels);
}

inline Rgb term(const std::vector<BsdfTerm>& terms, const std::string& name)
{
    for (const BsdfTerm& t : terms) {
        if (t.name == name) { return t.value; }
    }
    ADD_FAILURE() << "no term " << name;
    return {};
}

inline void expect_near(Rgb x, Rgb expected, double relative)
{
    EXPECT_NEAR(x.r, expected.r, relative * std::abs(expected.r));
    EXPECT_NEAR(x.g, expected.g, relative * std::abs(expected.g));
    EXPECT_NEAR(x.b, expected.b, relative * std::abs(expected.b));
}

template <class MakeModel>
void expect_reciprocal(MakeModel any_model)
{
    Random random(5);
    for (int i = 0; i < 300; ++i) {
        const auto model = any_model(random);
        for (int j = 0; j < 30; ++j) {
            const Vec3 wi = any_direction(random), wo = any_direction(random);
            expect_near(f(model, wi, wo, {}).value, f(model, wo, wi, {}).value, 1e-9);
        }
    }
}

/// Directions in every corner: along the normal, in the plane, opposite, below.
template <class MakeModel>
void expect_finite_and_not_negative(MakeModel any_model)
{
    Random random(9);
    const auto signed_unit = [&] { return 2.0 * unit(random) - 1.0; };
    const auto corner = [&]() -> Vec3 {
        const double height = std::pow(10.0, -320.0 * unit(random));
        switch (static_cast<int>(6.0 * unit(random))) {
            case 0:
                return {0.0, 0.0, 1.0};
            case 1:
                return normalize({signed_unit(), signed_unit(), height});
            case 2:
                return {1.0, 0.0, height};
            case 3:
                return {-1.0, 0.0, height};
            case 4:
                return normalize({1e-200, 1e-9 * signed_unit(), 1.0});
            default:
                return normalize({signed_unit(), signed_unit(), signed_unit()});
        }
    };
    for (int i = 0; i < 200; ++i) {
        const auto model = any_model(random);
        const Rgb vertex = any_color(random);
        for (int j = 0; j < 200; ++j) {
            const Vec3 wi = corner();
            const Vec3 wo = j % 10 == 0 ? wi : corner();
            for (const BsdfTerm& t : terms(model, wi, wo, vertex)) {
                for (const double band : {t.value.r, t.value.g, t.value.b}) {
                    ASSERT_TRUE(std::isfinite(band)) << t.name << ' ' << wi.z << ' ' << wo.z;
                    ASSERT_FALSE(std::signbit(band)) << t.name << ' ' << wi.z << ' ' << wo.z;
                }
            }
            if (wi.z <= 0.0 || wo.z <= 0.0) { ASSERT_EQ(f(model, wi, wo, vertex), BsdfValue{}); }
        }
    }
}

/// The entry "f" is f bit for bit, and what the summands named add up to.
template <class MakeModel>
void expect_terms_that_make_f(MakeModel any_model, const std::vector<std::string>& summands)
{
    Random random(3);
    for (int i = 0; i < 500; ++i) {
        const auto model = any_model(random);
        const Vec3 wi = any_direction(random), wo = any_direction(random);
        const Rgb vertex = any_color(random);
        const std::vector<BsdfTerm> all = terms(model, wi, wo, vertex);
        Rgb sum;
        for (const std::string& name : summands) { sum += term(all, name); }
        EXPECT_EQ(term(all, "f"), f(model, wi, wo, vertex).value);
        expect_near(sum, term(all, "f"), 1e-12);
    }
}

/// "specular" is F D G2 / (4 cos_i cos_o) and V is G2 over that denominator.
template <class MakeModel>
void expect_facets_of_three_factors(MakeModel any_model)
{
    Random random(4);
    for (int i = 0; i < 500; ++i) {
        const auto model = any_model(random);
        const Vec3 wi = any_direction(random), wo = any_direction(random);
        const std::vector<BsdfTerm> all = terms(model, wi, wo, {});
        const Rgb G2 = term(all, "G2"), product = term(all, "F") * term(all, "D") * G2;
        expect_near(term(all, "specular"), product / (4.0 * wi.z * wo.z), 1e-12);
        expect_near(term(all, "V") * (4.0 * wi.z * wo.z), G2, 1e-12);
        EXPECT_LE(G2.r, 1.0 + 1e-12);
    }
}

}  // namespace relight::test
