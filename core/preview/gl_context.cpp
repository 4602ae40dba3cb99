#include "core/preview/gl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>

namespace relight {
namespace {

Error no_driver(const char* step)
{
    return {Fault::Internal,
            std::string("found no OpenGL driver that draws without a display (EGL: ") + step +
                "); the operator of this service installs one with the packages libegl1 and "
                "libgl1-mesa-dri. The renderer \"raytrace\" needs none.",
            {},
            {},
            {}};
}

}  // namespace

Result<Done> bind_gl_context()
{
    // Nothing here is undone: eglTerminate would end every other context of the process with ours.
    const auto platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
        eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (platform_display == nullptr) { return no_driver("eglGetPlatformDisplayEXT is missing"); }
    EGLDisplay display =
        platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY) { return no_driver("no surfaceless platform"); }
    if (eglInitialize(display, nullptr, nullptr) != EGL_TRUE) { return no_driver("eglInitialize"); }
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) { return no_driver("eglBindAPI"); }

    constexpr std::array<EGLint, 5> config_wants{EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE,
                                                 EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = EGL_NO_CONFIG_KHR;
    EGLint configs = 0;
    if (eglChooseConfig(display, config_wants.data(), &config, 1, &configs) != EGL_TRUE ||
        configs < 1) {
        return no_driver("eglChooseConfig");
    }
    constexpr std::array<EGLint, 7> context_wants{EGL_CONTEXT_MAJOR_VERSION,
                                                  3,
                                                  EGL_CONTEXT_MINOR_VERSION,
                                                  2,
                                                  EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                  EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                  EGL_NONE};
    EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, context_wants.data());
    if (context == EGL_NO_CONTEXT) { return no_driver("eglCreateContext"); }
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) != EGL_TRUE) {
        return no_driver("eglMakeCurrent");
    }
    return Done{};
}

}  // namespace relight
