#include <gtest/gtest.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>
#include <zlib.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "core/io/writers.h"
#include "core/io/zip_writer.h"
#include "tests/written.h"

namespace relight {
namespace {

/// The little-endian number of `size` bytes at `at`.
std::uint64_t number(std::string_view bytes, std::size_t at, std::size_t size)
{
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
        value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes.at(at + i))) << 8 * i;
    }
    return value;
}

/// A stored zip's files, found through its central directory; every checksum and header is held
/// against the other (PKWARE APPNOTE 6.3, section 4.3; `zip64`: 4.5.3).
std::map<std::string, std::string> unzip(std::string_view zip, bool zip64)
{
    std::map<std::string, std::string> files;
    const std::size_t end = zip.size() - 22;
    EXPECT_EQ(zip.substr(end, 4), "PK\5\6");
    std::uint64_t count = number(zip, end + 10, 2), at = number(zip, end + 16, 4);
    if (zip64) {
        EXPECT_EQ(zip.substr(end - 20, 4), "PK\6\7");
        const std::uint64_t record = number(zip, end - 20 + 8, 8);
        EXPECT_EQ(zip.substr(record, 4), "PK\6\6");
        EXPECT_EQ(record + 12 + number(zip, record + 4, 8), end - 20);
        count = number(zip, record + 32, 8);
        at = number(zip, record + 48, 8);
    }
    for (; count > 0; --count) {
        EXPECT_EQ(zip.substr(at, 4), "PK\1\2");
        EXPECT_EQ(number(zip, at + 10, 2), 0U);  // stored
        const std::uint64_t name_size = number(zip, at + 28, 2);
        const std::uint64_t extra = at + 46 + name_size + 4;
        const std::string name(zip.substr(at + 46, name_size));
        const std::uint64_t size = zip64 ? number(zip, extra, 8) : number(zip, at + 24, 4);
        const std::uint64_t local = zip64 ? number(zip, extra + 16, 8) : number(zip, at + 42, 4);
        EXPECT_EQ(zip.substr(local, 4), "PK\3\4");
        EXPECT_EQ(zip.substr(local + 6, 22), zip.substr(at + 8, 22));  // the shared fields
        EXPECT_EQ(zip.substr(local + 30, name_size), name);
        const std::string_view data =
            zip.substr(local + 30 + name_size + number(zip, local + 28, 2), size);
        EXPECT_EQ(number(zip, at + 16, 4), crc32(0, reinterpret_cast<const Bytef*>(data.data()),
                                                 static_cast<uInt>(data.size())));
        EXPECT_TRUE(files.emplace(name, data).second) << name;
        at += 46 + name_size + number(zip, at + 30, 2);
    }
    return files;
}

/// A .npy file's header and values.
template <class T>
struct Npy {
    std::string header;
    std::vector<T> values;

