#include <algorithm>
#include <chrono>

#include "core/geometry/refine.h"
#include "core/io/photometry.h"
#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/light_file.h"
#include "server/mesh_file.h"
#include "server/relight.h"
#include "server/relight_checks.h"
#include "server/scene_json.h"
#include "server/timed.h"

namespace relight {
namespace {

Error no_such_mesh()
{
    return make_error(Fault::NotFound,
                      "no mesh is stored under this id; POST /v1/meshes stores one", "/mesh/id");
}

const Part* part_named(const std::string& name, const std::vector<Part>& parts)
{
    const auto part =
        std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.name == name; });
    return part == parts.end() ? nullptr : &*part;
}

Error no_such_part(const std::string& name, const std::string& pointer)
{
    return make_error(Fault::MissingField,
                      "no part of the request is called \"" + printable(name) +
                          "\"; a part is a file of a multipart/form-data body",
                      pointer);
}

/// Triangles, or points, that rays are traced through.
std::size_t primitives(const Surface& surface)
{
    return surface.triangles.empty() ? surface.normals.size() : surface.triangles.size();
}

/// Some rays ask what they meet, not only whether. Where one passes through an edge, trees of
/// another quality may name another of the equally near faces: all such answers come from good
/// trees.
bool asks_what_is_met(const RelightRequest& request)
{
    const Scene& scene = request.scene;
    const auto& format = request.output.format;
    return scene.transport.bounces > 0 || request.default_lights ||
           (format && is_image(*format) && request.output.renderer == Renderer::Raytrace) ||
           std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
               return std::holds_alternative<MeshLight>(light.shape);
           });
}

/// The same model on a good tree.
Model with_good_tree(const Model& model, double radius_scale, Progress& progress)
{
    Model better = model;
    Stage& stage = better.stage;
    stage.bvh = std::make_shared<const Bvh>(stage.mesh, stage.surface, radius_scale,
                                            TreeQuality::Good, progress);
    return better;
}

/// Asset -> (refined) mesh -> surface and acceleration structure, such as this request alone asks
/// for.
Result<Model> build_model(std::shared_ptr<const Asset> asset, const RelightRequest& request,
                          const Workshop& workshop, Timings& timings, Progress& progress)
{
    Model model;
    model.asset = std::move(asset);
    const Mesh& filed = model.asset->mesh;
    const Points& points = request.points;
    Stage& stage = model.stage;
    stage.mesh = std::shared_ptr<const Mesh>(model.asset, &filed);
    return timed(timings.bvh, [&]() -> Result<Model> {
        if (request.max_edge) {
            constexpr std::uint64_t face_bytes = 176;  // with its tree and its share of vertices
            auto refined =
                refine(filed, *request.max_edge, workshop.read.vertices,
                       std::min(workshop.read.faces, workshop.memory / face_bytes), progress);
            if (!refined) { return std::move(refined).error().at("/refine/max_edge"); }
            stage.mesh = std::make_shared<const Mesh>(std::move(*refined));
        }
        const CloudNormals normals{points.estimate.value_or(false),
                                   points.viewpoint ? points.viewpoint : filed.viewpoint};
        stage.surface = std::make_shared<const Surface>(
            prepare(*stage.mesh, workshop.threads, progress, normals));
        if (progress.stopped()) { return cancelled(); }
        const double rays = rays_asked(request, request.output.format.value_or(Format::Ply),
                                       request.scene, stage.mesh->positions.size());
        const TreeQuality quality =
            asks_what_is_met(request)
                ? TreeQuality::Good
                : tree_for(static_cast<std::uint64_t>(rays), primitives(*stage.surface));
        stage.bvh = std::make_shared<const Bvh>(stage.mesh, stage.surface, points.radius_scale,
                                                quality, progress);
        if (progress.stopped()) { return cancelled(); }
        return model;
    });
}

/// The model of a request's mesh, from the cache if it has come before.
struct ModelFinder {
    const RelightRequest& request;
    const std::vector<Part>& parts;
    const Workshop& workshop;
    Timings& timings;
    Progress& progress;

