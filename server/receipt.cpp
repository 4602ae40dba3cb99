#include "server/receipt.h"

#include <map>
#include <nlohmann/json.hpp>

#include "core/trace/bvh.h"
#include "server/json_text.h"
#include "server/sha256.h"

namespace relight {
namespace {

constexpr std::size_t small_json = std::size_t{64} << 10U;  // bytes

/// Fields in order, no space, numbers in their shortest form; a long text stays as it is.
std::string canonical(std::string_view json)
{
    if (json.size() > small_json) { return std::string(json); }
    const auto tree = nlohmann::json::parse(json, nullptr, false);
    return tree.is_discarded()
               ? std::string(json)
               : tree.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// The content that a request's mesh is named by; empty for one that stands in the request.
std::string mesh_id(const RelightRequest& request, const std::vector<Part>& parts)
{
    if (const auto* stored = std::get_if<StoredMesh>(&request.mesh)) { return stored->id; }
    const auto* mesh = std::get_if<PartMesh>(&request.mesh);
    for (const Part& part : parts) {
        if (mesh != nullptr && part.name == mesh->part) { return part.id; }
    }
    return {};
}

}  // namespace

std::string request_digest(std::string_view json, const std::vector<Part>& parts, Format format,
                           std::string_view query)
{
    std::map<std::string, std::string> files;  // whatever order they came in
    for (const Part& part : parts) {
        files[part.name] = relight::sha256(part.content_type) + part.id;
    }
    std::string all = std::string(RELIGHT_VERSION) + '\n' + Bvh::kernel() + '\n' +
                      std::to_string(static_cast<int>(format)) + '\n' + std::string(query) + '\n';
    for (const auto& [name, content] : files) { all.append(relight::sha256(name)).append(content); }
    return relight::sha256(all.append(canonical(json)));
}

std::string Receipt::json(std::string_view result_sha256) const
{
    return '{' + inputs + R"(,"result_sha256":)" + json_string(result_sha256) + ',' + settings +
           '}';
}

Receipt receipt_of(const RelightRequest& request, const std::vector<Part>& parts, Units units,
                   std::string_view digest)
{
    const Scene& scene = request.scene;
    Receipt receipt;
    receipt.inputs = R"("request_sha256":)" + json_string(digest);
    const std::string mesh = mesh_id(request, parts);
    if (!mesh.empty()) { receipt.inputs += R"(,"mesh_sha256":)" + json_string(mesh); }
    const std::string settings =
        ObjectWriter()
            .count("seed", scene.transport.seed)
            .count("samples", scene.transport.samples)
            .count("bounces", scene.transport.bounces)
            .number("length_unit_m", scene.length_unit_m)
            .text("units", units == Units::Photometric ? "photometric" : "radiometric")
            .text("relight", RELIGHT_VERSION)
            .text("rays", Bvh::kernel())
            .done();
    receipt.settings = settings.substr(1, settings.size() - 2);
    return receipt;
}

std::string sha256(const Encoding& body)
{
    Sha256 hash;
    body.write([&](std::string_view bytes) {
        hash.add(bytes);
        return true;
    });
    return hash.hex();
}

Encoding with_receipt(Encoding json, Receipt receipt)
{
    const bool is_short = json.bytes > 0;
    Encoding both{0, [json = std::move(json), receipt = std::move(receipt)](const Sink& sink) {
                      BlockOut out(sink);
                      Sha256 hash;
                      std::string held;  // the last byte so far: of all, the brace that gives way
                      json.write([&](std::string_view bytes) {
                          hash.add(bytes);
                          out.bytes(held);
                          held = bytes.back();
                          out.bytes(bytes.substr(0, bytes.size() - 1));
                          return out.open();
                      });
                      if (!out.open()) { return false; }
                      out.bytes(R"(,"receipt":)" + receipt.json(hash.hex()) + '}');
                      return out.flush();
                  }};
    return is_short ? sent_whole(whole(both)) : both;
}

bool names_tag(std::string_view header, std::string_view tag)
{
    while (!header.empty()) {
        std::string_view one = header.substr(0, header.find(','));
        header.remove_prefix(std::min(header.size(), one.size() + 1));
        while (!one.empty() && (one.front() == ' ' || one.front() == '\t')) {
            one.remove_prefix(1);
        }
        while (!one.empty() && (one.back() == ' ' || one.back() == '\t')) { one.remove_suffix(1); }
        if (one.starts_with("W/")) { one.remove_prefix(2); }  // weak comparison
        if (one == "*" || one == tag) { return true; }
    }
    return false;
}

}  // namespace relight