    explicit Npy(const std::string& file)
    {
        EXPECT_EQ(file.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
        const std::size_t start = 10 + number(file, 8, 2);
        EXPECT_EQ(start % 64, 0U);
        EXPECT_EQ(file[start - 1], '\n');
        header = file.substr(10, file.find_last_not_of(" \n", start - 1) - 9);
        values.resize((file.size() - start) / sizeof(T));
        std::memcpy(values.data(), file.data() + start, file.size() - start);
    }
};

Mesh quad()
{
    Mesh mesh;
    mesh.positions = {{0.1, 0, 0}, {1e15, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.faces.indices = {0, 1, 2, 1, 3, 2};
    return mesh;
}

TEST(WriteNpz, HoldsEachArrayByNameTypeAndShape)
{
    const Mesh mesh = quad();
    const std::vector<Dir3> normals(4, normalize({0, 3, 4}));
    const std::vector<Rgb8> color = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {255, 0, 128}};
    const std::vector<float> E = {1, 2, 3, 4, 5, 6, 7, 8, 9, 0.1F, 1e-45F, 3e38F};
    const std::vector<float> visibility = {0, 1, 0.5F, 0.25F};
    const LitMesh lit{
        mesh, normals, color, {{"irradiance", 3, E}, {"visibility_key", 1, visibility}}, {}};
    auto files = unzip(write_npz(lit), false);
    ASSERT_EQ(files.size(), 6U);
    const Npy<double> positions(files["positions.npy"]);
    EXPECT_EQ(positions.header, "{'descr': '<f8', 'fortran_order': False, 'shape': (4,3), }");
    EXPECT_EQ(positions.values, (std::vector<double>{0.1, 0, 0, 1e15, 0, 0, 0, 1, 0, 0, 0, 1}));
    const Npy<std::int32_t> faces(files["faces.npy"]);
    EXPECT_EQ(faces.header, "{'descr': '<i4', 'fortran_order': False, 'shape': (2,3), }");
    EXPECT_EQ(faces.values, (std::vector<std::int32_t>{0, 1, 2, 1, 3, 2}));
    const Npy<unsigned char> colors(files["color.npy"]);
    EXPECT_EQ(colors.header, "{'descr': '|u1', 'fortran_order': False, 'shape': (4,3), }");
    EXPECT_EQ(colors.values, (std::vector<unsigned char>{1, 2, 3, 4, 5, 6, 7, 8, 9, 255, 0, 128}));
    EXPECT_EQ(Npy<float>(files["normal.npy"]).values.at(2), 0.8F);
    EXPECT_EQ(Npy<float>(files["irradiance.npy"]).values, E);
    const Npy<float> v(files["visibility_key.npy"]);
    EXPECT_EQ(v.header, "{'descr': '<f4', 'fortran_order': False, 'shape': (4,), }");
    EXPECT_EQ(v.values, visibility);
}

TEST(WriteNpz, PolygonsComeWithTheirOffsets)
{
    Mesh mesh = quad();
    mesh.faces.indices = {0, 1, 3, 2};
    mesh.faces.offsets = {0, 4};
    auto files = unzip(write_npz({mesh, {}, {}, {}, {}}), false);
    EXPECT_EQ(Npy<std::int32_t>(files["faces.npy"]).values,
              (std::vector<std::int32_t>{0, 1, 3, 2}));
    EXPECT_EQ(Npy<std::int32_t>(files["face_offsets.npy"]).values,
              (std::vector<std::int32_t>{0, 4}));
}

TEST(WriteNpz, NamesOfLightsAreFilesInTheArchiveAndNowhereElse)
{
    const Mesh mesh = quad();
    const std::vector<float> values(4, 1.0F);
    const auto files = unzip(write_npz({mesh,
                                        {},
                                        {},
                                        {{"../../etc/x", 1, values},
                                         {"lämpa", 1, values},
                                         {"faces", 1, values},
                                         {"faces", 1, values}},
                                        {}}),
                             false);
    EXPECT_TRUE(files.contains(".._.._etc_x.npy"));
    EXPECT_TRUE(files.contains("lämpa.npy"));
    EXPECT_TRUE(files.contains("faces_.npy"));
    EXPECT_TRUE(files.contains("faces__.npy"));
}

TEST(EncodeZip, BigArchivesUse64BitSizes)  // the threshold lowered, so that no test needs 4 GiB
{
    std::vector<ZipFile> kept;
    for (const auto& [name, text] : {std::pair{"a", "first"}, {"b", ""}, {"c", "third"}}) {
        kept.push_back({name, text_piece(text)});
    }
    const std::string zip = whole(encode_zip(kept, 100));
    const auto files = unzip(zip, true);
    EXPECT_EQ(files,
              (std::map<std::string, std::string>{{"a", "first"}, {"b", ""}, {"c", "third"}}));
}

/// Pixels as VTK's reader finds them, row 0 on top.
std::vector<unsigned char> decode_png(const std::string& png, int width, int height, int components)
{
    vtkNew<vtkPNGReader> reader;
    reader->SetMemoryBuffer(png.data());
    reader->SetMemoryBufferLength(static_cast<vtkIdType>(png.size()));
    reader->Update();
    vtkImageData* const image = reader->GetOutput();
    EXPECT_EQ(image->GetDimensions()[0], width);
    EXPECT_EQ(image->GetDimensions()[1], height);
    EXPECT_EQ(image->GetNumberOfScalarComponents(), components);
    std::vector<unsigned char> pixels;
    for (int y = height - 1; y >= 0; --y) {
        const auto* row = static_cast<const unsigned char*>(image->GetScalarPointer(0, y, 0));
        pixels.insert(pixels.end(), row, row + static_cast<std::ptrdiff_t>(width) * components);
    }
    return pixels;
}

TEST(WritePng, PixelsAndAlphaReadBackTheSame)
{
    constexpr int width = 37, height = 11;
    std::mt19937 random(1);
    std::vector<Rgb8> pixels(std::size_t{width} * height);
    std::vector<unsigned char> alpha, rgb, rgba;
    for (Rgb8& pixel : pixels) {
        for (unsigned char& code : pixel) { code = static_cast<unsigned char>(random()); }
        alpha.push_back(static_cast<unsigned char>(random()));
        rgb.insert(rgb.end(), pixel.begin(), pixel.end());
        rgba.insert(rgba.end(), pixel.begin(), pixel.end());
        rgba.push_back(alpha.back());
    }
    const std::string png = write_png(width, height, pixels);
    EXPECT_EQ(decode_png(png, width, height, 3), rgb);
    EXPECT_EQ(decode_png(write_png(width, height, pixels, alpha), width, height, 4), rgba);
    EXPECT_EQ(png, write_png(width, height, pixels));  // the same bytes again
}

TEST(WritePng, EveryChunkIsWholeAndOneSaysSrgb)  // PNG specification, sections 5.3 and 11.3.3.5
{
    const std::string png = write_png(2, 1, std::vector<Rgb8>{{1, 2, 3}, {4, 5, 6}});
    EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
    std::string kinds;
    for (std::size_t at = 8; at < png.size();) {
        const auto big_endian = [&](std::size_t place) {
            const std::string bytes(png.rbegin() + static_cast<long>(png.size() - place - 4),
                                    png.rbegin() + static_cast<long>(png.size() - place));
            return number(bytes, 0, 4);
        };
        const std::size_t length = big_endian(at);
        const auto* body = reinterpret_cast<const Bytef*>(png.data() + at + 4);
        EXPECT_EQ(big_endian(at + 8 + length), crc32(0, body, static_cast<uInt>(4 + length)));
        kinds += png.substr(at + 4, 4) + " ";
        at += 12 + length;
    }
    EXPECT_EQ(kinds, "IHDR sRGB IDAT IEND ");
}

TEST(AppendJson, NumbersReadBackExactlyInTheFewestDigits)
{
    std::string out = "x=";
    append_json(out, std::vector<float>{0.1F, 1.0F, -0.0F, 16777216.0F, 1e-45F, 3.4e38F}, 3);
    EXPECT_EQ(out, "x=[[0.1,1,-0],[16777216,1e-45,3.4e+38]]");

    std::mt19937 random(5);
    std::vector<float> values;
    while (values.size() < 10'000) {
        const auto bits = static_cast<std::uint32_t>(random());
        float value = 0.0F;
        std::memcpy(&value, &bits, sizeof(value));
        if (std::isfinite(value)) { values.push_back(value); }
    }
    out.clear();
    append_json(out, values, 1);
    const auto json = nlohmann::json::parse(out);
    ASSERT_EQ(json.size(), values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        ASSERT_EQ(static_cast<float>(json[i].get<double>()), values[i]);
    }
}

TEST(AppendJson, WhatJsonCannotSayIsNull)
{
    std::string out;
    append_json(out, std::vector<float>{1.0F, NAN, INFINITY}, 1);
    append_json(out, {}, 3);
    EXPECT_EQ(out, "[1,null,null][]");
}

}  // namespace
}  // namespace relight