    Result<Model> build(std::span<const std::byte> file, std::optional<std::string_view> format,
                        std::string_view content_type) const
    {
        auto asset = timed(timings.parse, [&] {
            return read_mesh_file(file, format, content_type, workshop.read, workshop.pixels,
                                  progress);
        });
        if (!asset) { return std::move(asset).error(); }
        return build_model(std::make_shared<const Asset>(std::move(*asset)), request, workshop,
                           timings, progress);
    }

    /// What a model depends on: the file, how it is read, how its points become a surface, how fine
    /// it is to be.
    std::string key(const std::string& id, std::string_view read_as) const
    {
        const Points& points = request.points;
        std::string key = id + ' ' + std::string(read_as) + ' ' + decimal(points.radius_scale);
        if (points.estimate == true) { key += " estimate"; }
        if (points.viewpoint) { key += ' ' + json_of(*points.viewpoint - Point3{}); }
        if (request.max_edge) { key += ' ' + decimal(*request.max_edge); }
        return key;
    }

    Result<Model> kept(const std::string& key, const std::function<Result<Model>()>& make) const
    {
        auto model = workshop.cache.get<Model>(key, progress, [&] {
            return make().transform([&](Model&& made) {
                made.key = key;
                return std::move(made);
            });
        });
        const bool hasty = model && model->stage.bvh->quality() == TreeQuality::Fast;
        if (!hasty || !asks_what_is_met(request)) { return model; }
        return timed(timings.bvh, [&]() -> Result<Model> {
            Model better = with_good_tree(*model, request.points.radius_scale, progress);
            if (progress.stopped()) { return cancelled(); }
            workshop.cache.replace(key, better);
            return better;
        });
    }

    Result<Model> operator()(const StoredMesh& stored) const
    {
        const auto object = workshop.meshes.find(stored.id);
        if (!object) { return no_such_mesh(); }
        return kept(key(stored.id, object->format), [&]() -> Result<Model> {
            const File file = workshop.meshes.open(stored.id);
            if (!file) { return no_such_mesh(); }
            return build(file.read_all(), object->format, {});
        });
    }

    Result<Model> operator()(const PartMesh& mesh) const
    {
        const Part* part = part_named(mesh.part, parts);
        if (part == nullptr) { return no_such_part(mesh.part, "/mesh/part"); }
        return kept(key(part->id, part->content_type), [&] {
            return build(std::as_bytes(std::span(part->data)), {}, part->content_type);
        });
    }

    Result<Model> operator()(const InlineMesh& mesh) const
    {
        return build_model(mesh, request, workshop, timings, progress);
    }
};

/// A file that a light needs: its id, how it was stored as or sent as, and its bytes when asked.
struct Attachment {
    std::string id, format, content_type;
    std::function<std::vector<std::byte>()> read;
};

Result<Attachment> find_attachment(const LightFile& file, const Store& store,
                                   const std::vector<Part>& parts)
{
    if (const auto* stored = std::get_if<StoredMesh>(&file.source)) {
        const auto object = store.find(stored->id);
        if (!object) {
            return make_error(Fault::NotFound, "nothing is stored under this id",
                              file.pointer + "/id");
        }
        return Attachment{stored->id, object->format, {}, [&store, id = stored->id] {
                              const File bytes = store.open(id);
                              return bytes ? bytes.read_all() : std::vector<std::byte>();
                          }};
    }
    const std::string& name = std::get<PartMesh>(file.source).part;
    const Part* part = part_named(name, parts);
    if (part == nullptr) { return no_such_part(name, file.pointer + "/part"); }
    return Attachment{part->id, {}, part->content_type, [part] {
                          const auto bytes = std::as_bytes(std::span(part->data));
                          return std::vector<std::byte>(bytes.begin(), bytes.end());
                      }};
}

