#include "clients/preview/offscreen_window.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <vtkObjectFactory.h>
#include <vtk_glew.h>

#include <array>
#include <stdexcept>

// Debian's VTK draws off screen only where there is an X server. What follows does without: the
// same recipe as core/preview, said again because a client holds nothing of the service's.

namespace relight_preview {
namespace {

class Window : public vtkGenericOpenGLRenderWindow {
  public:
    static Window* New();
    void MakeCurrent() override {}  // it always is
    bool IsCurrent() override { return true; }
    int SupportsOpenGL() override { return 1; }
    void OpenGLInitContext() override
    {
        if (Initialized) { return; }
        constexpr GLenum no_glx_display =
            4;  // Debian's GLEW says so after it has loaded everything
        const GLenum loaded = glewInit();
        Initialized = GlewInitValid = loaded == GLEW_OK || loaded == no_glx_display;
    }
};
vtkStandardNewMacro(Window);

void bind_context()
{
    const auto platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
        eglGetProcAddress("eglGetPlatformDisplayEXT"));
    EGLDisplay display =
        platform_display == nullptr
            ? EGL_NO_DISPLAY
            : platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    constexpr std::array<EGLint, 5> config_wants{EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE,
                                                 EGL_OPENGL_BIT, EGL_NONE};
    constexpr std::array<EGLint, 5> context_wants{EGL_CONTEXT_MAJOR_VERSION, 3,
                                                  EGL_CONTEXT_MINOR_VERSION, 2, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint configs = 0;
    const bool ready =
        display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE &&
        eglBindAPI(EGL_OPENGL_API) == EGL_TRUE &&
        eglChooseConfig(display, config_wants.data(), &config, 1, &configs) == EGL_TRUE &&
        configs == 1;
    EGLContext context =
        ready ? eglCreateContext(display, config, EGL_NO_CONTEXT, context_wants.data())
              : EGL_NO_CONTEXT;
    if (context == EGL_NO_CONTEXT ||
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) != EGL_TRUE) {
        throw std::runtime_error(
            "no OpenGL driver that draws without a display: install libegl1 and libgl1-mesa-dri");
    }
}

}  // namespace

vtkSmartPointer<vtkGenericOpenGLRenderWindow> offscreen_window(int width, int height)
{
    bind_context();
    vtkSmartPointer<vtkGenericOpenGLRenderWindow> window = vtkSmartPointer<Window>::New();
    window->SetOwnContext(0);
    window->SetReadyForRendering(true);
    window->SetUseOffScreenBuffers(true);
    window->SetShowWindow(false);
    window->SetSize(width, height);
    return window;
}

}  // namespace relight_preview
