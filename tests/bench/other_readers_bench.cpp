// What users read meshes with today, over the same bytes: OpenMesh, VTK, and where they are
// installed assimp and tinyobjloader. VTK reads files alone: it finds them in the page cache.
#include <vtkOBJReader.h>
#include <vtkPLYReader.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkSmartPointer.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "core/io/readers.h"
#include "tests/bench/sizes.h"
#include "tests/bench/terrain.h"
#ifdef RELIGHT_BENCH_assimp
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif
#ifdef RELIGHT_BENCH_tinyobjloader
#include <tiny_obj_loader.h>
#endif

namespace relight::bench {
namespace {

/// Times `reader(file)`, which says how many vertices it found; fewer than the file's is a failure.
void time(benchmark::State& state, const std::string& file,
          const std::function<std::size_t(const std::string&)>& reader)
{
    while (state.KeepRunning()) {
        if (reader(file) < vertices(state) / 2) {
            state.SkipWithError("it read too little to be compared with");
            break;
        }
    }
    rate(state, "bytes", file.size());
}

/// A file in memory, for readers that take a path.
class MemoryFile {
  public:
    MemoryFile(const std::string& bytes, const char* ending)
        : path_(std::filesystem::temp_directory_path() /
                ("relight_bench_" + std::to_string(bytes.size()) + ending))
    {
        std::ofstream(path_, std::ios::binary) << bytes;
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    ~MemoryFile() { std::filesystem::remove(path_); }
    std::string path() const { return path_.string(); }

  private:
    std::filesystem::path path_;
};

std::size_t by_openmesh(const std::string& file, const char* ending)
{
    OpenMesh::TriMesh_ArrayKernelT<> mesh;
    std::istringstream stream(file);
    OpenMesh::IO::Options options = OpenMesh::IO::Options::VertexNormal;
    if (std::string_view(ending) == ".ply") { options += OpenMesh::IO::Options::Binary; }
    mesh.request_vertex_normals();
    if (!OpenMesh::IO::read_mesh(mesh, stream, ending, options)) { return 0; }
    return mesh.n_vertices();
}

template <class VtkReader>
std::size_t by_vtk(const std::string& path)
{
    const auto reader = vtkSmartPointer<VtkReader>::New();
    reader->SetFileName(path.c_str());
    reader->Update();
    return static_cast<std::size_t>(reader->GetOutput()->GetNumberOfPoints());
}

void openmesh_ply(benchmark::State& state)
{
    time(state, terrain_ply(vertices(state)),
         [](const std::string& file) { return by_openmesh(file, ".ply"); });
}
BENCHMARK(openmesh_ply)->Name("read PLY beside OpenMesh")->Apply(sizes);

void openmesh_obj(benchmark::State& state)
{
    time(state, terrain_obj(vertices(state)),
         [](const std::string& file) { return by_openmesh(file, ".obj"); });
}
BENCHMARK(openmesh_obj)->Name("read OBJ beside OpenMesh")->Apply(sizes);

void vtk_ply(benchmark::State& state)
{
    const MemoryFile on_disk(terrain_ply(vertices(state)), ".ply");
    time(state, terrain_ply(vertices(state)),
         [&](const std::string&) { return by_vtk<vtkPLYReader>(on_disk.path()); });
}
BENCHMARK(vtk_ply)->Name("read PLY beside VTK")->Apply(sizes);

void vtk_obj(benchmark::State& state)
{
    const MemoryFile on_disk(terrain_obj(vertices(state)), ".obj");
    time(state, terrain_obj(vertices(state)),
         [&](const std::string&) { return by_vtk<vtkOBJReader>(on_disk.path()); });
}
BENCHMARK(vtk_obj)->Name("read OBJ beside VTK")->Apply(sizes);

void read_stl_file(benchmark::State& state)
{
    time(state, terrain_stl(vertices(state)), [](const std::string& file) {
        Progress progress;
        const auto mesh = read_stl(std::as_bytes(std::span(file)), ReadLimits{}, progress);
        return mesh ? mesh->positions.size() : 0;
    });
}
BENCHMARK(read_stl_file)->Name("read STL")->Apply(sizes);

void copy_stl_file_afresh(benchmark::State& state)
{
    copy_afresh(state, terrain_stl(vertices(state)));
}
BENCHMARK(copy_stl_file_afresh)->Name("read STL beside memcpy to fresh memory")->Apply(sizes);

void vtk_stl(benchmark::State& state)
{
    const MemoryFile on_disk(terrain_stl(vertices(state)), ".stl");
    time(state, terrain_stl(vertices(state)),
         [&](const std::string&) { return by_vtk<vtkSTLReader>(on_disk.path()); });
}
BENCHMARK(vtk_stl)->Name("read STL beside VTK")->Apply(sizes);

#ifdef RELIGHT_BENCH_assimp
std::size_t by_assimp(const std::string& file, const char* hint)
{
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFileFromMemory(file.data(), file.size(), 0, hint);
    return scene == nullptr || scene->mNumMeshes == 0 ? 0 : scene->mMeshes[0]->mNumVertices;
}

void assimp_ply(benchmark::State& state)
{
    time(state, terrain_ply(vertices(state)),
         [](const std::string& file) { return by_assimp(file, "ply"); });
}
BENCHMARK(assimp_ply)->Name("read PLY beside assimp")->Apply(sizes);

void assimp_obj(benchmark::State& state)
{
    time(state, terrain_obj(vertices(state)),
         [](const std::string& file) { return by_assimp(file, "obj"); });
}
BENCHMARK(assimp_obj)->Name("read OBJ beside assimp")->Apply(sizes);
#endif

#ifdef RELIGHT_BENCH_tinyobjloader
void tinyobj(benchmark::State& state)
{
    time(state, terrain_obj(vertices(state)), [](const std::string& file) {
        tinyobj::attrib_t attributes;
        std::vector<tinyobj::shape_t> shapes;
        std::vector<tinyobj::material_t> materials;
        std::string warnings, errors;
        std::istringstream stream(file);
        tinyobj::LoadObj(&attributes, &shapes, &materials, &warnings, &errors, &stream);
        return attributes.vertices.size() / 3;
    });
}
BENCHMARK(tinyobj)->Name("read OBJ beside tinyobjloader")->Apply(sizes);
#endif

}  // namespace
}  // namespace relight::bench
