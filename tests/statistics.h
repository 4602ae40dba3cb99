#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace relight::test {

/// Errors of random estimates in units of their own standard errors, over a whole file of cases:
/// none beyond 4, at most 1 % (or two) beyond 3, and their rms near 1: a small one means errors
/// that are correlated or made up, a large one a bias (contract sections 2 and 12).
class NormalisedErrors {
  public:
    /// `slack`: what the expected value itself may be off (its tolerance).
    void add(double difference, double standard_error, double slack, const std::string& place)
    {
        ASSERT_TRUE(std::isfinite(difference) && std::isfinite(standard_error)) << place;
        ASSERT_GE(standard_error, 0.0) << place;
        EXPECT_LE(std::abs(difference), 4.0 * standard_error + slack)
            << place << ": standard error " << standard_error;
        // Where nothing varied there is no error to judge: the band is then a bound.
        if (!(standard_error > slack)) { return; }
        const double z = difference / standard_error;
        if (std::abs(z) > 3.0) { ++beyond_3_; }
        squares_ += z * z;
        ++count_;
    }
    void expect_honest(double least = 0.7, double most = 1.35) const
    {
        ASSERT_GT(count_, 0);
        EXPECT_LE(beyond_3_, std::max(2, count_ / 100));
        const double rms = std::sqrt(squares_ / count_);
        EXPECT_GE(rms, least) << count_ << " cases";
        EXPECT_LE(rms, most) << count_ << " cases";
    }
    int count() const { return count_; }

  private:
    int count_ = 0, beyond_3_ = 0;
    double squares_ = 0.0;
};

}  // namespace relight::test
