#pragma once

#include <functional>

namespace relight {

/// Runs `work` on the one thread that owns the OpenGL context and waits until it is done. Calls are
/// served in the order they come. An exception in `work` is rethrown here.
void on_render_thread(const std::function<void()>& work);

}  // namespace relight