/// Gives a light what its file holds, and notes which file that was.
std::optional<Error> load(const LightFile& file, Light& light, const std::vector<Part>& parts,
                          const Workshop& workshop, FileNames& names, Progress& progress)
{
    auto* sky = std::get_if<EnvironmentLight>(&light.shape);
    auto attachment =
        find_attachment(file, sky != nullptr ? workshop.environments : workshop.profiles, parts);
    if (!attachment) { return std::move(attachment).error(); }
    const std::string& format = attachment->format;
    const auto named =
        format.empty() ? std::nullopt : std::optional<std::string_view>(attachment->format);
    const std::string name = attachment->id + ' ' + format + ' ' + attachment->content_type;
    if (sky == nullptr) {
        auto profile = read_profile(attachment->read(), named, progress);
        if (!profile) { return std::move(profile).error().at(file.pointer); }
        auto& made = std::get<IesLight>(light.shape).profile;
        made = std::make_shared<const IesProfile>(std::move(*profile));
        names[made.get()] = name;
        return {};
    }
    auto map = workshop.cache.get<SharedMap>(name, progress, [&]() -> Result<SharedMap> {
        return read_environment(attachment->read(), named, attachment->content_type,
                                workshop.pixels, progress)
            .transform([](EnvironmentFile&& read) {
                return SharedMap(std::make_shared<const EnvironmentMap>(read.image));
            });
    });
    if (!map) { return std::move(map).error().at(file.pointer); }
    sky->map = std::move(*map);
    names[sky->map.get()] = name;
    return {};
}

}  // namespace

void count_rays(const Model& model, double radius_scale, std::uint64_t rays,
                const Workshop& workshop)
{
    const Bvh& tree = *model.stage.bvh;
    if (model.key.empty() || !workshop.behind || tree.quality() == TreeQuality::Good) { return; }
    const std::uint64_t all = model.use->rays += rays;
    if (tree_for(all, primitives(*model.stage.surface)) == TreeQuality::Fast) { return; }
    if (model.use->upgrading.exchange(true)) { return; }
    workshop.behind([kept = model, radius_scale, &cache = workshop.cache](Progress& progress) {
        Model better = with_good_tree(kept, radius_scale, progress);
        if (!progress.stopped()) { cache.replace(kept.key, std::move(better)); }
    });
}

Result<std::vector<std::byte>> source_of(const RelightRequest& request,
                                         const std::vector<Part>& parts, const Workshop& workshop)
{
    if (const auto* stored = std::get_if<StoredMesh>(&request.mesh)) {
        const File file = workshop.meshes.open(stored->id);
        if (!file) { return no_such_mesh(); }
        return file.read_all();
    }
    const auto* mesh = std::get_if<PartMesh>(&request.mesh);
    const Part* part = mesh == nullptr ? nullptr : part_named(mesh->part, parts);
    if (part == nullptr) { return std::vector<std::byte>(); }
    const auto bytes = std::as_bytes(std::span(part->data));
    return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Result<SetUp> set_up(RelightRequest& request, const std::vector<Part>& parts,
                     const Workshop& workshop, Timings& timings, Progress& progress)
{
    FileNames names;
    for (const LightFile& file : request.light_files) {
        auto error = timed(timings.parse, [&] {
            return load(file, request.scene.lights[file.light], parts, workshop, names, progress);
        });
        if (error) { return std::move(*error); }
    }
    return std::visit(ModelFinder{request, parts, workshop, timings, progress}, request.mesh)
        .and_then([&](const Model& model) -> Result<SetUp> {
            const Mesh& filed = model.asset->mesh;
            if (request.points.estimate == false && filed.faces.count() == 0 &&
                filed.normals.empty()) {
                return make_error(
                    Fault::NormalsRequired,
                    "this cloud brings no normals, and \"normals\": \"file\" asks for "
                    "them; \"estimate\" finds some from each point's neighbours",
                    "/points/normals");
            }
            return timed(timings.parse, [&] {
                return complete(request, *model.asset, *model.stage.mesh, *model.stage.surface)
                    .transform([&](Scene&& scene) {
                        return SetUp{model, std::move(scene), std::move(names)};
                    });
            });
        });
}

}  // namespace relight
