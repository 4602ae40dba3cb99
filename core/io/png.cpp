#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkUnsignedCharArray.h>

#include <cassert>
#include <stdexcept>

#include "core/io/writers.h"

namespace relight {
namespace {

/// VTK writes no sRGB chunk; this is the whole of it: length 1, "sRGB", perceptual intent, CRC.
constexpr unsigned char srgb_chunk[] = {0, 0, 0, 1, 's', 'R', 'G', 'B', 0, 0xAE, 0xCE, 0x1C, 0xE9};
/// Where it goes, before all pixels: after the signature (8) and the IHDR chunk (25).
constexpr std::size_t after_header = 33;

/// The rows bottom up, as VTK counts them.
vtkNew<vtkImageData> to_vtk(int width, int height, std::span<const Rgb8> pixels,
                            std::span<const unsigned char> alpha)
{
    const int components = alpha.empty() ? 3 : 4;
    vtkNew<vtkImageData> image;
    image->SetDimensions(width, height, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, components);
    const auto columns = static_cast<std::size_t>(width);
    for (int y = 0; y < height; ++y) {
        auto* out = static_cast<unsigned char*>(image->GetScalarPointer(0, height - 1 - y, 0));
        const std::size_t row = static_cast<std::size_t>(y) * columns;
        for (std::size_t i = row; i < row + columns; ++i) {
            for (const unsigned char code : pixels[i]) { *out++ = code; }
            if (!alpha.empty()) { *out++ = alpha[i]; }
        }
    }
    return image;
}

}  // namespace

std::string write_png(int width, int height, std::span<const Rgb8> pixels,
                      std::span<const unsigned char> alpha)
{
    assert(pixels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    assert(alpha.empty() || alpha.size() == pixels.size());
    const vtkNew<vtkImageData> image = to_vtk(width, height, pixels, alpha);
    vtkNew<vtkPNGWriter> writer;
    writer->SetInputData(image);
    writer->SetCompressionLevel(4);  // twice as fast as 5 and over, for a few per cent of size
    writer->WriteToMemoryOn();
    writer->Write();
    vtkUnsignedCharArray* const result = writer->GetResult();
    if (result == nullptr || result->GetNumberOfValues() <= static_cast<vtkIdType>(after_header)) {
        throw std::runtime_error("the PNG writer gave no bytes");
    }
    std::string png(reinterpret_cast<const char*>(result->GetPointer(0)),
                    static_cast<std::size_t>(result->GetNumberOfValues()));
    png.insert(after_header, reinterpret_cast<const char*>(srgb_chunk), sizeof(srgb_chunk));
    return png;
}

}  // namespace relight
