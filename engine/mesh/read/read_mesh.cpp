// read_mesh: tells the format, reads, and is the one place where a reader's failure becomes an Error.
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <new>

#include "engine/mesh/read/foreign_format.h"
#include "engine/mesh/read/readers.h"
#include "isochor/mesh_io.h"
#include "isochor/solids.h"

namespace isochor {

namespace mesh_files {

std::string load_file(const std::string& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw ReadFailure{file + ": there is no such file; check the path"};
  }
  if (error) throw ReadFailure{join(file, ": the file cannot be reached: ", error.message())};
  if (status.type() == std::filesystem::file_type::directory) {
    throw ReadFailure{file + ": this is a directory; name the mesh file in it"};
  }
  if (status.type() != std::filesystem::file_type::regular) {
    throw ReadFailure{file + ": this is no regular file; copy the mesh to one"};
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!stream) throw ReadFailure{join(file, ": the file cannot be opened: ", std::strerror(errno))};
  std::string content;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (!error) content.resize(static_cast<std::size_t>(size));
  const std::size_t got = std::fread(content.data(), 1, content.size(), stream.get());
  if (std::ferror(stream.get())) throw ReadFailure{join(file, ": reading failed: ", std::strerror(errno))};
  content.resize(got);
  return content;
}

namespace {

std::string_view first_word(std::string_view content) {
  const std::size_t start = content.find_first_not_of(" \t\r\n");
  if (start == content.npos) return {};
  const std::string_view rest = content.substr(start);
  return rest.substr(0, rest.find_first_of(" \t\r\n"));
}

// Comment lines, which Medit and TetGen allow before anything else.
std::string_view without_comments(std::string_view content) {
  for (;;) {
    const std::size_t start = content.find_first_not_of(" \t\r\n");
    if (start == content.npos || content[start] != '#') return content;
    const std::size_t end = content.find('\n', start);
    if (end == content.npos) return {};
    content.remove_prefix(end);
  }
}

std::string extension_of(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  for (char& c : extension) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return extension;
}

RawMesh read_any(const std::string& file) {
  const std::string extension = extension_of(file);
  const std::string content = load_file(file);
  if (content.find_first_not_of(" \t\r\n") == content.npos) {
    throw ReadFailure{file + ": the file is empty; export the mesh again"};
  }
  if (content.starts_with("# vtk DataFile")) return read_vtk_legacy(content, file);
  const std::string_view word = first_word(without_comments(content));
  // Gmsh's word may come late: lines before it are skipped.
  const bool gmsh = content.starts_with("$MeshFormat") || content.find("\n$MeshFormat") != content.npos ||
                    word == "$NOD" || word.starts_with("$MeshFormat");
  const bool medit = word == "MeshVersionFormatted";
  const bool tetgen = extension == ".node" || extension == ".ele" || extension == ".face";
  if (!gmsh && is_abaqus(content)) return read_abaqus(content, file);
  if (!gmsh && !medit && !tetgen) {
    if (const auto what = foreign_format(content, extension, file); !what.empty())
      throw ReadFailure{file + ": " + what};
  }
  if (gmsh || word.starts_with("$")) return read_gmsh(content, file);
  if (word.starts_with("<") || word.starts_with("\xEF\xBB\xBF<")) return read_vtu(content, file);
  if (medit) return read_medit(content, file);
  // Numbers only: nothing in the content tells TetGen's files apart.
  if (tetgen) return read_tetgen(file);
  if (extension == ".msh") return read_gmsh(content, file);
  if (extension == ".vtk") return read_vtk_legacy(content, file);
  if (extension == ".vtu") return read_vtu(content, file);
  if (extension == ".mesh" || extension == ".meshb") return read_medit(content, file);
  throw ReadFailure{join(file, ": the file begins with ", quoted(first_word(content)),
                         ", which is no known mesh format; read are Gmsh .msh (2.2, 4.1), VTK .vtk and .vtu, "
                         "TetGen .node/.ele, Medit .mesh and Abaqus .inp: convert it with 'meshio convert'")};
}

// Faces in place of cells, for a thin body: what numbers them numbers its regions.
void take_triangles(RawMesh& raw) {
  RawMesh flat;
  flat.file = raw.file;
  flat.nodes = std::move(raw.nodes);
  flat.node_label = std::move(raw.node_label);
  flat.cell_width = 3;
  flat.region_name = raw.surface_name;
  flat.node_sets = std::move(raw.node_sets);
  flat.fields = std::move(raw.fields);
  flat.stray_lines = raw.stray_lines;
  for (const auto& [tag, quadrangles] : raw.quadrangles)
    flat.foreign_faces += static_cast<std::int64_t>(quadrangles.faces.size()) / quadrangles.width;
  const auto take = [&flat](std::int64_t tag, const std::vector<Index>& faces, int width) {
    for (std::size_t f = 0; width > 0 && f < faces.size(); f += static_cast<std::size_t>(width)) {
      flat.cells.insert(flat.cells.end(), &faces[f], &faces[f] + 3);
      flat.cell_tag.push_back(tag);
      flat.cell_label.push_back(static_cast<std::int64_t>(flat.cell_label.size()) + 1);
    }
  };
  take(no_tag, raw.loose_triangles, 3);
  for (const auto& [tag, surface] : raw.surfaces) take(tag, surface.faces, surface.width);
  if (flat.cells.empty()) {
    throw ReadFailure{
        raw.file +
        (flat.foreign_faces > 0 ? ": the file has quadrangles and no triangles"
                                : ": the file has no triangles") +
        ", and a thin body is made of them; mesh its surface with triangles and export it (in Gmsh: "
        "a physical surface, or 'save all')"};
  }
  raw = std::move(flat);
}

}  // namespace

}  // namespace mesh_files

