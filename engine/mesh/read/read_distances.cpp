// read_distances: structured points of VTK legacy files, and SDFGen's text.
#include <bit>
#include <cmath>

#include "engine/mesh/read/readers.h"
#include "isochor/solids.h"

namespace isochor {

namespace {

using mesh_files::Cursor;

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return out;
}

// How many values a grid has; refused where the file cannot hold them.
std::size_t values_of(const Cursor& at, const DistanceGrid& g, std::size_t least_bytes) {
  double product = 1;
  for (const Index n : g.count) product *= n;
  if (!(product < 1e15)) at.fail("the grid is too large", "take a larger spacing");
  return at.checked_count(static_cast<std::int64_t>(product), least_bytes, "the number of values");
}

void read_counts(Cursor& at, DistanceGrid& g) {
  for (Index& n : g.count) {
    const std::int64_t count = at.integer("the number of points along an axis");
    if (count < 1 || count > 100000) at.fail("a grid of this many points", "give 4 to 100000 points an axis");
    n = static_cast<Index>(count);
  }
}

void read_vector(Cursor& at, Vec3& v, const char* what) {
  for (int k = 0; k < 3; ++k) v[k] = at.real(what);
}

DistanceGrid read_vtk(Cursor& at) {
  DistanceGrid g;
  at.line("the header");
  at.line("the title");
  const bool binary = upper(at.word("ASCII or BINARY")) == "BINARY";
  at.word("DATASET");
  const std::string kind = upper(at.word("a dataset type"));
  if (kind != "STRUCTURED_POINTS") {
    at.fail("the dataset is " + mesh_files::quoted(kind),
            "a distance field is STRUCTURED_POINTS (image data)");
  }
  for (;;) {
    const std::string keyword = upper(at.word("SCALARS"));
    if (keyword == "DIMENSIONS") {
      read_counts(at, g);
    } else if (keyword == "ORIGIN") {
      read_vector(at, g.origin, "the origin");
    } else if (keyword == "SPACING" || keyword == "ASPECT_RATIO") {
      read_vector(at, g.spacing, "the spacing");
    } else if (keyword == "POINT_DATA") {
      at.integer("the number of values");
    } else if (keyword == "SCALARS") {
      break;
    } else {
      at.fail(mesh_files::quoted(keyword) + " comes before the values",
              "write the distances as the first SCALARS of POINT_DATA");
    }
  }
  at.word("a name");
  const std::string type = upper(at.word("a type"));
  if (type != "FLOAT" && type != "DOUBLE") {
    at.fail("distances of type " + mesh_files::quoted(type), "write them as float or double");
  }
  if (upper(at.peek_word()) != "LOOKUP_TABLE") at.word("the number of components");
  at.word("LOOKUP_TABLE");
  at.word("a table name");
  const std::size_t bytes = type == "FLOAT" ? 4 : 8;
  const std::size_t count = values_of(at, g, binary ? bytes : 2);
  g.values.reserve(count);
  if (binary) at.line("the values");
  at.set_binary(binary);
  // The format is big-endian whatever machine wrote it.
  at.set_swapped(std::endian::native == std::endian::little);
  for (std::size_t i = 0; i < count; ++i) {
    if (!binary)
      g.values.push_back(at.real("a distance"));
    else
      g.values.push_back(bytes == 4 ? static_cast<double>(at.raw<float>("a distance"))
                                    : at.raw<double>("a distance"));
  }
  return g;
}

DistanceGrid read_sdf(Cursor& at) {
  DistanceGrid g;
  read_counts(at, g);
  read_vector(at, g.origin, "the origin");
  const double spacing = at.real("the spacing");
  g.spacing = {spacing, spacing, spacing};
  const std::size_t count = values_of(at, g, 2);
  g.values.reserve(count);
  for (std::size_t i = 0; i < count; ++i) g.values.push_back(at.real("a distance"));
  return g;
}

}  // namespace

Result<DistanceGrid> read_distances(const std::string& path, double scale) {
  if (!(scale > 0) || !std::isfinite(scale)) {
    return Error{mesh_files::join(path, ": the scale is ", scale, "; give a positive number such as 0.001")};
  }
  try {
    const std::string content = mesh_files::load_file(path);
    Cursor at(content, path);
    DistanceGrid g = content.starts_with("# vtk DataFile") ? read_vtk(at) : read_sdf(at);
    g.origin = scale * g.origin;
    g.spacing = scale * g.spacing;
    for (double& v : g.values) v *= scale;
    return g;
  } catch (const mesh_files::ReadFailure& failure) {
    return Error{failure.message};
  } catch (const std::bad_alloc&) {
    return Error{path + ": the grid does not fit into memory; use a coarser one", ErrorKind::no_memory};
  }
}

}  // namespace isochor
