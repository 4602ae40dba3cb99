#include "tests/bench/terrain.h"

#include <charconv>
#include <cmath>
#include <map>

#include "core/io/writers.h"
#include "tests/scenes.h"
#include "tests/written.h"

namespace relight::bench {
namespace {

/// Hills, and ever smaller hills on them, each layer turned against the one before.
double height(double x, double y)
{
    constexpr double turn = 2.4;  // the golden angle [rad]: no two layers run alike
    double h = 0.0;
    double size = 0.12;
    double frequency = 4.0;
    for (int layer = 0; layer < 8; ++layer) {
        const double c = std::cos(turn * layer), s = std::sin(turn * layer);
        h += size * std::sin(frequency * (c * x - s * y) + layer) *
             std::cos(frequency * (s * x + c * y));
        size *= 0.5;
        frequency *= 1.9;
    }
    return h;
}

/// A float's value: what a file of floats brings.
double rounded(double v)
{
    return static_cast<double>(static_cast<float>(v));
}

template <class Value, class Make>
const Value& kept(std::map<std::size_t, Value>& values, std::size_t vertices, const Make& make)
{
    if (!values.contains(vertices)) { values.emplace(vertices, make()); }
    return values.at(vertices);
}

/// Appends ` value` with the fewest digits that read back exactly.
template <class Number>
void append(std::string& text, Number value)
{
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    text.append(1, ' ').append(digits.data(), end);
}

std::string obj_of(const Stage& stage)
{
    std::string text;
    for (const Point3 p : stage.mesh->positions) {
        text += 'v';
        for (const double c : {p.x, p.y, p.z}) { append(text, static_cast<float>(c)); }
        text += '\n';
    }
    for (const Vec3 n : stage.surface->normals) {
        text += "vn";
        for (const double c : {n.x, n.y, n.z}) { append(text, static_cast<float>(c)); }
        text += '\n';
    }
    for (const Triangle& t : stage.surface->triangles) {
        text += 'f';
        for (const std::uint32_t v : t) {
            append(text, v + 1);
            text += "//" + std::to_string(v + 1);
        }
        text += '\n';
    }
    return text;
}

/// 80 bytes of nothing, the number of facets, then 50 bytes each.
std::string stl_of(const Mesh& mesh)
{
    std::string file(80, ' ');
    const auto put = [&](const auto& value) {
        file.append(reinterpret_cast<const char*>(&value), sizeof(value));
    };
    file.reserve(84 + 50 * mesh.faces.count());
    put(static_cast<std::uint32_t>(mesh.faces.count()));
    for (std::size_t corner = 0; corner < mesh.faces.indices.size(); ++corner) {
        if (corner % 3 == 0) { put(std::array<float, 3>{}); }  // a normal: none
        const Point3 p = mesh.positions[mesh.faces.indices[corner]];
        for (const double c : {p.x, p.y, p.z}) { put(static_cast<float>(c)); }
        if (corner % 3 == 2) { put(std::uint16_t{0}); }
    }
    return file;
}

}  // namespace

Mesh terrain(std::size_t vertices)
{
    const auto side =
        static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(vertices))));
    Mesh mesh;
    mesh.format = "ply";
    mesh.positions.reserve(std::size_t{side} * side);
    mesh.faces.indices.reserve(std::size_t{6} * side * side);
    for (std::uint32_t i = 0; i < side; ++i) {
        for (std::uint32_t j = 0; j < side; ++j) {
            const double x = 2.0 * j / (side - 1) - 1.0;
            const double y = 2.0 * i / (side - 1) - 1.0;
            mesh.positions.push_back({rounded(x), rounded(y), rounded(height(x, y))});
            if (i + 1 == side || j + 1 == side) { continue; }
            const std::uint32_t v = i * side + j;
            for (const std::uint32_t corner : {v, v + 1, v + side + 1, v, v + side + 1, v + side}) {
                mesh.faces.indices.push_back(corner);
            }
        }
    }
    return mesh;
}

const Stage& terrain_stage(std::size_t vertices)
{
    static std::map<std::size_t, Stage> stages;
    return kept(stages, vertices, [&] { return test::staged(terrain(vertices)); });
}

const Stage& cloud_stage(std::size_t points)
{
    static std::map<std::size_t, Stage> stages;
    return kept(stages, points, [&] {
        const Stage& stage = terrain_stage(points);
        Mesh cloud;
        cloud.format = "ply";
        cloud.positions = stage.mesh->positions;
        cloud.normals.assign(stage.surface->normals.begin(), stage.surface->normals.end());
        return test::staged(std::move(cloud));
    });
}

const Stage& outdoor_stage(std::size_t vertices)
{
    static std::map<std::size_t, Stage> stages;
    return kept(stages, vertices, [&] {
        const Mesh lamp = test::icosphere(3);
        Mesh all = terrain(vertices);
        const auto first = static_cast<std::uint32_t>(all.positions.size());
        for (Point3& p : all.positions) { p = {p.x, p.z, -p.y}; }
        for (const Point3 p : lamp.positions) {
            all.positions.push_back(Point3{0.3, 0.6, 0.2} + (p - Point3{}) * 0.2);
        }
        std::vector<std::uint32_t> corners = lamp.faces.indices;
        for (std::uint32_t& corner : corners) { corner += first; }
        auto& indices = all.faces.indices;
        indices.insert(indices.begin(), corners.begin(), corners.end());
        return test::staged(std::move(all));
    });
}

const std::string& terrain_ply(std::size_t vertices)
{
    static std::map<std::size_t, std::string> files;
    return kept(files, vertices, [&] {
        const Stage& stage = terrain_stage(vertices);
        return write_ply({*stage.mesh, stage.surface->normals, {}, {}, {}},
                         PlyEncoding::BinaryLittleEndian);
    });
}

const std::string& terrain_glb(std::size_t vertices)
{
    static std::map<std::size_t, std::string> files;
    return kept(files, vertices, [&] {
        const Stage& stage = terrain_stage(vertices);
        return write_glb({*stage.mesh, stage.surface->normals, {}, {}, {}});
    });
}

const std::string& terrain_obj(std::size_t vertices)
{
    static std::map<std::size_t, std::string> files;
    return kept(files, vertices, [&] { return obj_of(terrain_stage(vertices)); });
}

const std::string& terrain_stl(std::size_t vertices)
{
    static std::map<std::size_t, std::string> files;
    return kept(files, vertices, [&] { return stl_of(*terrain_stage(vertices).mesh); });
}

}  // namespace relight::bench
