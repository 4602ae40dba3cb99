#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <map>
#include <random>
#include <set>

#include "core/io/writers.h"

namespace relight::test {
namespace {

class TextStream : public Imf::IStream {
  public:
    explicit TextStream(const std::string& text) : Imf::IStream("memory"), text_(text) {}
    bool read(char* out, int count) override
    {
        std::memcpy(out, text_.data() + at_, static_cast<std::size_t>(count));
        at_ += static_cast<std::uint64_t>(count);
        return at_ < text_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t at) override { at_ = at; }

  private:
    const std::string& text_;
    std::uint64_t at_ = 0;
};

/// What OpenEXR finds in a file: bits of each channel, comments.
struct Contents {
    int width{}, height{};
    std::map<std::string, std::vector<std::uint32_t>> channels;
    std::vector<std::string> comments;
};

Contents contents_of(const std::string& file)
{
    TextStream stream(file);
    Imf::InputFile input(stream);
    const Imf::Header& header = input.header();
    EXPECT_TRUE(input.isComplete());
    EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
    EXPECT_EQ(header.dataWindow(), header.displayWindow());
    const Imf::Chromaticities rec709;
    EXPECT_EQ(Imf::chromaticities(header).red, rec709.red);
    Contents out;
    out.width = header.dataWindow().max.x + 1;
    out.height = header.dataWindow().max.y + 1;
    Imf::FrameBuffer planes;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        EXPECT_EQ(c.channel().type, Imf::FLOAT) << c.name();
        auto& bits = out.channels[c.name()];
        bits.resize(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
        planes.insert(c.name(), Imf::Slice::Make(Imf::FLOAT, bits.data(), header.dataWindow()));
    }
    input.setFrameBuffer(planes);
    input.readPixels(0, out.height - 1);
    for (int i = 0;; ++i) {
        const auto* const comment =
            header.findTypedAttribute<Imf::StringAttribute>("comment_" + std::to_string(i));
        if (comment == nullptr) { return out; }
        out.comments.push_back(comment->value());
    }
}

/// Any bits but those of a signalling NaN, which arithmetic may quieten: infinities, -0 and
/// subnormal numbers among them.
std::vector<float> any_floats(std::size_t count, std::mt19937& random)
{
    std::vector<float> values;
    while (values.size() < count) {
        const float value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
        values.push_back(value == value ? value : 0.25F);
    }
    return values;
}

TEST(ExrWriter, KeepsEveryBitOfEveryLayer)
{
    std::mt19937 random(1);
    for (const auto& [width, height] : {std::pair{1, 1}, {5, 3}, {33, 16}, {16, 33}, {100, 70}}) {
        const std::size_t texels =
            static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
        const std::vector<float> rgb = any_floats(3 * texels, random);
        const std::vector<float> alpha = any_floats(texels, random);
        const std::vector<float> sd = any_floats(3 * texels, random);
        const std::vector<float> depth = any_floats(texels, random);
        const std::vector<ExrLayer> layers{
            {"", 3, rgb}, {"A", 1, alpha}, {"standard_error", 3, sd}, {"visibility", 1, depth}};
        const Contents read = contents_of(write_exr(width, height, layers, {}));
        ASSERT_EQ(read.width, width);
        ASSERT_EQ(read.height, height);
        const std::map<std::string, std::pair<const std::vector<float>*, std::size_t>> expected{
            {"R", {&rgb, 0}},
            {"G", {&rgb, 1}},
            {"B", {&rgb, 2}},
            {"A", {&alpha, 0}},
            {"standard_error.R", {&sd, 0}},
            {"standard_error.G", {&sd, 1}},
            {"standard_error.B", {&sd, 2}},
            {"visibility.Y", {&depth, 0}}};
        ASSERT_EQ(read.channels.size(), expected.size());
        for (const auto& [name, from] : expected) {
            const auto& [values, offset] = from;
            ASSERT_TRUE(read.channels.contains(name)) << name;
            const std::size_t step = values->size() / texels;
            for (std::size_t i = 0; i < texels; ++i) {
                ASSERT_EQ(read.channels.at(name)[i],
                          std::bit_cast<std::uint32_t>((*values)[step * i + offset]))
                    << name << " at " << i << " of " << width << " x " << height;
            }
        }
    }
}

TEST(ExrWriter, NamesAGreyPictureY)
{
    const std::vector<float> grey{1.0F, 2.0F};
    const Contents read = contents_of(write_exr(2, 1, std::vector<ExrLayer>{{"", 1, grey}}, {}));
    ASSERT_EQ(read.channels.size(), 1U);
    EXPECT_EQ(read.channels.begin()->first, "Y");
}

TEST(ExrWriter, KeepsCommentsAndLongNames)
{
    const std::vector<float> values(3, 0.5F);
    const std::string name = "per_light_" + std::string(200, 'x');
    const std::vector<std::string> comments{"radiance in W/(m^2 sr)", "", "exposure 0 EV"};
    const Contents read =
        contents_of(write_exr(1, 1, std::vector<ExrLayer>{{name, 3, values}}, comments));
    EXPECT_EQ(read.comments, comments);
    EXPECT_TRUE(read.channels.contains(name + ".R"));
}

TEST(ExrWriter, GivesTheSameBytesWithAnyThreads)
{
    std::mt19937 random(2);
    const std::vector<float> rgb = any_floats(std::size_t{3} * 90 * 80, random);
    const std::vector<ExrLayer> layers{{"", 3, rgb}};
    const std::string once = write_exr(90, 80, layers, {});
    Imf::setGlobalThreadCount(4);
    EXPECT_EQ(write_exr(90, 80, layers, {}), once);
    Imf::setGlobalThreadCount(0);
}

}  // namespace
}  // namespace relight::test
