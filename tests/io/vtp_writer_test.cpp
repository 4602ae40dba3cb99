#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>

#include <cmath>

#include "tests/io/full_mesh.h"
#include "tests/written.h"

namespace relight {
namespace {

using test::full_mesh;

struct ReadVtp {
    explicit ReadVtp(const std::string& text)
    {
        reader->ReadFromInputStringOn();
        reader->SetInputString(text);
        reader->Update();
        data = reader->GetOutput();
        points = data->GetPointData();
    }
    vtkNew<vtkXMLPolyDataReader> reader;
    vtkPolyData* data;
    vtkPointData* points;
};

template <class T>
std::vector<double> flat(const T& values)
{
    std::vector<double> out;
    for (const auto& value : values) {
        for (const auto number : value) { out.push_back(static_cast<double>(number)); }
    }
    return out;
}

std::vector<double> numbers(vtkDataArray* array)
{
    std::vector<double> out;
    if (array == nullptr) { return out; }
    for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i) {
        for (int c = 0; c < array->GetNumberOfComponents(); ++c) {
            out.push_back(array->GetComponent(i, c));
        }
    }
    return out;
}

std::vector<double> wide(std::span<const float> values)
{
    return {values.begin(), values.end()};
}

Faces faces_of(vtkCellArray* cells)
{
    Faces faces;
    faces.offsets.push_back(0);
    vtkNew<vtkIdList> corners;
    for (cells->InitTraversal(); cells->GetNextCell(corners) != 0;) {
        for (vtkIdType k = 0; k < corners->GetNumberOfIds(); ++k) {
            faces.indices.push_back(static_cast<std::uint32_t>(corners->GetId(k)));
        }
        faces.offsets.push_back(static_cast<std::uint32_t>(faces.indices.size()));
    }
    return faces;
}

std::vector<float> some_values(std::size_t count)
{
    std::mt19937 random(5);
    std::uniform_real_distribution<float> any(0.0F, 1e6F);
    std::vector<float> values(count);
    for (float& v : values) { v = any(random); }
    return values;
}

TEST(WriteVtp, VtkReadsEveryArrayBack)
{
    const Mesh mesh = full_mesh(300);
    std::vector<Rgb8> color;
    for (std::size_t i = 0; i < 300; ++i) {
        color.push_back({static_cast<unsigned char>(i), 7, 9});
    }
    const std::vector<float> E = some_values(900), visible = some_values(300);
    const ReadVtp vtp(write_vtp(
        {mesh, {}, color, {{"irradiance", 3, E}, {"visibility_key", 1, visible}}, {"E in W/m^2"}}));
    EXPECT_EQ(vtp.data->GetPoints()->GetDataType(), VTK_FLOAT);
    EXPECT_EQ(numbers(vtp.data->GetPoints()->GetData()), flat(test::floats(mesh.positions)));
    const Faces faces = faces_of(vtp.data->GetPolys());
    EXPECT_EQ(faces.indices, mesh.faces.indices);
    EXPECT_EQ(faces.offsets, mesh.faces.offsets);
    EXPECT_EQ(vtp.data->GetNumberOfVerts(), 0);
    EXPECT_EQ(numbers(vtp.points->GetNormals()), flat(test::floats(mesh.normals)));
    EXPECT_STREQ(vtp.points->GetNormals()->GetName(), "Normals");
    EXPECT_EQ(numbers(vtp.points->GetTCoords()), flat(mesh.uvs));
    EXPECT_EQ(numbers(vtp.points->GetScalars()), flat(color));
    EXPECT_STREQ(vtp.points->GetScalars()->GetName(), "color");
    EXPECT_EQ(vtp.points->GetScalars()->GetDataType(), VTK_UNSIGNED_CHAR);
    EXPECT_EQ(numbers(vtp.points->GetArray("irradiance")), wide(E));
    EXPECT_EQ(numbers(vtp.points->GetArray("visibility_key")), wide(visible));
    EXPECT_EQ(vtp.points->GetNumberOfArrays(), 5);
    auto* const comments =
        vtkStringArray::SafeDownCast(vtp.data->GetFieldData()->GetAbstractArray("comments"));
    ASSERT_NE(comments, nullptr);
    EXPECT_EQ(comments->GetValue(0), "E in W/m^2");
}

TEST(WriteVtp, FiledColoursAreCodesWhereTheyCanBe)
{
    Mesh mesh = full_mesh(30);
    const ReadVtp codes(write_vtp({mesh, {}, {}, {}, {}}));
    EXPECT_EQ(codes.points->GetArray("color")->GetComponent(29, 0), 29.0);
    EXPECT_EQ(codes.points->GetArray("color")->GetComponent(29, 2), 226.0);
    mesh.colors[4] = {0.123F, 4.0F, 0.0F};
    const ReadVtp linear(write_vtp({mesh, {}, {}, {}, {}}));
    EXPECT_EQ(numbers(linear.points->GetArray("color_linear")), flat(mesh.colors));
}

TEST(WriteVtp, TrianglesAndDoublesAreKept)
{
    Mesh mesh = full_mesh(30);
    test::drop_polygons(mesh);
    mesh.double_positions = true;
    mesh.positions[7].x = 1234567.890123;
    const ReadVtp vtp(write_vtp({mesh, {}, {}, {}, {}}));
    EXPECT_EQ(vtp.data->GetPoints()->GetDataType(), VTK_DOUBLE);
    EXPECT_EQ(vtp.data->GetPoint(7)[0], 1234567.890123);
    EXPECT_EQ(faces_of(vtp.data->GetPolys()).indices, mesh.faces.indices);
    EXPECT_EQ(vtp.data->GetNumberOfPolys(), 28);
}

TEST(WriteVtp, APointOfACloudIsAVertexUnlessAbsent)
{
    Mesh cloud = full_mesh(30);
    cloud.faces = {};
    cloud.absent = {0, 4, 29};
    const ReadVtp vtp(write_vtp({cloud, {}, {}, {}, {}}));
    ASSERT_EQ(vtp.data->GetNumberOfPoints(), 30);
    EXPECT_EQ(vtp.data->GetNumberOfVerts(), 27);
    EXPECT_EQ(vtp.data->GetNumberOfPolys(), 0);
    const Faces verts = faces_of(vtp.data->GetVerts());
    EXPECT_EQ(verts.indices.front(), 1U);
    EXPECT_EQ(verts.indices.back(), 28U);
    EXPECT_TRUE(std::isnan(vtp.data->GetPoint(4)[1]));
    EXPECT_EQ(static_cast<float>(vtp.data->GetPoint(5)[1]),
              static_cast<float>(cloud.positions[5].y));
}

TEST(WriteVtp, NoNameOrCommentBreaksTheFileOrHidesAnother)
{
    const Mesh mesh = full_mesh(10);
    const std::vector<float> a(10, 1.0F), b(10, 2.0F), c(10, 3.0F), d(10, 4.0F);
    const ReadVtp vtp(write_vtp(
        {mesh,
         {},
         {},
         {{"per<light>&\"'\n", 1, a}, {"per_light____ ", 1, b}, {"Normals", 1, c}, {"lämp", 1, d}},
         {"</VTKFile>\n<&>"}}));
    ASSERT_EQ(vtp.data->GetNumberOfPoints(), 10);
    EXPECT_EQ(numbers(vtp.points->GetArray("per_light____ ")), wide(a));
    EXPECT_EQ(numbers(vtp.points->GetArray("per_light____ _")), wide(b));
    EXPECT_EQ(numbers(vtp.points->GetArray("Normals_")), wide(c));
    EXPECT_EQ(numbers(vtp.points->GetArray("lämp")), wide(d));
    EXPECT_EQ(numbers(vtp.points->GetNormals()), flat(test::floats(mesh.normals)));
    auto* const comments =
        vtkStringArray::SafeDownCast(vtp.data->GetFieldData()->GetAbstractArray("comments"));
    EXPECT_EQ(comments->GetValue(0), "</VTKFile> <&>");
}

TEST(WriteVtp, TextureCoordinatesOfGltfAreTurnedUp)
{
    Mesh mesh = full_mesh(10);
    mesh.format = "glb";
    const ReadVtp vtp(write_vtp({mesh, {}, {}, {}, {}}));
    EXPECT_EQ(static_cast<float>(vtp.points->GetTCoords()->GetComponent(3, 0)), mesh.uvs[3][0]);
    EXPECT_EQ(static_cast<float>(vtp.points->GetTCoords()->GetComponent(3, 1)),
              1.0F - mesh.uvs[3][1]);
}

TEST(WriteVtp, TheSameMeshGivesTheSameBytes)
{
    const Mesh mesh = full_mesh(300);
    const std::vector<float> E = some_values(900);
    const LitMesh lit{mesh, {}, {}, {{"irradiance", 3, E}}, {"one"}};
    EXPECT_EQ(write_vtp(lit), write_vtp(lit));
}

}  // namespace
}  // namespace relight
