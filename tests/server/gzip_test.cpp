#include "server/gzip.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <random>

namespace relight {
namespace {

/// Digits in no order: they pack to about half.
std::string digits(std::size_t size)
{
    std::minstd_rand numbers(1);
    std::string text(size, ' ');
    for (char& c : text) { c = static_cast<char>('0' + numbers() % 10); }
    return text;
}

/// In pieces of so many bytes.
Encoding in_pieces(const std::string& text, std::size_t bytes)
{
    return {0, [&text, bytes](const Sink& sink) {
                for (std::size_t i = 0; i < text.size(); i += bytes) {
                    if (!sink(std::string_view(text).substr(i, bytes))) { return false; }
                }
                return true;
            }};
}

TEST(Gzip, ReadsBack)
{
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{3'000'000}}) {
        const std::string text = digits(size);
        const std::string packed = gzip(text);
        std::string out(size + 1, ' ');
        z_stream stream = {};
        ASSERT_EQ(inflateInit2(&stream, 31), Z_OK);
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
        stream.avail_in = static_cast<uInt>(packed.size());
        stream.next_out = reinterpret_cast<Bytef*>(out.data());
        stream.avail_out = static_cast<uInt>(out.size());
        EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
        out.resize(stream.total_out);
        inflateEnd(&stream);
        EXPECT_EQ(out, text);
    }
}

TEST(Gzip, GivesTheSameBytesWhateverThePiecesAre)
{
    const std::string text = digits(1'000'000);
    for (const std::size_t bytes : {std::size_t{7}, std::size_t{1000}, std::size_t{300'000}}) {
        EXPECT_TRUE(whole(gzipped(in_pieces(text, bytes))) == gzip(text)) << bytes;
    }
}

TEST(Gzip, SendsWhatIsPackedBeforeAllIsThereAndStopsWhenTheReceiverIsGone)
{
    const std::string text = digits(3'000'000);
    std::size_t read = 0;
    const Encoding counted{0, [&](const Sink& sink) {
                               return in_pieces(text, 1000).write([&](std::string_view bytes) {
                                   read += bytes.size();
                                   return sink(bytes);
                               });
                           }};
    EXPECT_FALSE(gzipped(counted).write([](std::string_view) { return false; }));
    EXPECT_GT(read, 0U);
    EXPECT_LT(read, text.size());
}

}  // namespace
}  // namespace relight
