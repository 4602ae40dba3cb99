// The same numbers through readers that are not ours: assimp and VTK.
#include <assimp/scene.h>
#include <gtest/gtest.h>
#include <vtkCompositeDataIterator.h>
#include <vtkDataArray.h>
#include <vtkGLTFReader.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>

#include "core/display/display.h"
#include "core/io/writers.h"
#include "tests/io/reader_checks.h"
#include "tests/shapes.h"
#include "tests/written.h"

namespace relight {
namespace {

/// A lit icosphere far from the origin.
struct Lit {
    Mesh mesh = test::icosphere(2);
    std::vector<Rgb8> color;
    std::vector<float> irradiance;

    Lit()
    {
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            mesh.positions[i] = mesh.positions[i] + Vec3{2000, -50, 3};
            const auto code = static_cast<unsigned char>(i);
            color.push_back({code, 200, static_cast<unsigned char>(255 - code)});
            for (const float band : {0.1F, 0.2F, 0.3F}) {
                irradiance.push_back(band * static_cast<float>(i));
            }
        }
    }
    std::string glb() const
    {
        return write_glb({mesh, {}, color, {{"irradiance", 3, irradiance}}, {}});
    }
    void expect_vertex(std::size_t i, const std::array<double, 3>& linear, Point3 p) const
    {
        const Rgb expected = srgb_eotf(color[i]);
        EXPECT_NEAR(linear[0], expected.r, 1e-6);
        EXPECT_NEAR(linear[1], expected.g, 1e-6);
        EXPECT_NEAR(linear[2], expected.b, 1e-6);
        EXPECT_LT(length(p - mesh.positions[i]), 3e-4);  // theirs are floats from the origin
    }
};

TEST(GlbWriter, AssimpReadsTheSameColoursPlacesAndTriangles)
{
    const Lit lit;
    const std::string glb = lit.glb();
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFileFromMemory(glb.data(), glb.size(), 0, "glb");
    ASSERT_NE(scene, nullptr) << importer.GetErrorString();
    ASSERT_EQ(scene->mNumMeshes, 1U);
    const aiMesh& mesh = *scene->mMeshes[0];
    ASSERT_EQ(mesh.mNumVertices, lit.mesh.positions.size());
    ASSERT_TRUE(mesh.HasVertexColors(0));
    aiMatrix4x4 to_world = scene->mRootNode->mTransformation;
    if (scene->mRootNode->mNumChildren > 0) {
        to_world = to_world * scene->mRootNode->mChildren[0]->mTransformation;
    }
    for (std::size_t i = 0; i < mesh.mNumVertices; ++i) {
        const aiColor4D c = mesh.mColors[0][i];
        const aiVector3D p = to_world * mesh.mVertices[i];
        lit.expect_vertex(i, {c.r, c.g, c.b}, {p.x, p.y, p.z});
    }
    ASSERT_EQ(mesh.mNumFaces, lit.mesh.faces.count());
    for (std::size_t f = 0; f < mesh.mNumFaces; ++f) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(mesh.mFaces[f].mIndices[k], lit.mesh.faces.indices[3 * f + k]);
        }
    }
}

TEST(GlbWriter, VtkReadsTheSameColoursPlacesAndQuantities)
{
    const Lit lit;
    const auto path = std::filesystem::temp_directory_path() /
                      ("relight_glb_" + std::to_string(std::random_device{}()) + ".glb");
    std::ofstream(path, std::ios::binary) << lit.glb();
    vtkNew<vtkGLTFReader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    std::filesystem::remove(path);
    auto* blocks = vtkMultiBlockDataSet::SafeDownCast(reader->GetOutputDataObject(0));
    ASSERT_NE(blocks, nullptr);
    const auto at = vtkSmartPointer<vtkCompositeDataIterator>::Take(blocks->NewIterator());
    at->InitTraversal();
    ASSERT_FALSE(at->IsDoneWithTraversal());
    auto* mesh = vtkPolyData::SafeDownCast(at->GetCurrentDataObject());
    ASSERT_NE(mesh, nullptr);
    ASSERT_EQ(mesh->GetNumberOfPoints(), static_cast<vtkIdType>(lit.mesh.positions.size()));
    EXPECT_EQ(mesh->GetNumberOfPolys(), static_cast<vtkIdType>(lit.mesh.faces.count()));
    vtkDataArray* color = mesh->GetPointData()->GetArray("COLOR_0");
    ASSERT_NE(color, nullptr);
    for (std::size_t i = 0; i < lit.mesh.positions.size(); ++i) {
        const auto id = static_cast<vtkIdType>(i);
        const double* c = color->GetTuple(id);
        const double* p = mesh->GetPoint(id);
        lit.expect_vertex(i, {c[0], c[1], c[2]}, {p[0], p[1], p[2]});
    }
}

}  // namespace
}  // namespace relight
