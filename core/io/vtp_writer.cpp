#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <set>
#include <stdexcept>

#include "core/io/filed.h"
#include "core/io/srgb_codes.h"
#include "core/io/text_out.h"
#include "core/io/writers.h"

namespace relight {
namespace {

/// value(i), an array of numbers for each vertex, as an array of VTK's.
template <class Array, class Value>
vtkNew<Array> array_of(const char* name, std::size_t count, Value value)
{
    vtkNew<Array> array;
    array->SetName(name);
    array->SetNumberOfComponents(static_cast<int>(value(0).size()));
    array->SetNumberOfTuples(static_cast<vtkIdType>(count));
    auto* at = array->GetPointer(0);
    for (std::size_t i = 0; i < count; ++i) {
        for (const auto number : value(i)) { *at++ = number; }
    }
    return array;
}

Rgbf as_floats(Vec3 v)
{
    return to_float(Rgb{v.x, v.y, v.z});
}

void set_points(vtkPolyData& data, const Mesh& mesh)
{
    vtkNew<vtkPoints> points;
    const std::size_t count = mesh.positions.size();
    if (mesh.double_positions) {
        points->SetData(array_of<vtkDoubleArray>("Points", count, [&](std::size_t i) {
            const Point3 p = filed_position(mesh, i);
            return std::array{p.x, p.y, p.z};
        }));
    } else {
        points->SetData(array_of<vtkFloatArray>("Points", count, [&](std::size_t i) {
            return as_floats(filed_position(mesh, i) - Point3{});
        }));
    }
    data.SetPoints(points);
}

/// The faces, or the points of a cloud that are there.
template <class Int>
vtkNew<vtkCellArray> cells_of(const Mesh& mesh)
{
    vtkNew<Int> corners, offsets;
    offsets->InsertNextValue(0);
    const auto append = [](Int* array, std::size_t number) {
        array->InsertNextValue(static_cast<typename Int::ValueType>(number));
    };
    for (const std::uint32_t corner : mesh.faces.indices) { append(corners, corner); }
    for (std::size_t f = 0; f < mesh.faces.count(); ++f) { append(offsets, mesh.faces.end(f)); }
    for (std::size_t i = 0; mesh.faces.count() == 0 && i < mesh.positions.size(); ++i) {
        if (std::binary_search(mesh.absent.begin(), mesh.absent.end(), i)) { continue; }
        append(corners, i);
        append(offsets, static_cast<std::size_t>(corners->GetNumberOfValues()));
    }
    vtkNew<vtkCellArray> cells;
    cells->SetData(offsets, corners);
    return cells;
}

void set_cells(vtkPolyData& data, const Mesh& mesh)
{
    const std::size_t largest = std::max(mesh.faces.indices.size(), mesh.positions.size());
    const bool small = largest <= std::numeric_limits<std::int32_t>::max();
    const vtkNew<vtkCellArray> cells =
        small ? cells_of<vtkTypeInt32Array>(mesh) : cells_of<vtkTypeInt64Array>(mesh);
    if (mesh.faces.count() > 0) {
        data.SetPolys(cells);
    } else {
        data.SetVerts(cells);
    }
}

/// Arrays that VTK's filters know by what they are, not by their names alone.
void set_attributes(vtkPointData& data, const LitMesh& lit)
{
    const Mesh& mesh = lit.mesh;
    const std::size_t count = mesh.positions.size();
    if (!lit.normals.empty()) {
        data.SetNormals(array_of<vtkFloatArray>(
            "Normals", count, [&](std::size_t i) { return as_floats(lit.normals[i]); }));
    } else if (!mesh.normals.empty()) {
        data.SetNormals(array_of<vtkFloatArray>(
            "Normals", count, [&](std::size_t i) { return as_floats(mesh.normals[i]); }));
    }
    if (!mesh.uvs.empty()) {
        data.SetTCoords(array_of<vtkFloatArray>(
            "TCoords", count,
            [&, filed_uv = FiledUv(mesh)](std::size_t i) { return filed_uv(mesh.uvs[i]); }));
    }
    const std::vector<Rgb8> codes =
        lit.color.empty() ? codes_of(mesh.colors) : std::vector(lit.color.begin(), lit.color.end());
    if (!codes.empty()) {
        data.SetScalars(array_of<vtkUnsignedCharArray>("color", count,
                                                       [&](std::size_t i) { return codes[i]; }));
    } else if (!mesh.colors.empty()) {
        data.SetScalars(array_of<vtkFloatArray>("color_linear", count,
                                                [&](std::size_t i) { return mesh.colors[i]; }));
    }
}

/// VTK writes names into its XML as they are.
std::string array_name(const std::string& name, std::set<std::string>& taken)
{
    std::string safe = one_line(name);
    for (char& c : safe) {
        if (std::string_view("<>&\"'").find(c) != std::string_view::npos) { c = '_'; }
    }
    while (!taken.insert(safe).second) { safe += '_'; }
    return safe;
}

void add_quantities(vtkPointData& data, const LitMesh& lit)
{
    std::set<std::string> taken{"Normals", "TCoords", "color", "color_linear"};
    for (const Quantity3& q : lit.quantities) {
        const auto components = static_cast<std::size_t>(q.components);
        assert(q.values.size() == lit.mesh.positions.size() * components);
        const std::string name = array_name(q.name, taken);
        data.AddArray(array_of<vtkFloatArray>(
            name.c_str(), lit.mesh.positions.size(),
            [&](std::size_t i) { return q.values.subspan(components * i, components); }));
    }
}

void add_comments(vtkFieldData& data, const LitMesh& lit)
{
    vtkNew<vtkStringArray> comments;
    comments->SetName("comments");
    for (const std::string& comment : lit.comments) {
        comments->InsertNextValue(one_line(comment));
    }
    if (!lit.mesh.absent.empty()) {
        comments->InsertNextValue(std::to_string(lit.mesh.absent.size()) +
                                  " points are absent: NaN");
    }
    if (comments->GetNumberOfValues() > 0) { data.AddArray(comments); }
}

}  // namespace

Encoding encode_vtp(const LitMesh& lit)
{
    assert(!lit.mesh.positions.empty());
    vtkNew<vtkPolyData> data;
    set_points(*data, lit.mesh);
    set_cells(*data, lit.mesh);
    set_attributes(*data->GetPointData(), lit);
    add_quantities(*data->GetPointData(), lit);
    add_comments(*data->GetFieldData(), lit);
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetInputData(data);
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    writer->SetCompressorTypeToNone();
    writer->SetHeaderTypeToUInt64();
    writer->SetByteOrderToLittleEndian();
    writer->WriteToOutputStringOn();
    if (writer->Write() == 0) { throw std::runtime_error("the VTP writer failed"); }
    return sent_whole(writer->GetOutputString());
}

}  // namespace relight
