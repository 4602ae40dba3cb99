#include "server/import/gltf_place.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace relight::gltf {
namespace {

Vec3 vec_at(const std::vector<float>& numbers, std::size_t at)
{
    return {double{numbers[at]}, double{numbers[at + 1]}, double{numbers[at + 2]}};
}

/// Base plus weighted displacements, both of them if they are there.
Vec3 morphed(Vec3 base, const Primitive& primitive, std::vector<float> Primitive::Target::*member,
             const std::vector<double>& weights, std::size_t vertex)
{
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const std::vector<float>& moves = primitive.targets[i].*member;
        if (!moves.empty()) { base += weights[i] * vec_at(moves, 3 * vertex); }
    }
    return base;
}

/// sum w_j M_j of the vertex: M_j takes the mesh where its joint is.   glTF 2.0, 3.7.3.3
/// Weights that do not sum to 1 are scaled; without any the first joint takes all.
Affine blend(const Primitive& primitive, const Place& place, std::size_t vertex)
{
    const std::size_t from = vertex * primitive.influences;
    double sum = 0.0;
    Affine result{};
    for (std::size_t k = from; k < from + primitive.influences; ++k) {
        const double weight = primitive.weights[k];
        if (weight == 0.0) { continue; }
        const std::uint32_t joint = primitive.joints[k];
        if (joint >= place.joints.size()) {
            refuse(Fault::IndexOutOfRange, place.where,
                   "vertex " + std::to_string(vertex) + " names joint " + std::to_string(joint) +
                       " of a skin that has " + std::to_string(place.joints.size()));
        }
        for (std::size_t i = 0; i < result.size(); ++i) {
            result[i] += weight * place.joints[joint][i];
        }
        sum += weight;
    }
    if (sum == 0.0) { return place.joints.front(); }
    for (double& entry : result) { entry /= sum; }
    return result;
}

std::array<float, 3> to_floats(Vec3 v)
{
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

Point3 checked(Point3 p, const Place& place, std::size_t vertex)
{
    const double most = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    // A sum of numbers that are too large may be none at all.
    if (!(most <= largest_coordinate) || !std::isfinite(p.x + p.y + p.z)) {
        refuse(Fault::CoordinateTooLarge, place.where,
               "vertex " + std::to_string(vertex) +
                   " of a primitive comes to lie beyond 1e15 of the origin");
    }
    return p;
}

/// Moves the vertices; true if most of them are mirrored.
bool put_vertices(const Primitive& primitive, const Place& place, Mesh& mesh)
{
    const std::size_t count = primitive.positions.size() / 3;
    const bool skinned = !place.joints.empty() && primitive.influences > 0;
    Affine matrix = place.to_world;
    Turned turn_by = turned(matrix);
    std::size_t mirrored = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (skinned) {
            matrix = blend(primitive, place, i);
            turn_by = turned(matrix);
        }
        mirrored += turn_by.mirrored ? 1 : 0;
        const std::size_t to = place.first_vertex + i;
        const Vec3 p = morphed(vec_at(primitive.positions, 3 * i), primitive,
                               &Primitive::Target::positions, place.weights, i);
        mesh.positions[to] = checked(move(matrix, {p.x, p.y, p.z}), place, i);
        if (!primitive.normals.empty()) {
            const Vec3 n = morphed(vec_at(primitive.normals, 3 * i), primitive,
                                   &Primitive::Target::normals, place.weights, i);
            mesh.normals[to] = normalize(turn(turn_by.normals, n));
        }
        if (!primitive.tangents.empty()) {
            const Vec3 t = morphed(vec_at(primitive.tangents, 4 * i), primitive,
                                   &Primitive::Target::tangents, place.weights, i);
            const auto along = to_floats(normalize(turn(matrix, t)));
            // cross(n, t) turns round in a mirror, the bitangent does not.
            const bool left = (primitive.tangents[4 * i + 3] < 0.0F) != turn_by.mirrored;
            mesh.tangents[to] = {along[0], along[1], along[2], left ? -1.0F : 1.0F};
        }
    }
    return 2 * mirrored > count;
}

void put_uvs(const std::vector<float>& from, std::uint64_t first, std::vector<Uv>& to)
{
    for (std::size_t i = 0; 2 * i < from.size(); ++i) {
        to[first + i] = {from[2 * i], from[2 * i + 1]};
    }
}

}  // namespace

void put(const Primitive& primitive, const Place& place, Mesh& mesh)
{
    const bool mirrored = put_vertices(primitive, place, mesh);
    for (std::size_t i = 0; 3 * i < primitive.colors.size(); ++i) {
        mesh.colors[place.first_vertex + i] = {primitive.colors[3 * i], primitive.colors[3 * i + 1],
                                               primitive.colors[3 * i + 2]};
    }
    put_uvs(primitive.uvs, place.first_vertex, mesh.uvs);
    put_uvs(primitive.uvs_1, place.first_vertex, mesh.uvs_1);
    for (std::size_t f = 0; 3 * f < primitive.indices.size(); ++f) {
        const auto corner = [&](std::size_t k) {
            return static_cast<std::uint32_t>(place.first_vertex) + primitive.indices[3 * f + k];
        };
        std::uint32_t* const to = mesh.faces.indices.data() + 3 * (place.first_face + f);
        to[0] = corner(0);
        to[1] = corner(mirrored ? 2 : 1);
        to[2] = corner(mirrored ? 1 : 2);
    }
}

}  // namespace relight::gltf
