#include "scenes/run/pieces.h"

#include <filesystem>
#include <vector>

#include "engine/base/base.h"
#include "scenes/run/outputs.h"

namespace isochor {

namespace fs = std::filesystem;

namespace {

// Part of a grid with points and values of its own.
struct Piece {
  VtkGrid grid;
  std::vector<Vec3> points;
  std::vector<Index> cells, point_of;
  std::vector<std::vector<double>> values;
};

std::vector<double> take(const VtkField& field, std::span<const Index> of) {
  const auto width = static_cast<std::size_t>(field.components);
  std::vector<double> values;
  values.reserve(width * of.size());
  for (const Index i : of) {
    const auto part = field.values.subspan(width * at(i), width);
    values.insert(values.end(), part.begin(), part.end());
  }
  return values;
}

// Cells [from, to) with the points they use, in the order of the whole.
void cut(const VtkGrid& whole, std::size_t from, std::size_t to, Piece& piece) {
  const auto width = static_cast<std::size_t>(nodes_per_cell(whole.cell_type));
  const auto cells = whole.cells.subspan(width * from, width * (to - from));
  std::vector<Index> number(whole.points.size(), -1);
  for (const Index i : cells) number[at(i)] = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<Index>(piece.point_of.size());
    piece.point_of.push_back(static_cast<Index>(i));
    piece.points.push_back(whole.points[i]);
  }
  for (const Index i : cells) piece.cells.push_back(number[at(i)]);
  std::vector<Index> cell_of;
  for (std::size_t c = from; c < to; ++c) cell_of.push_back(static_cast<Index>(c));
  piece.grid.cell_type = whole.cell_type;
  piece.grid.points = piece.points;
  piece.grid.cells = piece.cells;
  piece.values.reserve(whole.point_fields.size() + whole.cell_fields.size());
  const auto add = [&](const std::vector<VtkField>& fields, std::span<const Index> of,
                       std::vector<VtkField>& out) {
    for (const VtkField& field : fields) {
      piece.values.push_back(take(field, of));
      out.push_back({field.name, field.components, piece.values.back()});
    }
  };
  add(whole.point_fields, piece.point_of, piece.grid.point_fields);
  add(whole.cell_fields, cell_of, piece.grid.cell_fields);
}

std::size_t cells_of(const VtkGrid& grid) {
  return grid.cells.size() / static_cast<std::size_t>(nodes_per_cell(grid.cell_type));
}

// The first cell of a rank's part.
std::size_t first_cell(const VtkGrid& grid, int rank, int ranks) {
  return cells_of(grid) * static_cast<std::size_t>(rank) / static_cast<std::size_t>(ranks);
}

bool has_cells(const VtkGrid& grid, int rank, int ranks) {
  return first_cell(grid, rank, ranks) < first_cell(grid, rank + 1, ranks);
}

std::string list_of_pieces(const std::string& path, const VtkGrid& grid, int ranks) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\">\n"
      "  <PUnstructuredGrid GhostLevel=\"0\">\n    <PPoints>\n"
      "      <PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n    </PPoints>\n";
  const auto list = [&](const char* element, const std::vector<VtkField>& fields) {
    text += std::string("    <") + element + ">\n";
    for (const VtkField& field : fields)
      text += "      <PDataArray type=\"Float64\" Name=\"" + field.name + "\" NumberOfComponents=\"" +
              std::to_string(field.components) + "\"/>\n";
    text += std::string("    </") + element + ">\n";
  };
  list("PPointData", grid.point_fields);
  list("PCellData", grid.cell_fields);
  for (int r = 0; r < ranks; ++r) {
    if (!has_cells(grid, r, ranks)) continue;
    std::string name;
    for (const char c : fs::path(piece_file(path, r)).filename().string()) {
      const char* const escaped = c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : nullptr;
      name += escaped ? std::string(escaped) : std::string(1, c);
    }
    text += "    <Piece Source=\"" + name + "\"/>\n";
  }
  return text + "  </PUnstructuredGrid>\n</VTKFile>\n";
}

}  // namespace

std::string piece_file(const std::string& pvtu, int rank) {
  return pvtu.substr(0, pvtu.rfind('.')) + "_" + std::to_string(rank) + ".vtu";
}

Result<void> write_pieces(const std::string& path, const VtkGrid& grid, const Ranks& ranks) {
  const int rank = ranks.rank(), size = ranks.size();
  Result<void> written;
  // Readers take a piece without cells for a broken one.
  if (has_cells(grid, rank, size)) {
    Piece piece;
    cut(grid, first_cell(grid, rank, size), first_cell(grid, rank + 1, size), piece);
    written = write_vtu(piece_file(path, rank), piece.grid);
  }
  if (auto r = on_all(std::move(written), ranks); !r) return r;
  const bool root = rank == 0;
  return on_all(root ? write_text(path, list_of_pieces(path, grid, size)) : Result<void>(), ranks);
}

Result<void> on_all(Result<void> here, const Ranks& ranks) {
  double failed = here ? 0 : 1;
  ranks.sum({&failed, 1});
  if (failed > 0 && here) return Error{"another rank could not write"};
  return here;
}

}  // namespace isochor
