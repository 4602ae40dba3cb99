#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfTiledOutputFile.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

namespace relight::test {

/// A file in memory, for OpenEXR to write and to read.
class Memory : public Imf::OStream, public Imf::IStream {
  public:
    Memory() : Imf::OStream("memory"), Imf::IStream("memory") {}
    explicit Memory(std::string text) : Memory() { text_ = std::move(text); }

    void write(const char* bytes, int count) override
    {
        text_.resize(std::max(text_.size(), at_ + static_cast<std::size_t>(count)));
        std::memcpy(text_.data() + at_, bytes, static_cast<std::size_t>(count));
        at_ += static_cast<std::size_t>(count);
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t at) override { at_ = at; }

    bool read(char* out, int count) override
    {
        std::memcpy(out, text_.data() + at_, static_cast<std::size_t>(count));
        at_ += static_cast<std::size_t>(count);
        return at_ < text_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t at) override { at_ = at; }

    const std::string& text() const { return text_; }

  private:
    std::string text_;
    std::size_t at_ = 0;
};

/// How a picture is filed. Texel (x, y) of channel c has the value x + 100 y + c / 8, or `value`.
struct Filed {
    std::vector<std::string> channels{"R", "G", "B"};
    Imf::PixelType type = Imf::HALF;
    Imf::Compression compression = Imf::ZIP_COMPRESSION;
    Imath::Box2i window{{0, 0}, {19, 16}};
    Imf::LineOrder order = Imf::INCREASING_Y;
    int tile = 0;  ///< side; 0: scanlines
    Imf::LevelMode levels = Imf::ONE_LEVEL;
    int sampling = 1;
    float first{};  ///< of the first texel, if not 0
};

inline std::string exr(const Filed& filed)
{
    const Imath::Box2i display{{0, 0}, {19, 16}};
    Imf::Header header(display, filed.window, 1.0F, {0, 0}, 1.0F, filed.order, filed.compression);
    const std::size_t width = static_cast<std::size_t>(filed.window.size().x) + 1;
    const std::size_t height = static_cast<std::size_t>(filed.window.size().y) + 1;
    std::vector<std::vector<float>> planes;
    const std::vector<unsigned> counts(width * height, 7);
    Imf::FrameBuffer buffer;
    std::size_t c = 0;
    planes.reserve(filed.channels.size());
    for (const std::string& name : filed.channels) {
        header.channels().insert(name, Imf::Channel(filed.type, filed.sampling, filed.sampling));
        std::vector<float>& plane = planes.emplace_back(width * height);
        for (std::size_t i = 0; i < plane.size(); ++i) {
            const std::size_t x = i % width, y = i / width;
            plane[i] = static_cast<float>(x + 100 * y) + static_cast<float>(c) / 8.0F;
        }
        if (filed.first != 0.0F) { plane[0] = filed.first; }
        ++c;
    }
    // OpenEXR wants the caller's type to be the file's: halves are made of the floats.
    std::vector<std::vector<half>> halves(planes.size());
    for (std::size_t i = 0; i < planes.size(); ++i) {
        halves[i].assign(planes[i].begin(), planes[i].end());
        const void* const data =
            filed.type == Imf::HALF    ? static_cast<const void*>(halves[i].data())
            : filed.type == Imf::FLOAT ? static_cast<const void*>(planes[i].data())
                                       : static_cast<const void*>(counts.data());
        buffer.insert(filed.channels[i], Imf::Slice::Make(filed.type, data, filed.window, 0, 0,
                                                          filed.sampling, filed.sampling));
    }
    Memory file;
    if (filed.tile > 0) {
        const auto tile = static_cast<unsigned>(filed.tile);
        header.setTileDescription({tile, tile, filed.levels});
        Imf::TiledOutputFile output(file, header, 0);
        for (int level = 0; level < output.numLevels(); ++level) {
            output.setFrameBuffer(buffer);  // coarser levels: the finest one's corner, as good
            output.writeTiles(0, output.numXTiles(level) - 1, 0, output.numYTiles(level) - 1,
                              level);
        }
    } else {
        Imf::OutputFile output(file, header, 0);
        output.setFrameBuffer(buffer);
        output.writePixels(static_cast<int>(height));
    }
    return file.text();
}

/// What OpenEXR itself reads of a file: the named channels, interleaved.
inline std::vector<float> read_by_openexr(const std::string& file,
                                          const std::vector<std::string>& names)
{
    Memory stream(file);
    Imf::InputFile input(stream, 0);
    const Imath::Box2i window = input.header().dataWindow();
    const std::size_t width = static_cast<std::size_t>(window.size().x) + 1;
    const std::size_t height = static_cast<std::size_t>(window.size().y) + 1;
    std::vector<float> values(names.size() * width * height);
    const std::size_t texel = sizeof(float) * names.size();
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < names.size(); ++c) {
        buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, values.data() + c, window, texel,
                                                 texel * width));
    }
    input.setFrameBuffer(buffer);
    input.readPixels(window.min.y, window.max.y);
    return values;
}

}  // namespace relight::test
