#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "core/io/writers.h"

namespace relight {
namespace {

/// OpenEXR's file, in memory. It seeks back to fill in where the scanlines went.
class StringStream : public Imf::OStream {
  public:
    StringStream() : Imf::OStream("memory") {}

    void write(const char* bytes, int count) override
    {
        const auto size = static_cast<std::size_t>(count);
        if (at_ + size > text_.size()) { text_.resize(at_ + size); }
        std::copy_n(bytes, size, text_.begin() + static_cast<std::ptrdiff_t>(at_));
        at_ += size;
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t at) override { at_ = at; }

    std::string take() { return std::move(text_); }

  private:
    std::string text_;
    std::size_t at_ = 0;
};

std::string channel_name(const ExrLayer& layer, int component)
{
    if (layer.components == 1 && layer.name == "A") { return "A"; }
    constexpr std::array suffixes{"R", "G", "B"};
    const std::string suffix =
        layer.components == 1 ? "Y" : suffixes[static_cast<std::size_t>(component)];
    return layer.name.empty() ? suffix : layer.name + '.' + suffix;
}

}  // namespace

std::string write_exr(int width, int height, std::span<const ExrLayer> layers,
                      std::span<const std::string> comments)
{
    Imf::Header header(width, height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::addChromaticities(header, Imf::Chromaticities());  // the default is Rec. 709
    for (std::size_t i = 0; i < comments.size(); ++i) {
        header.insert("comment_" + std::to_string(i), Imf::StringAttribute(comments[i]));
    }
    Imf::FrameBuffer planes;
    for (const ExrLayer& layer : layers) {
        const auto texel = sizeof(float) * static_cast<std::size_t>(layer.components);
        const auto row = texel * static_cast<std::size_t>(width);
        assert(layer.components == 1 || layer.components == 3);
        assert(layer.values.size_bytes() == row * static_cast<std::size_t>(height));
        for (int c = 0; c < layer.components; ++c) {
            const std::string name = channel_name(layer, c);
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
            // The frame buffer is for reading too, so it takes what it could write to; the writer
            // only reads.
            auto* const base = const_cast<float*>(layer.values.data() + c);
            planes.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(base), texel, row));
        }
    }
    StringStream stream;
    {
        Imf::OutputFile file(stream, header, 0);  // on this thread
        file.setFrameBuffer(planes);
        file.writePixels(height);
    }  // whose end writes the table of scanlines
    return stream.take();
}

}  // namespace relight
