#include "server/import/exr.h"

#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfVersion.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <optional>
#include <string>

namespace relight {
namespace {

using Failure = std::optional<Error>;

Error error(Fault fault, std::string detail)
{
    return {fault, std::move(detail), {}, {}, {}};
}

/// The file, in memory; remembers whether more was asked for than it has.
class SpanStream : public Imf::IStream {
  public:
    explicit SpanStream(std::span<const std::byte> file) : Imf::IStream("memory"), file_(file) {}

    bool read(char* out, int count) override
    {
        const std::uint64_t left = at_ < file_.size() ? file_.size() - at_ : 0;
        if (count < 0 || static_cast<std::uint64_t>(count) > left) {
            ran_out_ = true;
            throw Iex::InputExc("the file ends here");
        }
        std::memcpy(out, file_.data() + at_, static_cast<std::size_t>(count));
        at_ += static_cast<std::uint64_t>(count);
        return at_ < file_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t at) override { at_ = at; }

    bool ran_out() const { return ran_out_; }

  private:
    std::span<const std::byte> file_;
    std::uint64_t at_ = 0;
    bool ran_out_ = false;
};

struct Window {
    Imath::Box2i box;
    std::uint64_t width{}, height{};
};

Result<Window> data_window(const Imf::Header& header, std::uint64_t most_pixels)
{
    const Imath::Box2i& box = header.dataWindow();
    const std::int64_t width = std::int64_t{box.max.x} - box.min.x + 1;
    const std::int64_t height = std::int64_t{box.max.y} - box.min.y + 1;
    if (width < 1 || height < 1) {
        return error(Fault::MalformedHeader, "the data window is empty");
    }
    const Window window{box, static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height)};
    const auto most = std::min<std::uint64_t>(most_pixels, std::numeric_limits<int>::max());
    if (window.width > most / window.height) {
        return error(Fault::OutOfRange, "the data window has " + std::to_string(width) + " x " +
                                            std::to_string(height) + " texels; the limit is " +
                                            std::to_string(most));
    }
    return window;
}

Result<Imf::Header> read_header(SpanStream& stream)
{
    const auto next = [&] {
        char bytes[4];
        stream.read(bytes, 4);
        int value = 0;
        std::memcpy(&value, bytes, 4);
        return value;
    };
    if (next() != Imf::MAGIC) {
        return error(Fault::MalformedHeader, "the file does not start as OpenEXR does");
    }
    int version = next();
    if (Imf::getVersion(version) != Imf::EXR_VERSION ||
        !Imf::supportsFlags(Imf::getFlags(version))) {
        return error(Fault::NotAvailable, "only version 2 of OpenEXR is read");
    }
    if (Imf::isNonImage(version)) {
        return error(Fault::NotAvailable, "deep pictures are not read; send flat R G B");
    }
    if (Imf::isMultiPart(version)) {
        return error(Fault::NotAvailable,
                     "a picture of several parts is not read; send the one part alone");
    }
    Imf::Header header;
    header.readFrom(stream, version);
    if (header.hasType() && Imf::isDeepData(header.type())) {
        return error(Fault::NotAvailable, "deep pictures are not read; send flat R G B");
    }
    return header;
}

/// The names of the channels that are read: R G B, or Y three times.
Result<std::array<const char*, 3>> choose_channels(const Imf::Header& header)
{
    const Imf::ChannelList& list = header.channels();
    const bool has_y = list.findChannel("Y") != nullptr;
    const bool has_rgb = list.findChannel("R") != nullptr && list.findChannel("G") != nullptr &&
                         list.findChannel("B") != nullptr;
    const bool chroma = list.findChannel("RY") != nullptr || list.findChannel("BY") != nullptr;
    if (!has_rgb && (!has_y || chroma)) {
        std::string names;
        for (auto c = list.begin(); c != list.end() && names.size() < 64; ++c) {
            names += std::string(names.empty() ? "" : ", ") + c.name();
        }
        return error(Fault::NotAvailable, "the channels are " + (names.empty() ? "none" : names) +
                                              "; R, G and B are read, or Y without RY and BY");
    }
    std::array<const char*, 3> names{"R", "G", "B"};
    if (!has_rgb) { names = {"Y", "Y", "Y"}; }
    for (const char* name : names) {
        const Imf::Channel& channel = *list.findChannel(name);
        if (channel.type != Imf::HALF && channel.type != Imf::FLOAT) {
            return error(Fault::NotAvailable, std::string("channel ") + name +
                                                  " holds integers; 16 or 32-bit floats are read");
        }
        if (channel.xSampling != 1 || channel.ySampling != 1) {
            return error(Fault::NotAvailable,
                         std::string("channel ") + name + " has not a value for every texel");
        }
    }
    return names;
}

/// Everything finite or an error; what is below 0 becomes 0 and is counted.
Failure check_values(DecodedImage& decoded)
{
    const auto width = static_cast<std::size_t>(decoded.image.width);
    for (std::size_t i = 0; i < decoded.image.pixels.size(); ++i) {
        for (float& value : decoded.image.pixels[i]) {
            if (!std::isfinite(value)) {
                return error(Fault::NotFinite, "the texel in column " + std::to_string(i % width) +
                                                   ", row " + std::to_string(i / width) +
                                                   " is infinite or no number");
            }
            if (value < 0.0F) { ++decoded.negatives; }
            if (value <= 0.0F) { value = 0.0F; }  // -0 as well
        }
    }
    return {};
}

Result<DecodedImage> decode(SpanStream& stream, std::uint64_t most_pixels)
{
    const Result<Imf::Header> header = read_header(stream);
    if (!header) { return header.error(); }
    const Result<Window> window = data_window(*header, most_pixels);
    if (!window) { return window.error(); }
    const auto channels = choose_channels(*header);
    if (!channels) { return channels.error(); }

    stream.seekg(0);
    Imf::InputFile file(stream, 0);  // on this thread
    if (!file.isComplete()) {
        return error(Fault::Truncated, "some of the picture's blocks are missing");
    }
    DecodedImage decoded;
    Image& image = decoded.image;
    image.width = static_cast<int>(window->width);
    image.height = static_cast<int>(window->height);
    image.pixels.resize(window->width * window->height);
    const bool grey = (*channels)[0] == (*channels)[1];
    Imf::FrameBuffer planes;
    for (std::size_t band = 0; band < (grey ? 1 : 3); ++band) {
        planes.insert((*channels)[band],
                      Imf::Slice::Make(Imf::FLOAT, image.pixels.data()->data() + band, window->box,
                                       sizeof(Rgbf), sizeof(Rgbf) * window->width));
    }
    file.setFrameBuffer(planes);
    file.readPixels(window->box.min.y, window->box.max.y);
    if (grey) {
        for (Rgbf& texel : image.pixels) { texel = {texel[0], texel[0], texel[0]}; }
    }
    if (auto failure = check_values(decoded)) { return std::move(*failure); }
    if (grey) { decoded.negatives /= 3; }
    return decoded;
}

}  // namespace

void prepare_exr()
{
    Imf::staticInitialize();
    Imf::setGlobalThreadCount(0);
}

Result<DecodedImage> decode_exr(std::span<const std::byte> file, std::uint64_t most_pixels)
{
    SpanStream stream(file);
    try {
        return decode(stream, most_pixels);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception&) {  // whose text is the library's, not for clients
        return stream.ran_out()
                   ? error(Fault::Truncated, "the file ends before the data that it announces")
                   : error(Fault::MalformedBody, "the file is not what OpenEXR says it should be");
    }
}

}  // namespace relight
