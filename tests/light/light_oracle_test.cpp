#include <gtest/gtest.h>

#include "core/light/light.h"
#include "tests/oracle.h"

namespace relight {
namespace {

using nlohmann::json;

Dir3 direction(const json& j)
{
    return normalize(test::vec_of(j));
}

SpotLight spot_of(const json& j)
{
    SpotLight light;
    if (j.contains("position")) { light.position = test::point_of(j["position"]); }
    if (j.contains("axis")) { light.axis = direction(j["axis"]); }
    light.inner_cone = j["inner_cone"];
    light.outer_cone = j["outer_cone"];
    return light;
}

/// A light of the file, its power already turned from flux to intensity where that is what is
/// given.
Light light_of(const json& j)
{
    const std::string type = j["type"];
    const Rgb color = j.contains("color") ? test::rgb_of(j["color"]) : Rgb::grey(1.0);
    const auto number = [&](const char* key) { return j[key].get<double>(); };
    Light light;
    if (type == "point") {
        PointLight point{test::point_of(j["position"]), {}};
        if (j.contains("range")) { point.range = number("range"); }
        light.shape = point;
        light.power = j.contains("flux") ? intensity_of_flux(point, {color * number("flux")}).value
                                         : color * number("intensity");
    } else if (type == "spot") {
        light.shape = spot_of(j);
        light.power = color * number("intensity");
    } else {
        EXPECT_EQ(type, "directional");
        light.shape = DirectionalLight{direction(j["travel_direction"])};
        light.power = color * number("E_perp");
    }
    return light;
}

Rgb reference(const Light& light, Point3 p, Dir3 n)
{
    if (const auto* point = std::get_if<PointLight>(&light.shape)) {
        return irradiance(*point, {light.power}, p, n).value;
    }
    if (const auto* spot = std::get_if<SpotLight>(&light.shape)) {
        return irradiance(*spot, {light.power}, p, n).value;
    }
    return irradiance(std::get<DirectionalLight>(light.shape), {light.power}, n).value;
}

/// E the way transport and shade go: a column's unit arrival, then the power.
Rgb from_arrival(const Light& light, Point3 p, Dir3 n)
{
    const Arrival arrival = arrive(light.shape, p);
    return light.power * (arrival.per_unit * std::max(0.0, dot(n, arrival.wi)));
}

TEST(PunctualOracle, EveryCaseAgreesByFormulaAndByArrival)
{
    const json file = test::oracle("lights_punctual");
    double largest = 0.0;  // the file's abs is a fraction of it
    for (const json& c : file["cases"]) {
        if (!c.contains("E")) { continue; }
        const json& E = c["E"];
        for (const double e :
             E.is_array() ? E.get<std::vector<double>>() : std::vector<double>{E}) {
            largest = std::max(largest, e);
        }
    }
    const test::Tolerance of_file(file["tolerance"]);
    const test::Tolerance tolerance(of_file.rel, of_file.abs * largest);
    // The same without the absolute part, which would forgive every dim case beside the brightest.
    const test::Tolerance strict(1e-9, 1e-15);

    std::size_t checked = 0;
    for (const json& c : file["cases"]) {
        SCOPED_TRACE(c["id"].get<std::string>());
        if (c.contains("total_flux")) {
            const double I = c["light"]["intensity"], Phi = c["total_flux"];
            const SpotLight spot = spot_of(c["light"]);
            EXPECT_PRED2([&](double x, double e) { return tolerance.holds(x, e); },
                         I * emission_solid_angle(spot), Phi);
            EXPECT_NEAR(intensity_of_flux(spot, {Rgb::grey(Phi)}).value.g / I, 1.0, 1e-9);
        } else {
            const Light light = light_of(c["light"]);
            const Point3 p = test::point_of(c["p"]);
            const Dir3 n = direction(c["n"]);
            const Rgb expected =
                c["E"].is_array() ? test::rgb_of(c["E"]) : Rgb::grey(c["E"].get<double>());
            for (const Rgb E : {reference(light, p, n), from_arrival(light, p, n)}) {
                for (const auto& [x, e] : {std::pair{E.r, expected.r}, std::pair{E.g, expected.g},
                                           std::pair{E.b, expected.b}}) {
                    EXPECT_TRUE(tolerance.holds(x, e)) << x << " for " << e;
                    EXPECT_TRUE(strict.holds(x, e)) << x << " for " << e;
                }
            }
        }
        ++checked;
    }
    EXPECT_EQ(checked, file["case_count"].get<std::size_t>());
    EXPECT_GT(checked, 0U);
}

}  // namespace
}  // namespace relight