namespace {

// Every region of a mesh of triangles is a surface, too.
Mesh with_named_sheets(Mesh mesh) {
  if (mesh.regions.size() == 1 && mesh.regions[0] == "unassigned") {
    mesh.regions = {"body"};
    return mesh;
  }
  for (std::size_t r = 0; r < mesh.regions.size(); ++r) {
    MeshSurface sheet{mesh.regions[r], {}};
    for (Index c = 0; c < mesh.cell_count(); ++c) {
      const auto cell = static_cast<std::size_t>(c);
      if (!mesh.cell_region.empty() && mesh.cell_region[cell] != static_cast<Index>(r)) continue;
      sheet.faces.insert(sheet.faces.end(), &mesh.cells[3 * cell], &mesh.cells[3 * cell] + 3);
    }
    mesh.surfaces.push_back(std::move(sheet));
  }
  return mesh;
}

Result<Mesh> read_triangles(const std::string& path, const MeshReadOptions& options) {
  const std::string extension = mesh_files::extension_of(path);
  if (extension != ".obj" && extension != ".stl") {
    auto raw = mesh_files::read_any(path);
    mesh_files::take_triangles(raw);
    return with_named_sheets(mesh_files::assemble(std::move(raw), options.scale));
  }
  auto surface = read_surface(path, options.scale);
  if (!surface) return surface.failure();
  Mesh mesh;
  mesh.cell_type = CellType::tri3;
  mesh.source = path;
  mesh.nodes = std::move(surface.value().points);
  mesh.cells = std::move(surface.value().triangles);
  return mesh;
}

}  // namespace

Result<Mesh> read_mesh(const std::string& path, const MeshReadOptions& options) {
  if (!std::isfinite(options.scale) || options.scale <= 0) {
    return Error{
        mesh_files::join(path, ": the scale is ", options.scale, "; give a positive number such as 0.001")};
  }
  try {
    if (options.triangles) return read_triangles(path, options);
    return mesh_files::assemble(mesh_files::read_any(path), options.scale);
  } catch (const mesh_files::ReadFailure& failure) {
    return Error{failure.message};
  } catch (const std::bad_alloc&) {
    return Error{path + ": the mesh does not fit into memory; use a coarser one", ErrorKind::no_memory};
  } catch (const std::exception& other) {
    return Error{path + ": reading failed: " + other.what()};
  }
}

}  // namespace isochor
