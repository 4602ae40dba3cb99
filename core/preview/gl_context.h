#pragma once

#include "core/base/result.h"

namespace relight {

/// Makes an OpenGL 3.2 core context that draws on no display and on no surface (Mesa's surfaceless
/// EGL platform) and binds it to the calling thread, for as long as the process lives. Error
/// Internal if there is no driver for it.
Result<Done> bind_gl_context();

}  // namespace relight
