#include "server/import/gltf_accessor.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "server/import/gltf_bytes.h"

namespace relight::gltf {
namespace {

struct Shape {
    std::string_view name;
    std::size_t rows, columns;
};
constexpr Shape shapes[] = {{"SCALAR", 1, 1}, {"VEC2", 2, 1}, {"VEC3", 3, 1}, {"VEC4", 4, 1},
                            {"MAT2", 2, 2},   {"MAT3", 3, 3}, {"MAT4", 4, 4}};

Component component_of(const Node& node)
{
    const std::uint64_t code = node.count("componentType", 0);
    for (const Component known : {Component::I8, Component::U8, Component::I16, Component::U16,
                                  Component::U32, Component::F32}) {
        if (code == static_cast<std::uint64_t>(known)) { return known; }
    }
    refuse(Fault::MalformedBody, node.where() + "/componentType",
           "is " + std::to_string(code) + ", and must be 5120 to 5123, 5125 or 5126");
}

std::size_t column_bytes(const Layout& layout)
{
    const std::size_t bytes = layout.rows * bytes_of(layout.component);
    return layout.columns == 1 ? bytes : (bytes + 3) / 4 * 4;
}

/// Lays `count` elements over the view that `node` names, and refuses those that leave it.
void lay(File& file, const Node& node, std::uint64_t count, Layout& layout)
{
    const Node asked = node.at("bufferView");
    const auto view = file.view(node.count("bufferView", 0), asked.where());
    const std::uint64_t offset = node.count("byteOffset", 0);
    const std::size_t element = layout.element_bytes();
    layout.stride = view.stride == 0 ? element : view.stride;
    if (layout.stride < element) {
        refuse(Fault::MalformedBody, node.where(),
               "has elements of " + std::to_string(element) +
                   " bytes, which the view's stride of " + std::to_string(layout.stride) +
                   " makes overlap");
    }
    const std::size_t bytes = view.bytes.size();
    if (offset > bytes || element > bytes - offset ||
        count - 1 > (bytes - offset - element) / layout.stride) {
        refuse(Fault::CountExceedsFile, node.where(),
               std::to_string(count) + " elements, " + std::to_string(layout.stride) +
                   " bytes apart from byte " + std::to_string(offset) +
                   " on, are more than the view's " + std::to_string(bytes) + " bytes hold");
    }
    layout.bytes = view.bytes.subspan(offset);
}

Accessor::Sparse read_sparse(File& file, const Node& node, const Accessor& of)
{
    Accessor::Sparse sparse;
    sparse.count = node.count("count", 0);
    if (sparse.count == 0 || sparse.count > of.count) {
        refuse(Fault::OutOfRange, node.where() + "/count",
               "is " + std::to_string(sparse.count) + ", and must be from 1 to the accessor's " +
                   std::to_string(of.count));
    }
    const Node indices = node.at("indices");
    sparse.indices.component = component_of(indices);
    lay(file, indices, sparse.count, sparse.indices);
    sparse.values = of.layout;
    lay(file, node.at("values"), sparse.count, sparse.values);
    return sparse;
}

/// The `count` elements of one type, each number made `Out` by `convert`, into `out`.
template <class In, class Out, class Convert>
void gather(const Layout& layout, std::uint64_t count, const Convert& convert, Out* out)
{
    const std::size_t column = column_bytes(layout);
    for (std::uint64_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < layout.columns; ++c) {
            const std::size_t at = i * layout.stride + c * column;
            for (std::size_t r = 0; r < layout.rows; ++r) {
                *out++ = convert(number_at<In>(layout.bytes, at + r * sizeof(In)));
            }
        }
    }
}

/// Elements of T's type as they lie, as many as `out` has room for; false if there are gaps.
template <class T>
bool copy_whole(const Layout& layout, std::vector<T>& out)
{
    if (layout.columns != 1 || layout.stride != layout.element_bytes()) { return false; }
    assert(out.size() * sizeof(T) <= layout.bytes.size());
    std::memcpy(out.data(), layout.bytes.data(), out.size() * sizeof(T));
    return true;
}

/// glTF 2.0, 3.6.2.2: f = max(c / (2^(b-1) - 1), -1), or c / (2^b - 1).
template <class In>
void gather_floats(const Layout& layout, std::uint64_t count, float* out)
{
    if constexpr (std::is_integral_v<In>) {
        if (layout.normalized) {
            constexpr auto most = static_cast<float>(std::numeric_limits<In>::max());
            const auto scaled = [](In c) { return std::max(static_cast<float>(c) / most, -1.0F); };
            gather<In>(layout, count, scaled, out);
            return;
        }
    }
    gather<In>(
        layout, count, [](In c) { return static_cast<float>(c); }, out);
}

std::vector<float> gather_numbers(const Layout& layout, std::uint64_t count,
                                  const std::string& where)
{
    std::vector<float> result(count * layout.width());
    if (layout.bytes.empty()) { return result; }
    switch (layout.component) {
        case Component::I8:
            gather_floats<std::int8_t>(layout, count, result.data());
            break;
        case Component::U8:
            gather_floats<std::uint8_t>(layout, count, result.data());
            break;
        case Component::I16:
            gather_floats<std::int16_t>(layout, count, result.data());
            break;
        case Component::U16:
            gather_floats<std::uint16_t>(layout, count, result.data());
            break;
        case Component::U32:
            refuse(Fault::MalformedBody, where + "/componentType", "5125 is for indices alone");
        case Component::F32:
            if (!copy_whole(layout, result)) { gather_floats<float>(layout, count, result.data()); }
            break;
    }
    bool all_finite = true;  // without a way out in the middle, so that it can be vector code
    for (const float x : result) { all_finite = all_finite & std::isfinite(x); }
    if (all_finite) { return result; }
    const auto bad =
        std::find_if_not(result.begin(), result.end(), [](float x) { return std::isfinite(x); });
    refuse(Fault::NonFiniteCoordinate, where,
           "element " +
               std::to_string(static_cast<std::size_t>(bad - result.begin()) / layout.width()) +
               " is not finite");
}

std::vector<std::uint32_t> gather_integers(const Layout& layout, std::uint64_t count,
                                           const std::string& where)
{
    std::vector<std::uint32_t> result(count * layout.width());
    if (layout.bytes.empty()) { return result; }
    const auto same = [](auto value) { return static_cast<std::uint32_t>(value); };
    switch (layout.component) {
        case Component::U8:
            gather<std::uint8_t>(layout, count, same, result.data());
            break;
        case Component::U16:
            gather<std::uint16_t>(layout, count, same, result.data());
            break;
        case Component::U32:
            if (!copy_whole(layout, result)) {
                gather<std::uint32_t>(layout, count, same, result.data());
            }
            break;
        case Component::I8:
        case Component::I16:
        case Component::F32:
            refuse(Fault::MalformedBody, where + "/componentType",
                   "must be 5121, 5123 or 5125 here, an unsigned integer");
    }
    return result;
}

/// Puts the sparse elements over the others.
template <class T, class Read>
void overlay(const Accessor& accessor, const Read& read, std::vector<T>& result)
{
    if (!accessor.sparse) { return; }
    const Accessor::Sparse& sparse = *accessor.sparse;
    const std::string where = accessor.where + "/sparse";
    const auto indices = gather_integers(sparse.indices, sparse.count, where + "/indices");
    const std::vector<T> values = read(sparse.values, sparse.count, where + "/values");
    const std::size_t width = accessor.layout.width();
    for (std::size_t i = 0; i < indices.size(); ++i) {
        if (indices[i] >= accessor.count || (i > 0 && indices[i] <= indices[i - 1])) {
            refuse(Fault::IndexOutOfRange, where + "/indices",
                   "element " + std::to_string(i) + " is " + std::to_string(indices[i]) +
                       "; they must increase and stay below the accessor's " +
                       std::to_string(accessor.count));
        }
        std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i * width), width,
                    result.begin() + static_cast<std::ptrdiff_t>(indices[i] * width));
    }
}

}  // namespace

