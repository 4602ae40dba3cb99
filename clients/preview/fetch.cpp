#include "clients/preview/fetch.h"

#include <httplib.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace relight_preview {
namespace {

using nlohmann::json;

std::string contents(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    if (!file) { throw std::runtime_error("cannot read " + path); }
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The type a part is sent as; empty: the server looks at its first bytes.
std::string media_type(const std::string& path)
{
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    static const std::map<std::string, std::string> types{
        {".obj", "model/obj"}, {".stl", "model/stl"}, {".ply", "model/ply"}};
    const auto found = types.find(extension);
    return found == types.end() ? "application/octet-stream" : found->second;
}

/// What the server says is wrong (RFC 9457), in a line.
std::string problem(const httplib::Response& response)
{
    const json body = json::parse(response.body, nullptr, false);
    std::string text = "the server answers " + std::to_string(response.status);
    if (body.is_object()) {
        for (const char* field : {"code", "pointer", "detail"}) {
            const auto found = body.find(field);
            if (found != body.end() && found->is_string()) {
                text += ": " + found->get<std::string>();
            }
        }
    }
    return text;
}

}  // namespace

std::string fetch_lit_mesh(const std::string& server, const std::string& mesh_file, json request)
{
    request["output"] = {{"format", "ply"}, {"quantities", {"color"}}};
    const httplib::MultipartFormDataItems parts{
        {"mesh", contents(mesh_file), "mesh", media_type(mesh_file)},
        {"request", request.dump(), "", "application/json"}};
    httplib::Client client(server);
    if (!client.is_valid()) {
        throw std::runtime_error("\"" + server + "\" is not an address like http://127.0.0.1:8080");
    }
    constexpr time_t patience_s = 600;  // a big mesh with many lights takes minutes
    client.set_read_timeout(patience_s);
    client.set_write_timeout(patience_s);
    const httplib::Result result = client.Post("/v1/relight", parts);
    if (!result) {
        throw std::runtime_error("no answer from " + server + " (" +
                                 httplib::to_string(result.error()) + "): is relightd running?");
    }
    if (result->status != 200) { throw std::runtime_error(problem(*result)); }
    return result->body;
}

}  // namespace relight_preview
