#include "core/check/cases.h"

#include <cmath>
#include <cstdio>

namespace relight {
namespace {

std::string short_number(double x)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", x);
    return text;
}

}  // namespace

void Cases::add(std::string name, std::string formula, double expected, double computed,
                double tolerance, std::string kind)
{
    cases_.push_back({std::move(name), group_, std::move(formula), unit_, expected, computed,
                      tolerance, std::move(kind)});
}

void Cases::relative(std::string name, std::string formula, double expected, double computed,
                     double share)
{
    add(std::move(name), std::move(formula), expected, computed, share * std::abs(expected),
        "relative " + short_number(share));
}

void Cases::absolute(std::string name, std::string formula, double expected, double computed,
                     double most)
{
    add(std::move(name), std::move(formula), expected, computed, most,
        "absolute " + short_number(most));
}

void Cases::exact(std::string name, std::string formula, double expected, double computed)
{
    add(std::move(name), std::move(formula), expected, computed, 0.0, "exact");
}

void Cases::drawn(std::string name, std::string formula, double expected, Drawn computed,
                  double share)
{
    constexpr double most = 0.05;
    const double size = std::abs(expected);
    const double four = std::fmin(4.0 * computed.standard_error, most * size);
    add(std::move(name), std::move(formula), expected, computed.value, four + share * size,
        "4 standard errors (at most 5 %) + relative " + short_number(share));
}

}  // namespace relight
