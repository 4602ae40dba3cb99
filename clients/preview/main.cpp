// Lights a mesh on a Relight server and shows it: in a window, or as a PNG where there is no
// display.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "clients/preview/fetch.h"
#include "clients/preview/picture.h"

namespace {

using nlohmann::json;

json request_in(const std::string& file)
{
    if (file.empty()) { return json::object(); }
    std::ifstream stream(file);
    json request = json::parse(stream, nullptr, false);
    if (!request.is_object()) { throw std::runtime_error(file + " is not a JSON object"); }
    return request;
}

/// The request's camera, so that the picture is seen whence the request says.
relight_preview::View view_in(const json& request)
{
    relight_preview::View view;
    const json camera = request.value("camera", json::object());
    const auto place = [&](const char* name, std::optional<std::array<double, 3>>& to) {
        if (camera.contains(name)) { to = camera.at(name).get<std::array<double, 3>>(); }
    };
    place("eye", view.eye);
    place("target", view.target);
    place("up", view.up);
    view.fov_y_deg = camera.value("fov_y_deg", view.fov_y_deg);
    return view;
}

}  // namespace

int main(int argc, char** argv)
{
    CLI::App app("Lights a mesh on a Relight server and shows it.");
    std::string server = "http://127.0.0.1:8080";
    std::string mesh;
    std::string request_file;
    std::string png;
    std::string size = "800x600";
    app.add_option("mesh", mesh, "PLY, OBJ, OFF or STL file")->required()->check(CLI::ExistingFile);
    app.add_option("--server", server, "where relightd listens")
        ->envname("RELIGHT_SERVER")
        ->capture_default_str();
    app.add_option("--request", request_file, "the scene: lights, material, display, camera (JSON)")
        ->check(CLI::ExistingFile);
    app.add_option("--png", png, "write a picture, needs no display");
    app.add_option("--size", size, "WIDTHxHEIGHT in pixels")->capture_default_str();
    CLI11_PARSE(app, argc, argv);

    try {
        int width = 0;
        int height = 0;
        char rest = 0;
        if (std::sscanf(size.c_str(), "%5dx%5d%c", &width, &height, &rest) != 2 ||  // NOLINT
            std::min(width, height) < 1 || std::max(width, height) > 5000) {
            throw std::runtime_error("--size " + size + " is not like 800x600 (at most 5000 each)");
        }
        const json request = request_in(request_file);
        const relight_preview::View view = view_in(request);
        const std::string ply = relight_preview::fetch_lit_mesh(server, mesh, request);
        if (png.empty()) {
            relight_preview::show_window(ply, view, width, height);
        } else {
            relight_preview::write_png(ply, view, width, height, png);
        }
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "relight-preview: %s\n", error.what());
        return 1;
    }
}
