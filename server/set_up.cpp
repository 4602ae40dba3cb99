#include <algorithm>
#include <chrono>

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

/// Mesh -> surface and acceleration structure.
Result<Stage> build_stage(Mesh mesh, double point_radius_scale, unsigned threads, Timings& timings,
                          Progress& progress)
{
    if (mesh.faces.count() == 0 && mesh.normals.empty()) {
        return make_error(Fault::NormalsRequired,
                          "a point cloud is lit by the normals it brings, and this one has none; "
                          "estimating them is not in this build",
                          "/mesh");
    }
    return timed(timings.bvh, [&]() -> Result<Stage> {
        Stage stage;
        stage.mesh = std::make_shared<const Mesh>(std::move(mesh));
        stage.surface = std::make_shared<const Surface>(prepare(*stage.mesh, threads, progress));
        if (progress.stopped()) { return cancelled(); }
        stage.bvh = std::make_shared<const Bvh>(*stage.mesh, *stage.surface, point_radius_scale);
        return stage;
    });
}

/// The stage of a request's mesh, from the cache if it has come before.
struct StageFinder {
    const RelightRequest& request;
    const std::vector<Part>& parts;
    const Workshop& workshop;
    Timings& timings;
    Progress& progress;

    Result<Stage> build(std::span<const std::byte> file, std::optional<std::string_view> format,
                        std::string_view content_type) const
    {
        auto mesh = timed(timings.parse, [&] {
            return parse_mesh(file, format, content_type, workshop.read, progress);
        });
        if (!mesh) { return std::move(mesh).error(); }
        return build_stage(std::move(*mesh), request.point_radius_scale, workshop.threads, timings,
                           progress);
    }

    /// What a stage depends on: the file, how it is read, the size of its points.
    std::string key(const std::string& id, std::string_view read_as) const
    {
        return id + ' ' + std::string(read_as) + ' ' + decimal(request.point_radius_scale);
    }

    Result<Stage> operator()(const StoredMesh& stored) const
    {
        const auto object = workshop.meshes.find(stored.id);
        if (!object) {
            return make_error(Fault::NotFound,
                              "no mesh is stored under this id; POST /v1/meshes stores one",
                              "/mesh/id");
        }
        return workshop.stages.get(key(stored.id, object->format), [&]() -> Result<Stage> {
            const File file = workshop.meshes.open(stored.id);
            if (!file) { return make_error(Fault::NotFound, "this mesh was deleted", "/mesh/id"); }
            return build(file.read_all(), object->format, {});
        });
    }

    Result<Stage> operator()(const PartMesh& mesh) const
    {
        const auto part = std::find_if(parts.begin(), parts.end(),
                                       [&](const Part& p) { return p.name == mesh.part; });
        if (part == parts.end()) {
            return make_error(Fault::MissingField,
                              "no part of the request is called \"" + printable(mesh.part) +
                                  "\"; a part is a file of a multipart/form-data body",
                              "/mesh/part");
        }
        return workshop.stages.get(key(sha256(part->data), part->content_type), [&] {
            return build(std::as_bytes(std::span(part->data)), {}, part->content_type);
        });
    }

    Result<Stage> operator()(const Mesh& mesh) const
    {
        return build_stage(mesh, request.point_radius_scale, workshop.threads, timings, progress);
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
    const auto part =
        std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.name == name; });
    if (part == parts.end()) {
        return make_error(Fault::MissingField,
                          "no part of the request is called \"" + printable(name) +
                              "\"; a part is a file of a multipart/form-data body",
                          file.pointer + "/part");
    }
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

Result<Mesh> parse_mesh(std::span<const std::byte> file, std::optional<std::string_view> named,
                        std::string_view content_type, const ReadLimits& limits, Progress& progress)
{
    return choose_mesh_format(named, content_type, file).and_then([&](MeshFormat format) {
        return read_mesh(format, file, limits, progress);
    });
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
    return std::visit(StageFinder{request, parts, workshop, timings, progress}, request.mesh)
        .and_then([&](const Stage& stage) {
            return timed(timings.parse, [&] {
                return complete(request, *stage.mesh, *stage.surface).transform([&](Scene&& scene) {
                    return SetUp{stage, std::move(scene)};
                });
            });
        });
}

}  // namespace relight
