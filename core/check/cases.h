#pragma once

#include <string>
#include <vector>

#include "core/check/check.h"

namespace relight {

/// A value that was drawn, and the error that it claims.
struct Drawn {
    double value{}, standard_error{};
};

/// Collects the cases of one subject, group by group.
class Cases {
  public:
    /// What follows is of this group, in this unit.
    void group(std::string name, std::string unit)
    {
        group_ = std::move(name);
        unit_ = std::move(unit);
    }

    void relative(std::string name, std::string formula, double expected, double computed,
                  double share = 1e-6);
    void absolute(std::string name, std::string formula, double expected, double computed,
                  double most);
    /// Neither more nor less: what is hidden is dark.
    void exact(std::string name, std::string formula, double expected, double computed);
    /// Within 4 standard errors, but never more than 5 %: a claim of much error proves nothing.
    /// `share` of the value is allowed besides (rounding, flat faces for round ones).
    void drawn(std::string name, std::string formula, double expected, Drawn computed,
               double share = 1e-6);

    std::vector<CheckCase> done() { return std::move(cases_); }

  private:
    void add(std::string name, std::string formula, double expected, double computed,
             double tolerance, std::string kind);

    std::string group_, unit_;
    std::vector<CheckCase> cases_;
};

/// A subject: a file here, and a line here.
using Subject = void (*)(Cases&);
void check_points(Cases& cases);
void check_polygons(Cases& cases);
void check_round_lights(Cases& cases);
void check_light_samples(Cases& cases);
void check_skies(Cases& cases);
void check_blockers(Cases& cases);
void check_standard_error(Cases& cases);
void check_bounces(Cases& cases);
void check_laws(Cases& cases);
void check_distributions(Cases& cases);
void check_fresnel(Cases& cases);
void check_materials(Cases& cases);
void check_energy(Cases& cases);
void check_material_samples(Cases& cases);

}  // namespace relight
