#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/io/sender.h"

namespace relight {

/// An answer that is written while it is sent: nobody holds all of it.
struct Encoding {
    std::uint64_t bytes = 0;  ///< that `write` gives, exactly; 0: nobody knows before (text)
    /// Gives the bytes to the sink in order; false if the sink refused, and then nothing follows.
    /// The same bytes at each call. What the encoding was made of must still be there.
    std::function<bool(const Sink&)> write;
};

/// A sink that keeps the bytes. It is done at once: a thread that waited for it would cost more.
struct Append {
    std::string* out;

    bool operator()(std::string_view bytes) const
    {
        *out += bytes;
        return true;
    }
};

/// All of it as one string.
inline std::string whole(const Encoding& encoding)
{
    std::string out;
    out.reserve(encoding.bytes);
    encoding.write(Append{&out});
    assert(encoding.bytes == 0 || out.size() == encoding.bytes);
    return out;
}

/// One that was written before.
inline Encoding sent_whole(std::string bytes)
{
    const auto kept = std::make_shared<const std::string>(std::move(bytes));
    return {kept->size(), [kept](const Sink& sink) { return kept->empty() || sink(*kept); }};
}

/// Collects small pieces for a sink in two blocks of memory that are used again and again: fresh
/// memory costs more than filling it. One is filled while the other is sent.
class BlockOut {
  public:
    explicit BlockOut(const Sink& sink) : sink_(sink), block_(block_bytes) {}

    /// Room for `bytes` more: fill it whole. Stays valid until the next call.
    char* room(std::size_t bytes)
    {
        if (bytes > block_.size() - used_) { hand_over(); }
        if (bytes > block_.size()) { block_ = std::vector<char>(bytes); }
        used_ += bytes;
        return block_.data() + used_ - bytes;
    }

    /// Gives back what lies behind `end` of the room that was asked for last.
    void end_at(const char* end) { used_ = static_cast<std::size_t>(end - block_.data()); }

    /// What was collected last; at least one byte must have been, since bytes().
    char& back() { return block_[used_ - 1]; }

    template <class T>
    void number(T value)
    {
        std::memcpy(room(sizeof(T)), &value, sizeof(T));
    }

    /// Bytes as they are: few are collected, many go to the sink without a copy.
    void bytes(std::string_view text)
    {
        if (text.size() < direct_bytes) {
            std::copy(text.begin(), text.end(), room(text.size()));
        } else if (flush()) {
            open_ = sink_(text);
        }
    }

    /// Gives the sink what was collected. False if it refuses or has refused: then all that follows
    /// is dropped, and there is no use in going on.
    bool flush()
    {
        if (sender_) { open_ = sender_->wait() && open_; }
        if (open_ && used_ > 0) { open_ = sink_({block_.data(), used_}); }
        used_ = 0;
        return open_;
    }
    bool open() const { return open_; }

    /// Small enough for a core's own cache, large enough that a call of the sink does not matter.
    static constexpr std::size_t block_bytes = std::size_t{1} << 18;

  private:
    /// Has the block sent, and goes on in the other. What fits in one block needs no thread.
    void hand_over()
    {
        if (sink_.target<Append>() != nullptr) {
            flush();
        } else if (open_ && used_ > 0) {
            if (!sender_) { sender_.emplace(sink_); }
            open_ = sender_->send({block_.data(), used_});
            block_.swap(other_);
            if (block_.empty()) { block_ = std::vector<char>(block_bytes); }
        }
        used_ = 0;
    }

    static constexpr std::size_t direct_bytes = std::size_t{1} << 16;
    const Sink& sink_;
    std::vector<char> block_, other_;
    std::size_t used_ = 0;
    bool open_ = true;
    std::optional<Sender> sender_;  // last: it ends before the blocks do
};

}  // namespace relight
