#include "server/import/archive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <tuple>

#include "server/import/archive_members.h"
#include "server/import/promises.h"

namespace relight {
namespace {

/// What travels as its own bytes, whatever they are.
template <class T, class... Types>
concept one_of = (std::same_as<T, Types> || ...);
template <class T>
concept Plain = one_of<T, std::uint8_t, std::uint32_t, std::uint64_t, int, float, double, Point3,
                       Vec3, Rgb, Rgbf, Uv, std::array<float, 4>, std::array<float, 6>,
                       std::array<std::uint8_t, 4>, GltfPiece>;
static_assert(sizeof(GltfPiece) == 5 * sizeof(std::uint32_t), "no padding travels");

/// bool and Wrap: a byte, and the greatest that it may be.
template <class T>
concept Choice = one_of<T, bool, Wrap>;
template <Choice T>
constexpr std::uint8_t greatest = std::same_as<T, bool> ? 1 : std::uint8_t{2};
static_assert(greatest<Wrap> == static_cast<std::uint8_t>(Wrap::MirroredRepeat));

/// Arrays begin at a multiple of this, so that they can be read where they lie.
constexpr std::size_t alignment = 8;

constexpr std::size_t padding(std::uint64_t at)
{
    return (alignment - at % alignment) % alignment;
}

using Sink = std::function<bool(std::span<const std::byte>)>;

/// Each call writes one value; false once the sink has refused, or for what cannot travel.
class Writer {
  public:
    explicit Writer(const Sink& sink) : sink_(sink) {}

    template <Plain T>
    bool operator()(const T& value)
    {
        return bytes(std::as_bytes(std::span(&value, 1)));
    }
    template <Choice T>
    bool operator()(const T& value)
    {
        return (*this)(static_cast<std::uint8_t>(value));
    }
    template <class T>
    bool operator()(const std::vector<T>& values)
    {
        if (!(*this)(std::uint64_t{values.size()})) { return false; }
        if constexpr (Plain<T>) {
            static_assert(alignof(T) <= alignment);
            constexpr std::array<std::byte, alignment> zeros{};
            return bytes(std::span(zeros).first(padding(at_))) &&
                   bytes(std::as_bytes(std::span(values)));
        } else {
            return std::all_of(values.begin(), values.end(),
                               [&](const T& v) { return (*this)(v); });
        }
    }
    template <class T>
    bool operator()(const std::optional<T>& value)
    {
        return (*this)(value.has_value()) && (!value || (*this)(*value));
    }
    bool operator()(const std::string& text)
    {
        return (*this)(std::uint64_t{text.size()}) && bytes(std::as_bytes(std::span(text)));
    }
    bool operator()(const Dir3& direction) { return (*this)(Vec3(direction)); }
    bool operator()(const LightShape& shape)
    {
        const auto* const point = std::get_if<PointLight>(&shape);
        const auto* const spot = std::get_if<SpotLight>(&shape);
        const auto* const sun = std::get_if<DirectionalLight>(&shape);
        return (*this)(static_cast<std::uint8_t>(shape.index())) &&
               (point != nullptr  ? (*this)(*point)
                : spot != nullptr ? (*this)(*spot)
                                  : sun != nullptr && (*this)(*sun));
    }
    template <archive::Described T>
    bool operator()(const T& value)
    {
        return std::apply([&](const auto&... member) { return ((*this)(member) && ...); },
                          archive::members(value));
    }

    bool flush()
    {
        const std::span<const std::byte> bytes(small_.data(), size_);
        size_ = 0;
        return bytes.empty() || sink_(bytes);
    }

  private:
    bool bytes(std::span<const std::byte> bytes)
    {
        at_ += bytes.size();
        if (bytes.size() > small_.size() - size_ && !flush()) { return false; }
        if (bytes.size() > small_.size()) { return sink_(bytes); }
        std::copy(bytes.begin(), bytes.end(), small_.data() + size_);
        size_ += bytes.size();
        return true;
    }

