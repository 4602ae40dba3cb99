#include <chrono>
#include <cstddef>

#include "core/light/sky.h"

namespace relight {
namespace {

bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/// Takes a text apart from its front; once something does not fit, it stays failed.
struct Reader {
    std::string_view rest;
    bool ok = true;

    /// `digits` decimal digits, within [least, most].
    int number(std::size_t digits, int least, int most)
    {
        int value = 0;
        ok = ok && rest.size() >= digits;
        for (std::size_t i = 0; ok && i < digits; ++i) {
            ok = is_digit(rest[i]);
            value = 10 * value + (rest[i] - '0');
        }
        if (!ok) { return 0; }
        rest.remove_prefix(digits);
        ok = value >= least && value <= most;
        return value;
    }
    /// Whether the next character is one of these, which is then taken.
    bool take(std::string_view any_of)
    {
        const bool fits = ok && !rest.empty() && any_of.find(rest.front()) != any_of.npos;
        if (fits) { rest.remove_prefix(1); }
        return fits;
    }
    void need(std::string_view any_of) { ok = take(any_of); }
};

/// ".25" or nothing: seconds.
double fraction(Reader& in)
{
    if (!in.take(".")) { return 0.0; }
    in.ok = !in.rest.empty() && is_digit(in.rest.front());
    double value = 0.0, unit = 0.1;
    for (; !in.rest.empty() && is_digit(in.rest.front()); unit *= 0.1) {
        value += (in.rest.front() - '0') * unit;
        in.rest.remove_prefix(1);
    }
    return value;
}

/// "Z", "+hh:mm" or "-hh:mm": minutes that local time is ahead of UTC.
int offset(Reader& in)
{
    if (in.take("Zz")) { return 0; }
    const bool west = !in.rest.empty() && in.rest.front() == '-';
    in.need("+-");
    const int hours = in.number(2, 0, 23);
    in.need(":");
    const int minutes = 60 * hours + in.number(2, 0, 59);
    return west ? -minutes : minutes;
}

}  // namespace

std::optional<double> rfc3339(std::string_view text)
{
    using namespace std::chrono;
    Reader in{text};
    const int y = in.number(4, 1900, 2199);
    in.need("-");
    const int m = in.number(2, 1, 12);
    in.need("-");
    const int d = in.number(2, 1, 31);
    in.need("Tt");
    const int hour = in.number(2, 0, 23);
    in.need(":");
    const int minute = in.number(2, 0, 59);
    in.need(":");
    const int second = in.number(2, 0, 60);
    const double part = fraction(in);
    const int ahead = offset(in);

    const year_month_day date{year{y}, month{static_cast<unsigned>(m)},
                              day{static_cast<unsigned>(d)}};
    if (!in.ok || !in.rest.empty() || !date.ok()) { return {}; }
    const long minutes =
        1440L * sys_days{date}.time_since_epoch().count() + 60L * hour + minute - ahead;
    // A leap second ends a UTC day, nothing else; POSIX time counts it as the first of the next.
    if (second == 60 && (minutes + 1) % 1440 != 0) { return {}; }
    return 60.0 * static_cast<double>(minutes) + second + part;
}

}  // namespace relight
