#include <vtkImageData.h>
#include <vtkJPEGWriter.h>
#include <vtkNew.h>
#include <vtkUnsignedCharArray.h>

#include <cassert>
#include <cstring>
#include <stdexcept>

#include "core/io/writers.h"

namespace relight {

std::string write_jpeg(int width, int height, std::span<const Rgb8> pixels, int quality)
{
    const auto columns = static_cast<std::size_t>(width);
    assert(pixels.size() == columns * static_cast<std::size_t>(height));
    assert(quality >= 1 && quality <= 100);
    vtkNew<vtkImageData> image;
    image->SetDimensions(width, height, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    for (int y = 0; y < height; ++y) {  // VTK counts rows from the bottom
        const auto row =
            pixels.subspan(static_cast<std::size_t>(height - 1 - y) * columns, columns);
        std::memcpy(image->GetScalarPointer(0, y, 0), row.data(), row.size_bytes());
    }
    vtkNew<vtkJPEGWriter> writer;
    writer->SetInputData(image);
    writer->SetQuality(quality);
    writer->ProgressiveOff();
    writer->WriteToMemoryOn();
    writer->Write();
    vtkUnsignedCharArray* const result = writer->GetResult();
    if (result == nullptr || result->GetNumberOfValues() == 0) {
        throw std::runtime_error("the JPEG writer gave no bytes");
    }
    return {reinterpret_cast<const char*>(result->GetPointer(0)),
            static_cast<std::size_t>(result->GetNumberOfValues())};
}

}  // namespace relight
