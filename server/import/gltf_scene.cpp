#include "server/import/gltf_scene.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace relight::gltf {
namespace {

/// A number of a matrix beyond this is refused: its products and squares must stay finite.
constexpr double largest_entry = 1e60;

void check_moderate(const Affine& m, const std::string& where)
{
    if (!std::all_of(m.begin(), m.end(), [](double x) { return std::abs(x) <= largest_entry; })) {
        refuse(Fault::CoordinateTooLarge, where, "is scaled or moved beyond all numbers");
    }
}

Affine local_matrix(const Node& node)
{
    const auto matrix = node.numbers("matrix", 16);
    const auto translation = node.numbers("translation", 3);
    const auto rotation = node.numbers("rotation", 4);
    const auto scale = node.numbers("scale", 3);
    if (matrix && (translation || rotation || scale)) {
        refuse(Fault::MalformedBody, node.where(),
               "has a matrix beside a translation, rotation or scale; it may have one or the "
               "others");
    }
    if (matrix) {
        return from_columns(std::span<const double, 16>(matrix->data(), 16),
                            node.where() + "/matrix");
    }
    constexpr std::array<double, 4> unturned{0, 0, 0, 1};
    constexpr std::array<double, 3> none{}, unscaled{1, 1, 1};
    const auto three = [](const auto& given, const std::array<double, 3>& otherwise) {
        return given ? std::span<const double, 3>(given->data(), 3)
                     : std::span<const double, 3>(otherwise);
    };
    return from_trs(three(translation, none),
                    rotation ? std::span<const double, 4>(rotation->data(), 4)
                             : std::span<const double, 4>(unturned),
                    three(scale, unscaled), node.where() + "/rotation");
}

/// Children of every node; each node has one parent at most.
struct Tree {
    std::vector<std::vector<std::uint32_t>> children;
    std::vector<std::optional<std::uint32_t>> parents;
};

Tree read_tree(const File& file, const std::vector<Node>& nodes)
{
    Tree tree{std::vector<std::vector<std::uint32_t>>(nodes.size()),
              std::vector<std::optional<std::uint32_t>>(nodes.size())};
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        const std::string where = nodes[i].where() + "/children";
        for (const std::uint64_t child : nodes[i].indices("children")) {
            file.element("nodes", child, where);
            if (tree.parents[child]) {
                refuse(Fault::MalformedBody, where,
                       "names node " + std::to_string(child) + ", which is a child of node " +
                           std::to_string(*tree.parents[child]) + " already");
            }
            tree.parents[child] = i;
            tree.children[i].push_back(static_cast<std::uint32_t>(child));
        }
    }
    return tree;
}

/// `roots` and all below, depth first. Without recursion: a chain may be as long as the file.
std::vector<std::uint32_t> descend(const Tree& tree, const std::vector<std::uint32_t>& roots)
{
    std::vector<std::uint32_t> order, waiting(roots.rbegin(), roots.rend());
    while (!waiting.empty()) {
        const std::uint32_t node = waiting.back();
        waiting.pop_back();
        order.push_back(node);
        const auto& children = tree.children[node];
        waiting.insert(waiting.end(), children.rbegin(), children.rend());
    }
    return order;
}

/// One parent each: what no root leads to hangs on a circle, which its parents come to in the end.
void refuse_cycles(const Tree& tree, const std::vector<std::uint32_t>& reached)
{
    if (reached.size() == tree.parents.size()) { return; }
    std::vector<bool> is_reached(tree.parents.size());
    for (const std::uint32_t i : reached) { is_reached[i] = true; }
    auto at = static_cast<std::uint32_t>(std::find(is_reached.begin(), is_reached.end(), false) -
                                         is_reached.begin());
    for (std::size_t i = 0; i < tree.parents.size(); ++i) { at = *tree.parents[at]; }
    refuse(Fault::MalformedBody, "/nodes/" + std::to_string(at), "is its own descendant");
}

/// The nodes that the scene to be shown begins with.
std::vector<std::uint32_t> scene_roots(const File& file, const Tree& tree,
                                       const std::vector<std::uint32_t>& roots)
{
    const Node root = file.root();
    const auto named = root.index("scene");
    if (!named && root.size("scenes") == 0) { return roots; }
    const Node scene = file.element("scenes", named.value_or(0), "/scene");
    std::vector<std::uint32_t> result;
    std::vector<bool> seen(tree.parents.size());
    for (const std::uint64_t node : scene.indices("nodes")) {
        const std::string where = scene.where() + "/nodes";
        file.element("nodes", node, where);
        if (tree.parents[node] || seen[node]) {
            refuse(Fault::MalformedBody, where,
                   "names node " + std::to_string(node) + " twice, or as a child of another");
        }
        seen[node] = true;
        result.push_back(static_cast<std::uint32_t>(node));
    }
    return result;
}

}  // namespace

