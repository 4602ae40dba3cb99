#include "core/check/meters.h"

#include <map>

#include "core/shade/shade.h"

namespace relight {

Light light_of(LightShape shape, double power)
{
    Light light;
    light.name = "light";
    light.shape = std::move(shape);
    light.power = Rgb::grey(power);
    return light;
}

Scene lit_by(std::vector<Light> lights, unsigned samples)
{
    Scene scene;
    scene.lights = std::move(lights);
    scene.transport.samples = samples;
    return scene;
}

Mesh quads(const std::vector<Point3>& corners)
{
    Mesh mesh;
    mesh.positions = corners;
    mesh.double_positions = true;
    for (std::uint32_t i = 0; i + 3 < corners.size(); i += 4) {
        mesh.faces.indices.insert(mesh.faces.indices.end(), {i, i + 1, i + 2, i, i + 2, i + 3});
    }
    return mesh;
}

Mesh joined(Mesh a, const Mesh& b)
{
    const auto shift = static_cast<std::uint32_t>(a.positions.size());
    a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
    for (const std::uint32_t i : b.faces.indices) { a.faces.indices.push_back(i + shift); }
    return a;
}

Mesh ball(int levels)
{
    Mesh mesh;
    mesh.double_positions = true;
    auto& p = mesh.positions;
    auto& f = mesh.faces.indices;
    p = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    f = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto next = static_cast<std::uint32_t>(p.size());
            const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), next);
            if (is_new) {
                const Point3 between = p[a] + (p[b] - p[a]) * 0.5;
                p.push_back(Point3{} + Vec3(normalize(between - Point3{})));
            }
            return at->second;
        };
        std::vector<std::uint32_t> finer;
        for (std::size_t t = 0; t < f.size(); t += 3) {
            const std::uint32_t a = f[t], b = f[t + 1], c = f[t + 2];
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
        }
        f = std::move(finer);
    }
    return mesh;
}

Mesh inside_out(Mesh mesh)
{
    auto& f = mesh.faces.indices;
    for (std::size_t t = 0; t < f.size(); t += 3) { std::swap(f[t + 1], f[t + 2]); }
    return mesh;
}

Mesh floor_with_block()
{
    return quads({{-50, -50, 0},
                  {50, -50, 0},
                  {50, 50, 0},
                  {-50, 50, 0},
                  {48, 48, 0.5},
                  {49, 48, 0.5},
                  {49, 49, 0.5},
                  {48, 49, 0.5}});
}

Mesh speck()
{
    return quads({{0, 0, 60}, {0.01, 0, 60}, {0.01, 0.01, 60}, {0, 0.01, 60}});
}

Meters::Meters(const Mesh& around, const std::vector<Meter>& places)
    : first(around.positions.size()), count(places.size())
{
    Mesh mesh = around;
    mesh.normals.resize(first);  // zero: the faces'
    for (const Meter& meter : places) {
        mesh.positions.push_back(meter.p);
        mesh.normals.push_back(meter.n);
    }
    mesh.double_positions = true;
    Progress unseen;
    stage.mesh = std::make_shared<const Mesh>(std::move(mesh));
    stage.surface = std::make_shared<const Surface>(prepare(*stage.mesh, 1, unseen));
    stage.bvh = std::make_shared<const Bvh>(*stage.mesh, *stage.surface);
}

std::vector<Reading> read(const Mesh& around, const std::vector<Meter>& places, const Scene& scene)
{
    const Meters meters(around, places);
    Progress unseen;  // of work so short
    const Transport transport =
        trace(meters.stage, scene, {.radiance = true, .threads = 1}, unseen);
    const Shaded shaded = shade(meters.stage, transport, scene,
                                {.per_light = true, .standard_error = true, .threads = 1}, unseen);
    const auto red = [](std::span<const Rgbf> values, std::size_t v) {
        return static_cast<double>(values[v][0]);
    };
    std::vector<Reading> readings;
    for (std::size_t v = meters.first; v < meters.first + meters.count; ++v) {
        Reading reading{{red(shaded.irradiance, v), red(shaded.standard_error, v)},
                        red(shaded.radiance, v),
                        {}};
        for (const auto& one : shaded.per_light) { reading.per_light.push_back(red(one, v)); }
        readings.push_back(std::move(reading));
    }
    return readings;
}

Drawn read_one(const Light& light, Meter meter)
{
    return read(floor_with_block(), {meter}, lit_by({light}))[0].E;
}

double read_alone(const Light& light, Meter meter)
{
    return read(speck(), {meter}, lit_by({light}))[0].E.value;
}

std::vector<Bounced> read_column(const Meters& meters, const Scene& scene)
{
    const Column part = column(meters.stage, scene, 0, meters.first, meters.first + meters.count);
    const double power = scene.lights[0].power.r;
    const auto red = [&](const std::vector<float>& values, std::size_t i) {
        const std::size_t bands = values.size() / meters.count;
        return bands == 0 ? 0.0 : power * static_cast<double>(values[bands * i]);
    };
    std::vector<Bounced> readings;
    for (std::size_t i = 0; i < meters.count; ++i) {
        const double bounced = red(part.E_bounced, i);
        readings.push_back({{red(part.E, i) + bounced, red(part.standard_error, i)}, bounced});
    }
    return readings;
}

Light shining(const Mesh& mesh, std::size_t faces, double power)
{
    std::vector<Emitter> emitters(faces);
    for (std::uint32_t t = 0; t < faces; ++t) {
        for (std::size_t c = 0; c < 3; ++c) {
            emitters[t].corners[c] = mesh.positions[mesh.faces.indices[std::size_t{3} * t + c]];
        }
        emitters[t].primitive = t;
        emitters[t].L = Rgb::grey(1.0);
    }
    return light_of(MeshLight{std::make_shared<const EmitterTable>(std::move(emitters))}, power);
}

}  // namespace relight
