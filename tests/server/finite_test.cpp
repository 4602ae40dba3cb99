#include "server/finite.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace relight {
namespace {

constexpr float largest = std::numeric_limits<float>::max();
constexpr float infinity = std::numeric_limits<float>::infinity();

TEST(ClampToFinite, CutsWhatIsBeyondSinglePrecisionWhereverItStands)
{
    constexpr std::size_t vertices = 70'001;  // two blocks and a tail
    for (const std::size_t at :
         {std::size_t{0}, std::size_t{32'767}, std::size_t{32'768}, vertices - 1}) {
        for (std::size_t band = 0; band < 3; ++band) {
            for (const float beyond : {infinity, std::numeric_limits<float>::quiet_NaN()}) {
                std::vector<Rgbf> values(vertices, Rgbf{0, 1, largest});
                std::vector<Rgbf> expected = values;
                values[at][band] = beyond;
                expected[at][band] = largest;
                EXPECT_EQ(clamp_to_finite(values, 2), 1U);
                EXPECT_EQ(values, expected) << at;
            }
        }
    }
}

TEST(ClampToFinite, LeavesAllElse)
{
    std::vector<Rgbf> values{{0, 1, largest}, {1e-45F, 3, 4}}, none;
    const std::vector<Rgbf> before = values;
    EXPECT_EQ(clamp_to_finite(values, 1), 0U);
    EXPECT_EQ(values, before);
    EXPECT_EQ(clamp_to_finite(none, 1), 0U);
}

}  // namespace
}  // namespace relight
