#include <algorithm>
#include <chrono>

#include "core/geometry/refine.h"
#include "core/io/photometry.h"
#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/light_file.h"
#include "server/mesh_file.h"
#include "server/relight.h"
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

/// Asset -> (refined) mesh -> surface and acceleration structure.
Result<Model> build_model(Asset&& asset, const RelightRequest& request, const Workshop& workshop,
                          Timings& timings, Progress& progress)
{
    Model model;
    model.asset = std::make_shared<const Asset>(std::move(asset));
    const Mesh& filed = model.asset->mesh;
    const Points& points = request.points;
    Stage& stage = model.stage;
    stage.mesh = std::shared_ptr<const Mesh>(model.asset, &filed);
    return timed(timings.bvh, [&]() -> Result<Model> {
        if (request.max_edge) {
            constexpr std::uint64_t face_bytes = 128;  // with its tree and its share of vertices
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
        stage.bvh = std::make_shared<const Bvh>(*stage.mesh, *stage.surface, points.radius_scale);
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
        return build_model(std::move(*asset), request, workshop, timings, progress);
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

    Result<Model> operator()(const StoredMesh& stored) const
    {
        const auto object = workshop.meshes.find(stored.id);
        if (!object) { return no_such_mesh(); }
        return workshop.models.get(key(stored.id, object->format), [&]() -> Result<Model> {
            const File file = workshop.meshes.open(stored.id);
            if (!file) { return no_such_mesh(); }
            return build(file.read_all(), object->format, {});
        });
    }

    Result<Model> operator()(const PartMesh& mesh) const
    {
        const Part* part = part_named(mesh.part, parts);
        if (part == nullptr) { return no_such_part(mesh.part, "/mesh/part"); }
        return workshop.models.get(key(sha256(part->data), part->content_type), [&] {
            return build(std::as_bytes(std::span(part->data)), {}, part->content_type);
        });
    }

    Result<Model> operator()(const Mesh& mesh) const
    {
        return build_model({mesh, {}, {}}, request, workshop, timings, progress);
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
    return Attachment{sha256(part->data), {}, part->content_type, [part] {
                          const auto bytes = std::as_bytes(std::span(part->data));
                          return std::vector<std::byte>(bytes.begin(), bytes.end());
                      }};
}

/// Gives a light what its file holds.
std::optional<Error> load(const LightFile& file, Light& light, const std::vector<Part>& parts,
                          const Workshop& workshop, Progress& progress)
{
    auto* sky = std::get_if<EnvironmentLight>(&light.shape);
    auto attachment =
        find_attachment(file, sky != nullptr ? workshop.environments : workshop.profiles, parts);
    if (!attachment) { return std::move(attachment).error(); }
    const std::string& format = attachment->format;
    const auto named =
        format.empty() ? std::nullopt : std::optional<std::string_view>(attachment->format);
    if (sky == nullptr) {
        auto profile = read_profile(attachment->read(), named, progress);
        if (!profile) { return std::move(profile).error().at(file.pointer); }
        std::get<IesLight>(light.shape).profile =
            std::make_shared<const IesProfile>(std::move(*profile));
        return {};
    }
    auto map = workshop.skies.get(
        attachment->id + ' ' + format + ' ' + attachment->content_type, [&]() -> Result<SharedMap> {
            return read_environment(attachment->read(), named, attachment->content_type,
                                    workshop.pixels, progress)
                .transform([](EnvironmentFile&& read) {
                    return SharedMap(std::make_shared<const EnvironmentMap>(std::move(read.image)));
                });
        });
    if (!map) { return std::move(map).error().at(file.pointer); }
    sky->map = std::move(*map);
    return {};
}

}  // namespace

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
    for (const LightFile& file : request.light_files) {
        auto error = timed(timings.parse, [&] {
            return load(file, request.scene.lights[file.light], parts, workshop, progress);
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
                        return SetUp{model, std::move(scene)};
                    });
            });
        });
}

}  // namespace relight
