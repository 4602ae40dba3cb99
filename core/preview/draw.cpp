#include "core/preview/draw.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkIdTypeArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtk_glew.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/preview/gl_context.h"

namespace relight {
namespace {

/// VTK's messages as lines on standard error, where the service's log is, instead of VTK's window.
/// Errors are counted: VTK reports them and carries on with half a picture.
class Messages : public vtkOutputWindow {
  public:
    static Messages* New();
    void DisplayText(const char* text) override { print(text); }
    void DisplayErrorText(const char* text) override
    {
        ++errors;
        print(text);
    }
    void DisplayWarningText(const char* text) override { print(text); }
    void DisplayGenericWarningText(const char* text) override { print(text); }
    void DisplayDebugText(const char* text) override { print(text); }

    int errors = 0;

  private:
    static void print(std::string text)
    {
        for (char& c : text) {
            if (c == '\n') { c = ' '; }
        }
        std::fprintf(stderr, "vtk: %s\n", text.c_str());
    }
};
vtkStandardNewMacro(Messages);

/// A window that draws into VTK's own framebuffers on the context bound to this thread.
class Window : public vtkGenericOpenGLRenderWindow {
  public:
    static Window* New();
    void MakeCurrent() override {}  // it always is
    bool IsCurrent() override { return true; }
    int SupportsOpenGL() override { return 1; }
    vtkTypeBool IsDirect() override { return 1; }
    /// Debian's GLEW is built for GLX: it loads every function and then reports that there is no
    /// GLX display (4), which VTK would take for a failure.
    void OpenGLInitContext() override
    {
        if (Initialized) { return; }
        constexpr GLenum no_glx_display = 4;
        const GLenum loaded = glewInit();
        GlewInitValid = loaded == GLEW_OK || loaded == no_glx_display;
        Initialized = GlewInitValid;
    }
};
vtkStandardNewMacro(Window);

vtkSmartPointer<vtkPolyData> poly_data(Drawing& drawing)
{
    const auto count = static_cast<vtkIdType>(drawing.colors.size());
    vtkNew<vtkFloatArray> xyz;  // the drawing's own memory, not a copy: save = 1
    xyz->SetNumberOfComponents(3);
    xyz->SetArray(drawing.positions.data(), 3 * count, 1);
    vtkNew<vtkPoints> points;
    points->SetData(xyz);
    vtkNew<vtkUnsignedCharArray> colors;
    colors->SetNumberOfComponents(3);
    colors->SetArray(reinterpret_cast<unsigned char*>(drawing.colors.data()), 3 * count, 1);

    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->GetPointData()->SetScalars(colors);
    static_assert(sizeof(vtkIdType) == sizeof(long long));
    vtkNew<vtkIdTypeArray> corners;
    corners->SetArray(reinterpret_cast<vtkIdType*>(drawing.corners.data()),
                      static_cast<vtkIdType>(drawing.corners.size()), 1);
    vtkNew<vtkCellArray> cells;
    cells->SetData(3, corners);
    data->SetPolys(cells);
    return data;
}

/// A part of the picture, row 0 on top [pixels]. Pictures are drawn in parts, so that the driver's
/// buffers stay small and no picture is too wide for it.
struct Tile {
    int x{}, y{}, width{}, height{};
};
constexpr int most_buffer = 2048;  // width and height [samples], within every driver's limit

/// Samples along a side of the pixel. Each is shaded where it is: the driver's own multisampling
/// would shade once at the pixel's centre, which at a silhouette lies outside the triangle, and the
/// colour runs on beyond those of the vertices.
int samples_a_side(int samples)
{
    int side = 1;
    while (side < 4 && side * side < samples) { ++side; }
    return side;
}

/// The projection onto the tile: OpenGL's frustum between the rays through its corners.
vtkSmartPointer<vtkMatrix4x4> projection(const Drawing& drawing, Tile tile)
{
    const ImagePlane plane(drawing.fov_y, drawing.options.width, drawing.options.height);
    const double left = plane.x(tile.x), right = plane.x(tile.x + tile.width);
    const double top = plane.y(tile.y), bottom = plane.y(tile.y + tile.height);
    const double n = drawing.near;
    const double f = drawing.far;
    vtkNew<vtkMatrix4x4> matrix;
    matrix->Zero();
    matrix->SetElement(0, 0, 2.0 / (right - left));
    matrix->SetElement(0, 2, (right + left) / (right - left));
    matrix->SetElement(1, 1, 2.0 / (top - bottom));
    matrix->SetElement(1, 2, (top + bottom) / (top - bottom));
    matrix->SetElement(2, 2, -(f + n) / (f - n));
    matrix->SetElement(2, 3, -2.0 * f * n / (f - n));
    matrix->SetElement(3, 2, -1.0);
    return matrix;
}

void aim(vtkCamera& camera, const Drawing& drawing)
{
    const Point3 eye = drawing.eye;
    const Point3 ahead = eye - Vec3(drawing.axes.back);
    camera.SetPosition(eye.x, eye.y, eye.z);
    camera.SetFocalPoint(ahead.x, ahead.y, ahead.z);
    camera.SetViewUp(drawing.axes.up.x(), drawing.axes.up.y(), drawing.axes.up.z());
    camera.SetClippingRange(drawing.near, drawing.far);
    camera.SetUseExplicitProjectionTransformMatrix(true);
}

Window* make_window()
{
    Window* window = Window::New();
    window->SetOwnContext(0);
    window->SetReadyForRendering(true);
    window->SetUseOffScreenBuffers(true);
    window->SetShowWindow(false);
    window->SetAlphaBitPlanes(1);
    window->SetMultiSamples(0);
    return window;
}

/// The surface's actor; nothing of VTK's own light, so colours stay what they are.
vtkSmartPointer<vtkActor> actor_of(Drawing& drawing)
{
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(poly_data(drawing));
    mapper->SetColorModeToDirectScalars();
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
    actor->GetProperty()->BackfaceCullingOff();
    return actor;
}

/// The mean of each pixel's samples (box filter), put into its place. VTK's rows begin at the
/// bottom.
void paste(vtkUnsignedCharArray& rgba, Tile tile, int side, Picture& picture)
{
    const int count = side * side;
    const vtkIdType row = vtkIdType{4} * tile.width * side;
    for (int y = 0; y < tile.height; ++y) {
        const vtkIdType lowest = vtkIdType{tile.height - 1 - y} * side;
        std::size_t to =
            static_cast<std::size_t>(tile.y + y) * static_cast<std::size_t>(picture.width) +
            static_cast<std::size_t>(tile.x);
        for (int x = 0; x < tile.width; ++x, ++to) {
            std::array<int, 4> sum{};
            for (int j = 0; j < side; ++j) {
                const unsigned char* from =
                    rgba.GetPointer((lowest + j) * row + vtkIdType{4} * x * side);
                for (int i = 0; i < 4 * side; ++i) {
                    sum[static_cast<std::size_t>(i % 4)] += from[i];
                }
            }
            const auto mean = [&](std::size_t band) {
                return static_cast<unsigned char>((sum.at(band) + count / 2) / count);
            };
            picture.pixels[to] = {mean(0), mean(1), mean(2)};
            picture.alpha[to] = mean(3);
        }
    }
}

Error failed()
{
    constexpr auto detail =
        "the OpenGL driver could not draw this picture; the service's log says why. The renderer "
        "\"raytrace\" does not use it.";
    return {Fault::Internal, detail, {}, {}, {}};
}

}  // namespace

Result<Picture> draw(Drawing& drawing, const Progress& progress)
{
    static const Result<Done> context = bind_gl_context();
    if (!context) { return context.error(); }
    // The window keeps the compiled shaders, so only the first picture waits for them. Never
    // deleted: see render_thread.cpp.
    static Window* const window = make_window();
    static Messages* const messages = Messages::New();
    vtkOutputWindow::SetInstance(messages);
    messages->errors = 0;

    const auto [width, height, samples, background] = drawing.options;
    vtkNew<vtkRenderer> renderer;
    renderer->SetBackground(background[0] / 255.0, background[1] / 255.0, background[2] / 255.0);
    renderer->SetBackgroundAlpha(0.0);  // so alpha is the share that the surface covers
    if (!drawing.colors.empty()) { renderer->AddActor(actor_of(drawing)); }
    vtkCamera* camera = renderer->GetActiveCamera();
    aim(*camera, drawing);
    window->AddRenderer(renderer);

    const int side = samples_a_side(samples);
    const int step = most_buffer / side;

    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    Picture picture{width, height, std::vector<Rgb8>(pixels), std::vector<unsigned char>(pixels)};
    vtkNew<vtkUnsignedCharArray> rgba;
    bool good = true;
    for (int y = 0; y < height && good; y += step) {
        for (int x = 0; x < width && good && !progress.stopped(); x += step) {
            const Tile tile{x, y, std::min(step, width - x), std::min(step, height - y)};
            camera->SetExplicitProjectionTransformMatrix(projection(drawing, tile));
            const int across = tile.width * side;
            const int down = tile.height * side;
            window->SetSize(across, down);
            window->Render();
            window->GetRGBACharPixelData(0, 0, across - 1, down - 1, 0, rgba);
            good =
                messages->errors == 0 && rgba->GetNumberOfValues() == vtkIdType{4} * across * down;
            if (good) { paste(*rgba, tile, side, picture); }
        }
    }
    window->RemoveRenderer(renderer);
    renderer->ReleaseGraphicsResources(window);
    if (!good) { return failed(); }
    return picture;
}

}  // namespace relight
