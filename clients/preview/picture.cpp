#include "clients/preview/picture.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkImageShrink3D.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkNew.h>
#include <vtkPLYReader.h>
#include <vtkPNGWriter.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkVertexGlyphFilter.h>
#include <vtkWindowToImageFilter.h>

#include <array>
#include <cstdlib>
#include <stdexcept>

#include "clients/preview/offscreen_window.h"

namespace relight_preview {
namespace {

constexpr int side = 3;  // samples along a side of a picture's pixel

vtkSmartPointer<vtkPolyData> parse(const std::string& ply)
{
    vtkNew<vtkPLYReader> reader;  // the answer comes from our own server: VTK's reader may have it
    reader->ReadFromInputStringOn();
    reader->SetInputString(ply);
    reader->Update();
    vtkSmartPointer<vtkPolyData> data = reader->GetOutput();
    if (data->GetNumberOfPoints() == 0) {
        throw std::runtime_error("the server's answer holds no vertices");
    }
    if (data->GetNumberOfPolys() == 0) {
        vtkNew<vtkVertexGlyphFilter> points;
        points->SetInputData(data);
        points->Update();
        data = points->GetOutput();
    }
    return data;
}

vtkSmartPointer<vtkActor> actor_of(vtkPolyData* data, int samples_a_side)
{
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    mapper->SetColorModeToDirectScalars();
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();  // the light is in the colours already
    actor->GetProperty()->SetPointSize(4.0F * static_cast<float>(samples_a_side));
    actor->GetProperty()->SetRenderPointsAsSpheres(data->GetNumberOfPolys() == 0);
    return actor;
}

/// The view's camera; where it says nothing, one that frames the mesh from the front, a little to
/// the right and above.
void aim(vtkRenderer& renderer, const View& view)
{
    std::array<double, 6> bounds{};
    renderer.ComputeVisiblePropBounds(bounds.data());
    const std::array<double, 3> centre{0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]),
                                       0.5 * (bounds[4] + bounds[5])};
    const std::array<double, 3> target = view.target.value_or(centre);
    const std::array<double, 3> up = view.up.value_or(std::array<double, 3>{0, 1, 0});
    vtkCamera& camera = *renderer.GetActiveCamera();
    camera.SetViewAngle(view.fov_y_deg);
    camera.SetFocalPoint(target.data());
    camera.SetViewUp(up.data());
    if (view.eye) {
        camera.SetPosition(view.eye->data());
        renderer.ResetCameraClippingRange();
    } else {
        camera.SetPosition(target[0] + 0.4, target[1] + 0.3, target[2] + 1.0);
        renderer.ResetCamera();
    }
}

vtkSmartPointer<vtkRenderer> renderer_of(const std::string& ply, int samples_a_side)
{
    vtkNew<vtkRenderer> renderer;
    renderer->AddActor(actor_of(parse(ply), samples_a_side));
    renderer->SetBackground(0.05, 0.06, 0.08);
    return renderer;
}

}  // namespace

void write_png(const std::string& ply, const View& view, int width, int height,
               const std::string& file)
{
    // Drawn larger and averaged: the driver's multisampling lets colours run on beyond those of the
    // vertices at silhouettes.
    const vtkSmartPointer<vtkGenericOpenGLRenderWindow> window =
        offscreen_window(side * width, side * height);
    const vtkSmartPointer<vtkRenderer> renderer = renderer_of(ply, side);
    window->SetMultiSamples(0);
    window->AddRenderer(renderer);
    aim(*renderer, view);
    vtkNew<vtkWindowToImageFilter> grab;
    grab->SetInput(window);
    grab->ReadFrontBufferOff();
    vtkNew<vtkImageShrink3D> mean;
    mean->SetInputConnection(grab->GetOutputPort());
    mean->SetShrinkFactors(side, side, 1);
    mean->AveragingOn();
    vtkNew<vtkPNGWriter> writer;
    writer->SetInputConnection(mean->GetOutputPort());
    writer->SetFileName(file.c_str());
    writer->Write();
    if (writer->GetErrorCode() != 0) { throw std::runtime_error("cannot write " + file); }
}

void show_window(const std::string& ply, const View& view, int width, int height)
{
    if (std::getenv("DISPLAY") == nullptr) {
        throw std::runtime_error("there is no display to show a window on: use --png FILE");
    }
    const vtkSmartPointer<vtkRenderer> renderer = renderer_of(ply, 1);
    vtkNew<vtkRenderWindow> window;
    window->SetWindowName("relight-preview");
    window->SetSize(width, height);
    window->AddRenderer(renderer);
    aim(*renderer, view);
    vtkNew<vtkRenderWindowInteractor> interactor;
    vtkNew<vtkInteractorStyleTrackballCamera> style;
    interactor->SetInteractorStyle(style);
    interactor->SetRenderWindow(window);
    window->Render();
    interactor->Start();
}

}  // namespace relight_preview
