// VTK XML output: unstructured grids with zlib-compressed appended arrays, and the .pvd list of a time
// series.
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>

#include "engine/base/atomic_file.h"
#include "engine/mesh/words.h"
#include "isochor/mesh_io.h"

namespace isochor {

namespace {

using mesh_files::AtomicFile;
using mesh_files::join;

// Large enough for good compression, small enough for viewers that inflate block by block.
constexpr std::size_t block_bytes = std::size_t{1} << 18;

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

void append_word(std::string& out, std::uint64_t word) {
  out.append(reinterpret_cast<const char*>(&word), sizeof word);
}

// Block count, block size, size of the last block if it is short (else 0), deflated sizes, deflated blocks.
bool append_deflated(std::string& out, std::string_view bytes) {
  const std::size_t blocks = (bytes.size() + block_bytes - 1) / block_bytes;
  std::string body;
  std::vector<std::uint64_t> sizes;
  std::vector<Bytef> buffer(compressBound(block_bytes));
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::string_view block = bytes.substr(b * block_bytes, block_bytes);
    uLongf size = static_cast<uLongf>(buffer.size());
    // Level 1: result files are written every few steps, and doubles hardly shrink further.
    const int status = compress2(buffer.data(), &size, reinterpret_cast<const Bytef*>(block.data()),
                                 static_cast<uLong>(block.size()), 1);
    if (status != Z_OK) return false;
    sizes.push_back(size);
    body.append(reinterpret_cast<const char*>(buffer.data()), size);
  }
  append_word(out, blocks);
  append_word(out, block_bytes);
  append_word(out, bytes.size() % block_bytes);
  for (const std::uint64_t size : sizes) append_word(out, size);
  out += body;
  return true;
}

// The XML head and the appended bytes, built side by side.
struct VtuText {
  std::string head, body;
  bool deflated = true;

  template <class T>
  void add(const char* type, std::string_view name, int components, std::span<const T> values) {
    head += join("        <DataArray type=\"", type, "\" Name=\"", escaped(name), "\" NumberOfComponents=\"",
                 components, "\" format=\"appended\" offset=\"", body.size(), "\"/>\n");
    const auto bytes = std::as_bytes(values);
    deflated = append_deflated(body, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}) && deflated;
  }
};

Result<void> check_fields(const std::string& path, const std::vector<VtkField>& fields, std::size_t count,
                          const char* kind) {
  for (const VtkField& field : fields) {
    if (field.name.empty()) return Error{join(path, ": a ", kind, " field has no name; name it")};
    if (field.components < 1 || field.values.size() != count * static_cast<std::size_t>(field.components)) {
      return Error{join(path, ": the ", kind, " field '", field.name, "' has ", field.values.size(),
                        " values for ", count, " times ", field.components,
                        " components; give it one value each")};
    }
  }
  return {};
}

Result<void> check_grid(const std::string& path, const VtkGrid& grid) {
  const auto width = static_cast<std::size_t>(nodes_per_cell(grid.cell_type));
  if (grid.cells.size() % width != 0) {
    return Error{join(path, ": ", grid.cells.size(), " cell entries are no multiple of ", width)};
  }
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    const Index n = grid.cells[i];
    if (n < 0 || static_cast<std::size_t>(n) >= grid.points.size()) {
      return Error{
          join(path, ": cell ", i / width, " uses point ", n, " of ", grid.points.size(), " points")};
    }
  }
  const Result<void> points = check_fields(path, grid.point_fields, grid.points.size(), "point");
  return points ? check_fields(path, grid.cell_fields, grid.cells.size() / width, "cell") : points;
}

VtuText grid_text(const VtkGrid& grid) {
  const auto width = static_cast<std::size_t>(nodes_per_cell(grid.cell_type));
  const std::size_t cells = grid.cells.size() / width;
  std::vector<std::int64_t> offsets(cells);
  for (std::size_t c = 0; c < cells; ++c) offsets[c] = static_cast<std::int64_t>((c + 1) * width);
  // VTK's numbers of the linear and the quadratic tetrahedron and of the hexahedron.
  const std::uint8_t number = grid.cell_type == CellType::tri3 ? 5
                              : grid.cell_type == CellType::tet4
                                  ? 10
                                  : (grid.cell_type == CellType::hex8 ? 12 : 24);
  const std::vector<std::uint8_t> types(cells, number);
  std::vector<double> coordinates;
  coordinates.reserve(3 * grid.points.size());
  for (const Vec3& x : grid.points) coordinates.insert(coordinates.end(), {x.x, x.y, x.z});

  VtuText text;
  text.head =
      join("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"",
           std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian",
           "\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n  <UnstructuredGrid>\n",
           "    <Piece NumberOfPoints=\"", grid.points.size(), "\" NumberOfCells=\"", cells, "\">\n");
  text.head += "      <Points>\n";
  text.add<double>("Float64", "Points", 3, coordinates);
  text.head += "      </Points>\n      <Cells>\n";
  text.add<Index>("Int32", "connectivity", 1, grid.cells);
  text.add<std::int64_t>("Int64", "offsets", 1, offsets);
  text.add<std::uint8_t>("UInt8", "types", 1, types);
  text.head += "      </Cells>\n      <PointData>\n";
  for (const VtkField& f : grid.point_fields) text.add<double>("Float64", f.name, f.components, f.values);
  text.head += "      </PointData>\n      <CellData>\n";
  for (const VtkField& f : grid.cell_fields) text.add<double>("Float64", f.name, f.components, f.values);
  text.head += "      </CellData>\n    </Piece>\n  </UnstructuredGrid>\n";
  return text;
}

}  // namespace

Result<void> write_vtu(const std::string& path, const VtkGrid& grid) {
  try {
    if (Result<void> valid = check_grid(path, grid); !valid) return valid;
    const VtuText text = grid_text(grid);
    if (!text.deflated) return Error{path + ": compressing the data failed; is there memory left?"};
    AtomicFile file(path);
    file.write(text.head);
    file.write("  <AppendedData encoding=\"raw\">\n_");
    file.write(text.body);
    file.write("\n  </AppendedData>\n</VTKFile>\n");
    return file.commit();
  } catch (const std::exception& failure) {
    return Error{path + ": writing failed: " + failure.what()};
  }
}

Result<void> write_pvd(const std::string& path, std::span<const PvdEntry> entries) {
  try {
    std::string text =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n  <Collection>\n";
    for (const PvdEntry& entry : entries) {
      if (!std::isfinite(entry.time)) {
        return Error{join(path, ": the time of '", entry.file, "' is ", entry.time, "; give a finite one")};
      }
      text += join("    <DataSet timestep=\"", entry.time, "\" part=\"0\" file=\"", escaped(entry.file),
                   "\"/>\n");
    }
    AtomicFile file(path);
    file.write(text);
    file.write("  </Collection>\n</VTKFile>\n");
    return file.commit();
  } catch (const std::exception& failure) {
    return Error{path + ": writing failed: " + failure.what()};
  }
}

}  // namespace isochor