    const Sink& sink_;
    std::array<std::byte, 4096> small_{};  // what is too little for a call of its own
    std::size_t size_ = 0;
    std::uint64_t at_ = 0;  // bytes so far
};

/// Elements of a list whose memory outgrows its bytes here: more than any file has of them, and few
/// enough to be had.
constexpr std::uint64_t most_elements = 1U << 20U;

/// Each call reads one value; false if the bytes say none.
class Reader {
  public:
    explicit Reader(std::span<const std::byte> bytes) : left_(bytes) {}

    bool at_end() const { return left_.empty(); }

    template <Plain T>
    bool operator()(T& value)
    {
        return copy(&value, 1);
    }
    template <Choice T>
    bool operator()(T& value)
    {
        std::uint8_t byte = 0;
        if (!(*this)(byte) || byte > greatest<T>) { return false; }
        value = static_cast<T>(byte);
        return true;
    }
    template <class T>
    bool operator()(std::vector<T>& values)
    {
        std::uint64_t count = 0;
        if (!(*this)(count)) { return false; }
        if constexpr (Plain<T>) {
            const std::size_t gap = padding(reinterpret_cast<std::uintptr_t>(left_.data()));
            if (gap > left_.size() || count > (left_.size() - gap) / sizeof(T)) { return false; }
            const auto* const first = reinterpret_cast<const T*>(left_.data() + gap);
            values.assign(first, first + count);  // once over: no zeros before
            left_ = left_.subspan(gap + count * sizeof(T));
            return true;
        } else {
            if (count > most_elements) { return false; }
            while (count > 0 && (*this)(values.emplace_back())) { --count; }
            return count == 0;
        }
    }
    template <class T>
    bool operator()(std::optional<T>& value)
    {
        bool is_there = false;
        return (*this)(is_there) && (!is_there || (*this)(value.emplace()));
    }
    bool operator()(std::string& text)
    {
        std::uint64_t size = 0;
        if (!(*this)(size) || size > left_.size()) { return false; }
        text.resize(size);
        return copy(text.data(), size);
    }
    bool operator()(Dir3& direction)
    {
        constexpr double rounding = 1e-9;
        Vec3 filed;
        if (!(*this)(filed) || !(std::abs(dot(filed, filed) - 1.0) < rounding)) { return false; }
        direction = normalize(filed);
        return true;
    }
    bool operator()(LightShape& shape)
    {
        std::uint8_t index = 0;
        if (!(*this)(index)) { return false; }
        if (index == LightShape(PointLight{}).index()) {
            return (*this)(shape.emplace<PointLight>());
        }
        if (index == LightShape(SpotLight{}).index()) {
            return (*this)(shape.emplace<SpotLight>());
        }
        return index == LightShape(DirectionalLight{}).index() &&
               (*this)(shape.emplace<DirectionalLight>());
    }
    template <archive::Described T>
    bool operator()(T& value)
    {
        return std::apply([&](auto&... member) { return ((*this)(member) && ...); },
                          archive::members(value));
    }

  private:
    template <class T>
    bool copy(T* to, std::size_t count)
    {
        const std::size_t size = count * sizeof(T);  // of an array that is there: no overflow
        if (size > left_.size()) { return false; }
        if (size > 0) { std::memcpy(to, left_.data(), size); }
        left_ = left_.subspan(size);
        return true;
    }

    std::span<const std::byte> left_;
};

}  // namespace

bool write_asset(const Asset& asset, const Sink& sink)
{
    Writer write(sink);
    return write(asset) && write.flush();
}

std::optional<Asset> read_asset(std::span<const std::byte> bytes)
{
    Reader read(bytes);
    std::optional<Asset> asset(std::in_place);
    if (!read(*asset) || !read.at_end() || !keeps_promises(*asset)) { asset.reset(); }
    return asset;
}

}  // namespace relight