std::size_t bytes_of(Component component)
{
    switch (component) {
        case Component::I8:
        case Component::U8:
            return 1;
        case Component::I16:
        case Component::U16:
            return 2;
        case Component::U32:
        case Component::F32:
            break;
    }
    return 4;
}

std::size_t Layout::element_bytes() const
{
    return column_bytes(*this) * columns;
}

Accessor accessor(File& file, std::uint64_t index, std::string_view asked_at)
{
    const Node node = file.element("accessors", index, asked_at);
    Accessor result;
    result.where = node.where();
    result.count = node.count("count", 0);
    if (result.count == 0) {
        refuse(Fault::OutOfRange, node.where() + "/count", "must be 1 or more");
    }
    Layout& layout = result.layout;
    layout.component = component_of(node);
    layout.normalized = node.flag("normalized", false);
    const std::string type = node.text("type");
    const auto* const shape = std::find_if(std::begin(shapes), std::end(shapes),
                                           [&](const Shape& s) { return s.name == type; });
    if (shape == std::end(shapes)) {
        refuse(Fault::MalformedBody, node.where() + "/type",
               "is " + shown(type) + ", and must be SCALAR, VEC2 to VEC4 or MAT2 to MAT4");
    }
    layout.rows = shape->rows;
    layout.columns = shape->columns;
    if (node.has("bufferView")) { lay(file, node, result.count, layout); }
    if (const auto sparse = node.find("sparse")) {
        result.sparse = read_sparse(file, *sparse, result);
    }
    return result;
}

std::vector<float> floats(const Accessor& accessor)
{
    auto result = gather_numbers(accessor.layout, accessor.count, accessor.where);
    overlay(accessor, gather_numbers, result);
    return result;
}

std::vector<std::uint32_t> integers(const Accessor& accessor)
{
    auto result = gather_integers(accessor.layout, accessor.count, accessor.where);
    overlay(accessor, gather_integers, result);
    return result;
}

}  // namespace relight::gltf
