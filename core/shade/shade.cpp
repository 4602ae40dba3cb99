#include "core/shade/shade.h"

#include <algorithm>
#include <array>
#include <deque>

#include "core/shade/shining.h"

namespace relight {
namespace {

using kernel::Block;
using kernel::block_size;

constexpr std::size_t work_block = 4096;

static_assert(sizeof(Rgbf) == 3 * sizeof(float));  // the kernels write rows of three numbers

/// The `bands` values of one vertex as a colour.
Rgb at(const std::vector<float>& values, unsigned bands, std::size_t vertex)
{
    const auto band = [&](unsigned b) {
        return static_cast<double>(values[vertex * bands + (bands == 1 ? 0 : b)]);
    };
    return {band(0), band(1), band(2)};
}

}  // namespace

Rgb irradiance(const Column& column, Rgb power, std::size_t vertex)
{
    Rgb E = at(column.E, column.bands, vertex);
    if (!column.E_bounced.empty()) { E += at(column.E_bounced, 3, vertex); }
    return E * power;
}

VertexRadiance vertex_radiance(const Stage& stage, const Transport& transport, const Scene& scene,
                               std::span<const std::uint32_t> materials, std::size_t vertex)
{
    VertexRadiance radiance;
    radiance.of_lights.resize(scene.lights.size());
    const Shining shining(stage, transport, scene, vertex);
    const auto shine = [&](std::size_t /*begin*/, std::size_t /*end*/) {
        const LocalMaterial material = vertex_material(stage, scene, materials, vertex);
        Block block;
        const auto row = [](const double(&rows)[3][block_size]) {
            return Rgb{rows[0][0], rows[1][0], rows[2][0]};
        };
        if (E_tells_radiance(scene, *material)) {
            shining.fill_rho(block, *material, 0, 1);
            if (!kernel::is_seen(shining.view(), 0)) { return; }
            for (const std::size_t l : shining.lights()) {
                const Rgb E = irradiance(*transport.columns[l], scene.lights[l].power, 0);
                radiance.of_lights[l] = row(block.rho) * E * std::numbers::inv_pi;
            }
            return;
        }
        const kernel::PreparedMaterial prepared(*material);
        shining.fill(block, *material, prepared.reflector, 0, 1);
        radiance.own = row(block.L);
        block.dark = 0;
        for (std::size_t s = 0; s < shining.shares().size(); ++s) {
            for (auto& band : block.L) { band[0] = 0.0; }
            kernel::shine(block,
                          shining.task(prepared.reflector, shining.shares().subspan(s, 1), nullptr),
                          0, 1);
            radiance.of_lights[shining.lights()[s]] = row(block.L);
        }
    };
    // On a thread as shade()'s are: they flush denormals.
    Progress progress;
    parallel_for(1, 1, 1, progress, shine);
    return radiance;
}

namespace {

float* rows_of(UnsetVector<Rgbf>& values)
{
    return values.empty() ? nullptr : values.data()->data();
}

/// The lights' columns, and where their parts go.
std::vector<kernel::Summand> summands(const Transport& transport, const Scene& scene,
                                      Shaded& shaded)
{
    std::vector<kernel::Summand> lights;
    for (std::size_t l = 0; l < transport.columns.size(); ++l) {
        const Column* column = transport.columns[l].get();
        if (column == nullptr) { continue; }
        kernel::Summand light;
        light.E = column->E.data();
        light.E_bands = column->bands;
        if (!column->E_bounced.empty()) { light.bounced = column->E_bounced.data(); }
        if (!column->standard_error.empty()) { light.error = column->standard_error.data(); }
        light.error_bands = column->E_bounced.empty() ? column->bands : 3;
        const Rgb power = scene.lights[l].power;
        std::copy_n(std::array{power.r, power.g, power.b}.data(), 3, light.power);
        if (!shaded.per_light.empty()) { light.per_light = rows_of(shaded.per_light[l]); }
        lights.push_back(light);
    }
    return lights;
}

/// Room for what is asked for, in which only lights without a column have their 0.
Shaded sized(const Transport& transport, const ShadeOptions& options, std::size_t vertices)
{
    Shaded shaded;
    shaded.irradiance.resize(vertices);
    shaded.radiance.resize(options.radiance ? vertices : 0);
    shaded.standard_error.resize(options.standard_error ? vertices : 0);
    shaded.per_light.resize(options.per_light ? transport.columns.size() : 0);
    for (std::size_t l = 0; l < shaded.per_light.size(); ++l) {
        transport.columns[l] != nullptr ? shaded.per_light[l].resize(vertices)
                                        : shaded.per_light[l].resize(vertices, Rgbf{});
    }
    return shaded;
}

}  // namespace

Shaded shade(const Stage& stage, const Transport& transport, const Scene& scene,
             const ShadeOptions& options, Progress& progress)
{
    const std::size_t vertices = stage.mesh->positions.size();
    const auto materials =
        options.radiance ? vertex_materials(stage, scene) : std::vector<std::uint32_t>{};
    Shaded shaded = sized(transport, options, vertices);
    const auto lights = summands(transport, scene, shaded);
    const Shining shining(stage, transport, scene, 0);
    std::deque<kernel::PreparedMaterial> prepared;
    if (options.radiance) {
        for (const Material& material : scene.materials) { prepared.emplace_back(material); }
    }

    const auto shine = [&](Block& block, const Material& material,
                           const kernel::Reflector& reflector, std::size_t begin, std::size_t end) {
        shining.fill(block, material, reflector, begin, end - begin);
        kernel::shine(block, shining.task(reflector, shining.shares(), rows_of(shaded.radiance)),
                      begin, end - begin);
    };
    const auto shade_run = [&](Block& block, std::size_t index, std::size_t begin,
                               std::size_t end) {
        kernel::Sums sums;
        sums.lights = lights.data();
        sums.count = lights.size();
        sums.E = rows_of(shaded.irradiance);
        sums.error = rows_of(shaded.standard_error);
        const Material& material = scene.materials[index];
        const bool told = options.radiance && E_tells_radiance(scene, material);
        if (told) {
            shining.fill_rho(block, material, begin, end - begin);
            sums.view = &shining.view();
            sums.radiance = rows_of(shaded.radiance);
            for (std::size_t band = 0; band < 3; ++band) { sums.rho[band] = block.rho[band]; }
        }
        kernel::add_columns(sums, begin, end);
        if (!options.radiance || told) { return; }
        if (scene.textured.empty() || !scene.textured[index]) {
            return shine(block, material, prepared[index].reflector, begin, end);
        }
        for (std::size_t v = begin; v < end; ++v) {  // a material of its own each
            const LocalMaterial here = vertex_material(stage, scene, materials, v);
            shine(block, *here, kernel::PreparedMaterial(*here).reflector, v, v + 1);
        }
    };
    parallel_for(vertices, work_block, options.threads, progress,
                 [&](std::size_t begin, std::size_t end) {
                     Block block;
                     while (begin < end) {  // of one material, and no longer than a block
                         const std::size_t most = std::min(end, begin + block_size);
                         std::size_t next = most;
                         std::size_t index = 0;
                         if (!materials.empty()) {
                             index = materials[begin];
                             next = begin + 1;
                             while (next < most && materials[next] == index) { ++next; }
                         }
                         shade_run(block, index, begin, next);
                         begin = next;
                     }
                 });
    if (progress.stopped()) { return {}; }
    return shaded;
}

}  // namespace relight
