#pragma once

#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkSmartPointer.h>

namespace relight_preview {

/// A VTK window on an OpenGL context without display or surface, bound to the calling thread for
/// the life of the process. Throws std::runtime_error if there is no driver for it.
vtkSmartPointer<vtkGenericOpenGLRenderWindow> offscreen_window(int width, int height);

}  // namespace relight_preview
