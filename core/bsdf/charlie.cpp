#include "core/bsdf/charlie.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/bsdf/mix.h"
#include "core/bsdf/roughness.h"

namespace relight::charlie {
namespace {

constexpr double pi = std::numbers::pi;

/// The exponent of Lambda below 60 degrees.
double fit(double x, double alpha)
{
    const auto [a, b, c, d, e] = Lambda_fit(alpha);
    return a / (1.0 + b * std::pow(x, c)) + d * x + e;
}

double D_of_sin2(double sin2, double alpha)
{
    return (2.0 + 1.0 / alpha) * std::pow(sin2, 0.5 / alpha) / (2.0 * pi);
}

/// E over cos = t^3 and ln(alpha), both in equal steps: the lobe crowds toward grazing, and the
/// more so the narrower it is.
class AlbedoTable {
  public:
    AlbedoTable()
    {
        for (int row = 0; row < rows; ++row) { fill(row); }
    }

    double at(double cos_o, double alpha) const
    {
        const auto [row, y] = place(alpha);
        const double x = std::cbrt(cos_o) * (columns - 1);
        const int column = std::clamp(static_cast<int>(x), 0, columns - 2);
        const auto along = [&](int r) {
            const auto& line = E_[static_cast<std::size_t>(r)];
            const auto c = static_cast<std::size_t>(column);
            return mix(line[c], line[c + 1], x - column);
        };
        return mix(along(row), along(row + 1), y - row);
    }

    std::array<double, albedo_columns> line(double alpha) const
    {
        const auto [row, y] = place(alpha);
        const auto r = static_cast<std::size_t>(row);
        std::array<double, albedo_columns> mixed{};
        for (std::size_t c = 0; c < columns; ++c) {
            mixed[c] = mix(E_[r][c], E_[r + 1][c], y - row);
        }
        return mixed;
    }

  private:
    static constexpr int rows = 48, columns = albedo_columns;
    static constexpr int panels = 6, turns = 24;
    const double row_step_ = std::log(1.0 / least_alpha) / (rows - 1);
    std::array<std::array<double, columns>, rows> E_{};

    struct Place {
        int row;
        double y;  ///< in rows, from the first
    };
    Place place(double alpha) const
    {
        const double y = std::log(alpha / least_alpha) / row_step_;
        return {std::clamp(static_cast<int>(y), 0, rows - 2), y};
    }
    void fill(int row);
};

/// E(wo) = int D V cos_i dwi over cos_i = t^3 (Gauss, four points a panel) and half the azimuth
/// (midpoints: the integrand is even and periodic, so the error falls exponentially).
void AlbedoTable::fill(int row)
{
    constexpr std::array<double, 4> x{-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                      0.8611363115940526};
    constexpr std::array<double, 4> w{0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                      0.3478548451374538};
    struct Ring {
        double cos_i, weight, shadow;
    };
    const double alpha = least_alpha * std::exp(row * row_step_);
    std::vector<Ring> rings;
    for (int panel = 0; panel < panels; ++panel) {
        for (std::size_t k = 0; k < x.size(); ++k) {
            const double t = (panel + 0.5 + 0.5 * x[k]) / panels;
            const double cos_i = t * t * t;
            rings.push_back({cos_i, 3.0 * t * t * 0.5 * w[k] / panels, Lambda(cos_i, alpha)});
        }
    }
    std::array<double, turns> cos_phi{};
    for (std::size_t j = 0; j < turns; ++j) {
        cos_phi[j] = std::cos(pi * (static_cast<double>(j) + 0.5) / turns);
    }
    for (std::size_t column = 0; column < columns; ++column) {
        constexpr double least_cos = 1e-6;  // below, V's 1 / cos outgrows the fit of Lambda
        const double t = static_cast<double>(column) / (columns - 1);
        const double cos_o = std::max(least_cos, t * t * t);
        const double Lambda_o = Lambda(cos_o, alpha);
        double sum = 0.0;
        for (const Ring& ring : rings) {
            const double both = ring.cos_i + cos_o, cc = ring.cos_i * cos_o;
            const double ss = std::sqrt((1.0 - ring.cos_i * ring.cos_i) * (1.0 - cos_o * cos_o));
            double D_sum = 0.0;
            for (const double c : cos_phi) {  // cos_m = (cos_i + cos_o) / |wi + wo|
                const double sin2 = 1.0 - both * both / (2.0 + 2.0 * (ss * c + cc));
                D_sum += D_of_sin2(std::max(0.0, sin2), alpha);
            }
            sum += ring.weight * D_sum / (4.0 * cos_o * (1.0 + ring.shadow + Lambda_o));
        }
        E_[static_cast<std::size_t>(row)][column] = sum * 2.0 * pi / turns;
    }
}

const AlbedoTable& albedos()
{
    static const AlbedoTable table;
    return table;
}

}  // namespace

double D(Vec3 m, double alpha)
{
    return D_of_sin2(m.x * m.x + m.y * m.y, alpha);
}

std::array<double, 5> Lambda_fit(double alpha)
{
    const double t = (1.0 - alpha) * (1.0 - alpha);  // mixes the coefficients
    return {mix(21.5473, 25.3245, t), mix(3.82987, 3.32435, t), mix(0.19823, 0.16801, t),
            mix(-1.97760, -1.27393, t), mix(-4.32054, -4.85967, t)};
}

double Lambda(double cos_w, double alpha)
{
    if (cos_w < 0.5) { return std::exp(fit(cos_w, alpha)); }
    return std::exp(2.0 * fit(0.5, alpha) - fit(std::max(0.0, 1.0 - cos_w), alpha));
}

double V(double cos_i, double cos_o, double alpha)
{
    constexpr double least = 1e-100;  // both directions in the plane: large, but still a number
    const double shadowed = 1.0 + Lambda(cos_i, alpha) + Lambda(cos_o, alpha);
    return 0.25 / (shadowed * std::max(cos_i * cos_o, least));
}

double E(double cos_o, double alpha)
{
    return std::min(1.0, albedos().at(cos_o, alpha));
}

std::array<double, albedo_columns> E_over_cosines(double alpha)
{
    return albedos().line(alpha);
}

}  // namespace relight::charlie
