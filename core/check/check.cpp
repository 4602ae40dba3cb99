#include "core/check/check.h"

#include <cmath>
#include <iterator>

#include "core/check/cases.h"

namespace relight {
namespace {

constexpr Subject subjects[] = {
    check_points,        check_polygons,        check_round_lights,  check_skies,
    check_blockers,      check_standard_error,  check_bounces,       check_laws,
    check_light_samples, check_fresnel,         check_distributions, check_materials,
    check_energy,        check_material_samples};

}  // namespace

bool CheckCase::pass() const
{
    return std::isfinite(expected) && std::isfinite(tolerance) && std::abs(error()) <= tolerance;
}

std::vector<CheckCase> run_checks(unsigned threads, Progress& progress)
{
    std::vector<std::vector<CheckCase>> of_subject(std::size(subjects));
    progress.expect(of_subject.size());
    parallel_for(of_subject.size(), 1, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Cases cases;
            subjects[i](cases);
            of_subject[i] = cases.done();
            progress.advance(1);
        }
    });
    std::vector<CheckCase> all;
    for (auto& cases : of_subject) {
        all.insert(all.end(), std::move_iterator(cases.begin()), std::move_iterator(cases.end()));
    }
    return all;
}

}  // namespace relight
