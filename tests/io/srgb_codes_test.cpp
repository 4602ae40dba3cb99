#include "core/io/srgb_codes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace relight {
namespace {

TEST(CodesOf, EveryCodeIsFoundAndNoNeighbourOfOneIs)
{
    const std::vector<float> table = decoded_srgb(255);
    for (std::size_t code = 0; code < 256; ++code) {
        const float x = table[code];
        const auto byte = static_cast<unsigned char>(code);
        EXPECT_EQ(codes_of(std::vector<Rgbf>{{x, 0.0F, 1.0F}}),
                  (std::vector<Rgb8>{{byte, 0, 255}}));
        for (const float other : {std::nextafter(x, -1.0F), std::nextafter(x, 2.0F)}) {
            EXPECT_TRUE(codes_of(std::vector<Rgbf>{{x, x, x}, {x, x, other}}).empty()) << code;
        }
    }
    for (const float none : {-1.0F, 1.5F, NAN, INFINITY, -INFINITY}) {
        EXPECT_TRUE(codes_of(std::vector<Rgbf>{{none, 0.0F, 0.0F}}).empty()) << none;
    }
}

}  // namespace
}  // namespace relight