Affine compose(const Affine& outer, const Affine& inner)
{
    Affine result{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
            double sum = column == 3 ? outer[4 * row + 3] : 0.0;
            for (std::size_t k = 0; k < 3; ++k) {
                sum += outer[4 * row + k] * inner[4 * k + column];
            }
            result[4 * row + column] = sum;
        }
    }
    return result;
}

Turned turned(const Affine& m)
{
    double largest = 0.0;
    for (const std::size_t at : {0U, 1U, 2U, 4U, 5U, 6U, 8U, 9U, 10U}) {
        largest = std::max(largest, std::abs(m[at]));
    }
    Turned result;
    result.normals = {};
    if (!(largest > 0.0)) { return result; }
    const Vec3 a{m[0] / largest, m[1] / largest, m[2] / largest};
    const Vec3 b{m[4] / largest, m[5] / largest, m[6] / largest};
    const Vec3 c{m[8] / largest, m[9] / largest, m[10] / largest};
    const Vec3 rows[] = {cross(b, c), cross(c, a), cross(a, b)};
    result.mirrored = dot(a, rows[0]) < 0.0;
    const double sign = result.mirrored ? -1.0 : 1.0;
    for (std::size_t row = 0; row < 3; ++row) {
        result.normals[4 * row] = sign * rows[row].x;
        result.normals[4 * row + 1] = sign * rows[row].y;
        result.normals[4 * row + 2] = sign * rows[row].z;
    }
    return result;
}

Affine from_trs(std::span<const double, 3> translation, std::span<const double, 4> rotation,
                std::span<const double, 3> scale, const std::string& where)
{
    const double length =
        std::hypot(std::hypot(rotation[0], rotation[1]), std::hypot(rotation[2], rotation[3]));
    if (!(length > 0.0) || !std::isfinite(length)) {
        refuse(Fault::OutOfRange, where, "must be a quaternion of length 1, and has no direction");
    }
    const double x = rotation[0] / length, y = rotation[1] / length;
    const double z = rotation[2] / length, w = rotation[3] / length;
    // R = 1 + 2 w [q]x + 2 [q]x^2, q = (x, y, z); each column times its scale.
    return {(1 - 2 * (y * y + z * z)) * scale[0], 2 * (x * y - w * z) * scale[1],
            2 * (x * z + w * y) * scale[2],       translation[0],
            2 * (x * y + w * z) * scale[0],       (1 - 2 * (x * x + z * z)) * scale[1],
            2 * (y * z - w * x) * scale[2],       translation[1],
            2 * (x * z - w * y) * scale[0],       2 * (y * z + w * x) * scale[1],
            (1 - 2 * (x * x + y * y)) * scale[2], translation[2]};
}

Affine from_columns(std::span<const double, 16> columns, const std::string& where)
{
    constexpr double tolerance = 1e-6;
    const auto is = [&](std::size_t at, double value) {
        return std::abs(columns[at] - value) <= tolerance;
    };
    if (!is(3, 0.0) || !is(7, 0.0) || !is(11, 0.0) || !is(15, 1.0)) {
        refuse(Fault::MalformedBody, where, "must be affine: its fourth row 0 0 0 1");
    }
    Affine result{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
            result[4 * row + column] = columns[4 * column + row];
        }
    }
    return result;
}

SceneGraph read_scene(const File& file)
{
    const std::vector<Node> nodes = file.root().items("nodes");
    const Tree tree = read_tree(file, nodes);
    std::vector<std::uint32_t> roots;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        if (!tree.parents[i]) { roots.push_back(i); }
    }
    const std::vector<std::uint32_t> all = descend(tree, roots);
    refuse_cycles(tree, all);
    SceneGraph graph;
    graph.to_world.resize(nodes.size());
    for (const std::uint32_t i : all) {
        const Affine local = local_matrix(nodes[i]);
        check_moderate(local, nodes[i].where());
        const auto parent = tree.parents[i];
        graph.to_world[i] = parent ? compose(graph.to_world[*parent], local) : local;
        check_moderate(graph.to_world[i], nodes[i].where());
    }
    graph.shown = descend(tree, scene_roots(file, tree, roots));
    return graph;
}

}  // namespace relight::gltf
