#pragma once

#include <array>
#include <optional>
#include <string>

namespace relight_preview {

/// Whence the mesh is seen; where nothing is said, the picture frames it.
struct View {
    std::optional<std::array<double, 3>> eye, target, up;
    double fov_y_deg = 40.0;
};

/// Draws the PLY with its vertex colours as they are and writes a PNG. Needs no display.
void write_png(const std::string& ply, const View& view, int width, int height,
               const std::string& file);

/// Shows the same in a window: drag to turn, wheel to zoom, q to leave. Returns when it is closed.
void show_window(const std::string& ply, const View& view, int width, int height);

}  // namespace relight_preview
