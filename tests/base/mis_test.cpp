#include "core/base/mis.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/random.h"
#include "tests/oracle.h"

namespace relight {
namespace {

TEST(Mis, EveryOracleCaseAgrees)
{
    const nlohmann::json file = test::oracle("mis_units_jacobian");
    const test::Tolerance tolerance(file["tolerance"]);
    int checked = 0;
    for (const nlohmann::json& c : file["cases"]) {
        if (c["kind"] != "mis") { continue; }
        SCOPED_TRACE(c["id"].get<std::string>());
        ASSERT_FALSE(c.contains("tolerance"));  // none has its own; if one comes, obey it
        const double n1 = c["n"][0], n2 = c["n"][1], p1 = c["pdf"][0], p2 = c["pdf"][1];
        EXPECT_TRUE(tolerance.holds(mis::balance(n1, p1, n2, p2), c["balance"]));
        EXPECT_TRUE(tolerance.holds(mis::power2(n1, p1, n2, p2), c["power2"]));
        ++checked;
    }
    EXPECT_GT(checked, 0);
}

TEST(Mis, WeightsOfOneDirectionAddUpToOne)
{
    constexpr double infinite = std::numeric_limits<double>::infinity();
    constexpr double least = std::numeric_limits<double>::denorm_min();
    for (const double p1 : {0.0, least, 1e-200, 0.3, 7.0, 1e200, infinite}) {
        for (const double p2 : {0.0, least, 1e-200, 0.3, 7.0, 1e200, infinite}) {
            SCOPED_TRACE(testing::Message() << p1 << ' ' << p2);
            const double drawn = p1 > 0.0 || p2 > 0.0 ? 1.0 : 0.0;  // else by neither: no weight
            for (const double n : {1.0, 16.0}) {
                EXPECT_NEAR(mis::balance(n, p1, 4.0, p2) + mis::balance(4.0, p2, n, p1), drawn,
                            1e-15);
                EXPECT_NEAR(mis::power2(n, p1, 4.0, p2) + mis::power2(4.0, p2, n, p1), drawn,
                            1e-15);
            }
        }
    }
}

TEST(Mis, TwoSamplersTogetherEstimateTheIntegralOfTheOneThatMissesPartOfIt)
{
    // int_0^1 x^2 dx: one sampler uniform over [0, 1/2], the other with density 2x over [0, 1].
    const auto p1 = [](double x) { return x < 0.5 ? 2.0 : 0.0; };
    const auto p2 = [](double x) { return 2.0 * x; };
    constexpr int n = 20000;
    for (const auto weight : {mis::balance, mis::power2}) {
        double sum = 0.0, squares = 0.0;
        for (std::uint64_t i = 0; i < n; ++i) {
            const double a = 0.5 * uniform(3, 0, i, 0), b = std::sqrt(uniform(3, 0, i, 1));
            const double x = weight(1.0, p1(a), 1.0, p2(a)) * a * a / p1(a) +
                             weight(1.0, p2(b), 1.0, p1(b)) * b * b / p2(b);
            sum += x;
            squares += x * x;
        }
        const double mean = sum / n;
        EXPECT_NEAR(mean, 1.0 / 3.0, 4.0 * std::sqrt((squares / n - mean * mean) / n));
    }
}

}  // namespace
}  // namespace relight
