#include "engine/mesh/read/foreign_format.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace isochor::mesh_files {

namespace {

// What can be done with a file of each kind.
enum class Kind { surface, meshio, gmsh, geometry, febio, vtk_other, packed, scene };

struct Format {
  const char* name;
  Kind kind;
};

std::string remedy(Kind kind, const std::string& file) {
  switch (kind) {
    case Kind::surface:
      return "it has only a surface: fill it with tetrahedra (fTetWild, TetGen, or Gmsh with 'Merge', "
             "'Surface Loop' "
             "and 'Volume'), or put it into cubes as mesh.lattice of a scene";
    case Kind::meshio:
      return "convert it with 'meshio convert " + file + " mesh.vtu'";
    case Kind::gmsh:
      return "convert it with 'gmsh " + file + " -0 -format msh41 -o mesh.msh', or with 'meshio convert'";
    case Kind::geometry:
      return "it has a shape and no mesh: mesh it with 'gmsh " + file + " -3 -format msh41 -o mesh.msh'";
    case Kind::febio:
      return "export the mesh from FEBio Studio as VTK";
    case Kind::vtk_other:
      return "save it as an unstructured grid of tetrahedra or hexahedra (.vtu)";
    case Kind::packed:
      return "unpack it, and export the mesh as .vtu or .msh";
    case Kind::scene:
      return "a scene file is run with 'isochor run', and names its mesh in bodies[].mesh.file";
  }
  return {};
}

bool any_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool has(std::string_view head, std::string_view part) {
  return head.find(part) != head.npos;
}

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return out;
}

// 80 bytes, a count, and 50 bytes a triangle.
bool is_binary_stl(std::string_view content) {
  if (content.size() < 84) return false;
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, content.data() + 80, sizeof triangles);
  return triangles > 0 && content.size() == 84 + 50 * std::uint64_t{triangles};
}

Format by_signature(std::string_view content, std::string_view extension) {
  using std::string_view_literals::operator""sv;
  if (content.starts_with("\x89HDF")) {
    if (extension == ".med") return {"a MED file (Salome)", Kind::gmsh};
    if (extension == ".cgns") return {"a CGNS file", Kind::gmsh};
    return {"an HDF5 file", Kind::meshio};
  }
  if (content.starts_with("CDF\x01") || content.starts_with("CDF\x02"))
    return {"an Exodus (netCDF) file", Kind::meshio};
  if (content.starts_with("PK\x03\x04")) return {"a ZIP archive (3MF, FreeCAD, NumPy .npz)", Kind::packed};
  if (content.starts_with("\x1f\x8b")) return {"a gzip archive", Kind::packed};
  if (content.starts_with("glTF")) return {"a glTF surface", Kind::surface};
  if (content.starts_with("\x93NUMPY")) return {"a NumPy array", Kind::meshio};
  if (content.starts_with("\x01\0\0\0"sv) && extension == ".meshb")
    return {"a binary Medit file", Kind::meshio};
  if (extension == ".meshb" && content.starts_with("\0\0\0\x01"sv))
    return {"a binary Medit file", Kind::meshio};
  if (is_binary_stl(content)) return {"an STL surface", Kind::surface};
  return {"", Kind::surface};
}

// By the element that an XML file opens with.
Format by_xml(std::string_view head) {
  if (has(head, "<febio_spec") || has(head, "<FEBio")) return {"a FEBio model", Kind::febio};
  if (has(head, "<Xdmf")) return {"an XDMF file", Kind::meshio};
  if (has(head, "<dolfin")) return {"a DOLFIN (FEniCS) mesh", Kind::meshio};
  if (has(head, "<COLLADA")) return {"a COLLADA surface", Kind::surface};
  if (has(head, "<X3D")) return {"an X3D surface", Kind::surface};
  if (has(head, "<VTKFile") && !has(head, "UnstructuredGrid"))
    return {"a VTK file of another kind than UnstructuredGrid", Kind::vtk_other};
  if (has(head, "<VTKFile")) return {"", Kind::surface};
  return {"an XML file without <VTKFile>", Kind::meshio};
}

Format by_text(std::string_view head, std::string_view first, std::string_view extension) {
  const std::string word = upper(first), text = upper(head);
  if (first == "solid") return {"an STL surface", Kind::surface};
  if (first == "ply") return {"a PLY surface", Kind::surface};
  if (any_of(word, {"OFF", "COFF", "NOFF", "STOFF"})) return {"an OFF surface", Kind::surface};
  if (has(text, "ISO-10303-21")) return {"a STEP geometry", Kind::geometry};
  if (has(head, "DBRep_DrawableShape")) return {"a BREP geometry", Kind::geometry};
  if (any_of(extension, {".igs", ".iges"})) return {"an IGES geometry", Kind::geometry};
  if (any_of(extension, {".geo", ".geo_unrolled", ".opt"})) return {"a Gmsh geometry", Kind::geometry};
  if (has(text, "BEGIN BULK") || has(text, "\nGRID ") || has(text, "\nGRID,") || has(text, "\nGRID*") ||
      text.starts_with("GRID") || any_of(extension, {".bdf", ".nas", ".fem"}))
    return {"a Nastran deck", Kind::gmsh};
  if (word == "*KEYWORD" || (extension == ".k" && first.starts_with("*")))
    return {"an LS-DYNA deck", Kind::meshio};
  if (extension == ".inp" && first.find_first_not_of("0123456789") == first.npos)
    return {"an AVS UCD file", Kind::meshio};
  if (has(text, "*NODE") || has(text, "*HEADING") || has(text, "*PART,") || extension == ".inp")
    return {"an Abaqus or CalculiX deck", Kind::meshio};
  if (has(text, "/PREP7") || has(text, "NBLOCK") || extension == ".cdb")
    return {"an Ansys deck", Kind::meshio};
  if (first.starts_with("(")) return {"an ANSYS Fluent mesh", Kind::meshio};
  if (first == "mesh3d" || extension == ".vol") return {"a Netgen mesh", Kind::meshio};
  if (word.starts_with("NDIME=") || extension == ".su2") return {"an SU2 mesh", Kind::meshio};
  if (extension == ".unv" || (first == "-1" && has(head, "2411"))) return {"a UNV file (I-DEAS)", Kind::gmsh};
  if (has(head, "FoamFile")) return {"an OpenFOAM file", Kind::meshio};
  if (has(head, "COMSOL")) return {"a COMSOL mesh", Kind::meshio};
  if (extension == ".poly" || extension == ".smesh")
    return {"a TetGen description of a surface", Kind::surface};
  if (extension == ".obj" || ((first == "v" || first == "o" || first == "mtllib") && has(head, "\nv ")))
    return {"a Wavefront (OBJ) surface", Kind::surface};
  if (first.starts_with("{") || extension == ".json") return {"a JSON file", Kind::scene};
  if (extension == ".stl") return {"an STL surface", Kind::surface};
  return {"", Kind::surface};
}

}  // namespace

std::string foreign_format(std::string_view content, std::string_view extension, const std::string& file) {
  const std::string_view head = content.substr(0, 20000);
  Format format = by_signature(content, extension);
  const std::size_t start = head.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  const std::string_view text = start == head.npos ? std::string_view() : head.substr(start);
  const std::string_view first = text.substr(0, text.find_first_of(" \t\r\n"));
  if (*format.name == 0) format = first.starts_with("<") ? by_xml(text) : by_text(head, first, extension);
  if (*format.name == 0) return {};
  return std::string("this is ") + format.name + ", which is not read; " + remedy(format.kind, file);
}

}  // namespace isochor::mesh_files
