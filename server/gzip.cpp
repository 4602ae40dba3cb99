#include "server/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

namespace relight {
namespace {

/// Packs what it is given for a sink, which gets blocks.
class Packer {
  public:
    explicit Packer(const Sink& sink) : sink_(sink), block_(block_bytes)
    {
        constexpr int gzip_wrapper = 15 + 16;  // zlib's way to say so, window 32 KiB
        if (deflateInit2(&stream_, Z_BEST_SPEED, Z_DEFLATED, gzip_wrapper, 8, Z_DEFAULT_STRATEGY) !=
            Z_OK) {
            throw std::runtime_error("deflateInit2 failed");
        }
        empty_block();
    }
    Packer(const Packer&) = delete;
    Packer& operator=(const Packer&) = delete;
    ~Packer() { deflateEnd(&stream_); }

    /// False if the sink refuses.
    bool add(std::string_view bytes)
    {
        constexpr std::size_t most = std::size_t{1} << 30U;  // zlib counts in unsigned
        for (; !bytes.empty(); bytes.remove_prefix(std::min(most, bytes.size()))) {
            // zlib does not write through next_in; its type is older than const.
            stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
            stream_.avail_in = static_cast<uInt>(std::min(most, bytes.size()));
            while (stream_.avail_in > 0) {
                if (stream_.avail_out == 0 && !give()) { return false; }
                deflate(&stream_, Z_NO_FLUSH);
            }
        }
        return true;
    }

    bool finish()
    {
        while (deflate(&stream_, Z_FINISH) != Z_STREAM_END) {
            if (!give()) { return false; }
        }
        return give();
    }

  private:
    bool give()
    {
        const bool taken = sink_({block_.data(), block_.size() - stream_.avail_out});
        empty_block();
        return taken;
    }
    void empty_block()
    {
        stream_.next_out = reinterpret_cast<Bytef*>(block_.data());
        stream_.avail_out = static_cast<uInt>(block_.size());
    }

    static constexpr std::size_t block_bytes = std::size_t{1} << 16U;
    const Sink& sink_;
    std::vector<char> block_;
    z_stream stream_ = {};
};

}  // namespace

Encoding gzipped(Encoding plain)
{
    return {0, [plain = std::move(plain)](const Sink& sink) {
                Packer packer(sink);
                return plain.write([&](std::string_view bytes) { return packer.add(bytes); }) &&
                       packer.finish();
            }};
}

std::string gzip(std::string_view bytes)
{
    return whole(gzipped({0, [bytes](const Sink& sink) { return sink(bytes); }}));
}

}  // namespace relight
