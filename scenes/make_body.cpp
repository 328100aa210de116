// A body of a scene, with its mesh read and its materials made.
#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "isochor/mesh_io.h"
#include "scenes/body_parts.h"
#include "scenes/check_values.h"

namespace isochor {

namespace {

Result<Mesh> make_mesh(const SceneBody& body, const std::string& folder, DisplaySurface& surface) {
  if (const auto* lattice = std::get_if<LatticeMesh>(&body.mesh)) {
    auto made = make_lattice(*lattice, folder);
    if (!made) return made.failure();
    surface = std::move(made.value().surface);
    return std::move(made.value().mesh);
  }
  if (const auto* box = std::get_if<BoxMeshDef>(&body.mesh)) return box_mesh(*box);
  const auto& file = std::get<MeshFile>(body.mesh);
  auto mesh = read_mesh(path_in(folder, file.path), {file.scale, body.element == Element::tri3});
  if (mesh) {
    const double angle = std::sqrt(dot(file.turn, file.turn)), c = std::cos(angle), s = std::sin(angle);
    const Vec3 axis = angle > 0 ? (1 / angle) * file.turn : Vec3{};
    for (Vec3& x : mesh.value().nodes) {
      // Rodrigues' formula; without a turn the coordinates keep their bits.
      if (angle > 0) x = c * x + s * cross(axis, x) + (1 - c) * dot(axis, x) * axis;
      x += file.offset;
    }
  }
  return mesh;
}

// Surfaces and node sets that the scene names by where they are.
Result<void> name_places(const SceneBody& body, const std::string& folder, Mesh& mesh) {
  const auto add_all = [&](const char* list, const std::vector<MeshSelection>& all,
                           const auto& add_one) -> Result<void> {
    for (std::size_t i = 0; i < all.size(); ++i) {
      MeshSelection one = all[i];
      if (!one.file.empty()) {
        auto surface = read_surface(path_in(folder, one.file), one.scale);
        if (!surface) return Error{place(list, i) + ".file: " + surface.error()};
        one.lies_on = std::move(surface).value();
      }
      if (auto r = add_one(mesh, one); !r) return Error{place(list, i) + ": " + r.error()};
    }
    return {};
  };
  if (auto r = add_all("surfaces", body.surfaces, add_surface); !r) return r;
  return add_all("node_sets", body.node_sets, add_node_set);
}

constexpr int kMostLevels = 12;  // of the key levels

Error not_for_lattices(const std::string& what) {
  return Error{what +
               ", but the mesh is a lattice, whose cubes fit its surface better when they are made smaller; "
               "halve mesh.lattice.spacing instead"};
}

// Nodes that a cell of the place has one of; all where nothing says where they are.
Result<std::vector<std::uint8_t>> nodes_of(const RefinedPlace& place, const std::string& who,
                                           const Mesh& mesh) {
  std::vector<std::uint8_t> in(mesh.nodes.size(), 1);
  const auto keep = [&](MeshSelection selection) -> Result<void> {
    selection.name = who;
    selection.tolerance = place.tolerance;
    const auto nodes = select_nodes(mesh, selection);
    if (!nodes) {
      // The selection is the place itself.
      const std::string name = "selection \"" + who + "\"";
      const std::string& text = nodes.error();
      return Error{who + (text.starts_with(name) ? text.substr(name.size()) : ": " + text)};
    }
    std::vector<std::uint8_t> both(in.size(), 0);
    for (const Index n : nodes.value()) both[static_cast<std::size_t>(n)] = in[static_cast<std::size_t>(n)];
    in = std::move(both);
    return {};
  };
  if (place.box || place.sphere) {
    MeshSelection inside;
    inside.box = place.box;
    inside.sphere = place.sphere;
    if (auto r = keep(std::move(inside)); !r) return r.failure();
  }
  if (!place.surfaces.empty()) {
    MeshSelection on;
    on.of = place.surfaces;
    if (auto r = keep(std::move(on)); !r) return r.failure();
  }
  return in;
}

Result<std::vector<std::uint8_t>> regions_of(const RefinedPlace& place, const Mesh& mesh) {
  std::vector<std::uint8_t> in(std::max<std::size_t>(1, mesh.regions.size()), place.regions.empty() ? 1 : 0);
  for (const std::string& name : place.regions) {
    const auto found = std::find(mesh.regions.begin(), mesh.regions.end(), name);
    if (found == mesh.regions.end()) {
      std::string all;
      for (const std::string& r : mesh.regions) all += (all.empty() ? "" : ", ") + r;
      return Error{"regions: there is no \"" + name + "\"; the mesh has " + (all.empty() ? "none" : all)};
    }
    in[static_cast<std::size_t>(found - mesh.regions.begin())] = 1;
  }
  return in;
}

Result<std::vector<Index>> cells_of(const RefinedPlace& place, const std::string& who, const Mesh& mesh,
                                    const std::string& folder) {
  const auto nodes = nodes_of(place, who, mesh);
  if (!nodes) return nodes.failure();
  const auto regions = regions_of(place, mesh);
  if (!regions) return Error{who + "." + regions.error()};
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  const auto fits = [&](Index c) {
    const auto cell = static_cast<std::size_t>(c);
    const auto region =
        mesh.cell_region.empty() ? std::size_t{0} : static_cast<std::size_t>(mesh.cell_region[cell]);
    const Index* first = mesh.cells.data() + cell * per;
    return regions.value()[region] != 0 && std::any_of(first, first + per, [&](Index n) {
             return nodes.value()[static_cast<std::size_t>(n)] != 0;
           });
  };
  const auto given = place.cells.given() ? read_field(place.cells, folder)
                                         : Result<std::vector<double>>(std::vector<double>{});
  if (!given) return Error{who + ".cells: " + given.error()};
  std::vector<Index> out;
  for (Index c = 0; !place.cells.given() && c < mesh.cell_count(); ++c) {
    if (fits(c)) out.push_back(c);
  }
  for (std::size_t k = 0; k < given.value().size(); ++k) {
    const double number_of = given.value()[k];
    if (!(number_of >= 0) || number_of >= mesh.cell_count() || number_of != std::floor(number_of)) {
      return Error{who + ".cells[" + std::to_string(k) + "] = " + number(number_of) +
                   "; the mesh has cells 0 to " + std::to_string(mesh.cell_count() - 1) +
                   " when they are refined"};
    }
    if (fits(static_cast<Index>(number_of))) out.push_back(static_cast<Index>(number_of));
  }
  if (out.empty()) return Error{who + ": no cell of the mesh fits"};
  return out;
}

void hand_down(std::vector<Index>& parent, std::span<const Index> of_finer) {
  std::vector<Index> out(of_finer.begin(), of_finer.end());
  for (Index& c : out) c = parent.empty() ? c : parent[static_cast<std::size_t>(c)];
  parent = std::move(out);
}

// Every cell into eight, then those of places, where the body asks for it. What is chosen by name was chosen
// before, so that it stays the same surface at every level.
Result<void> refine(const SceneBody& body, const std::string& folder, Mesh& mesh,
                    std::vector<Index>& parent) {
  const bool lattice = std::holds_alternative<LatticeMesh>(body.mesh);
  if (body.refine != 0) {
    if (lattice) return not_for_lattices("refine = " + std::to_string(body.refine));
    auto finer = refine_mesh(mesh, body.refine);
    if (!finer) return Error{"refine: " + finer.error(), finer.failure().kind};
    mesh = std::move(finer).value();
    const int cuts = mesh.cell_type == CellType::tri3 ? 2 : 3;  // children of a cell: 2^cuts
    for (Index c = 0; c < mesh.cell_count(); ++c) parent.push_back(c >> (cuts * body.refine));
  }
  for (std::size_t k = 0; k < body.refine_where.size(); ++k) {
    const RefinedPlace& where = body.refine_where[k];
    const std::string who = place("refine_where", k);
    if (!where.box && !where.sphere && where.surfaces.empty() && where.regions.empty() &&
        !where.cells.given())
      return Error{who +
                   " says nowhere; give box, sphere, surfaces, regions or cells, or use refine for all"};
    if (lattice) return not_for_lattices(who + " is given");
    if (where.cells.given() && where.levels != 1) {
      return Error{who + ".levels = " + std::to_string(where.levels) +
                   " with numbers of cells, which are those of another mesh after the first; leave it at 1"};
    }
    if (where.levels < 1 || where.levels > kMostLevels) {
      return Error{who + ".levels = " + std::to_string(where.levels) + "; give a number from 1 to " +
                   std::to_string(kMostLevels)};
    }
    for (int level = 0; level < where.levels; ++level) {
      const auto cells = cells_of(where, who, mesh, folder);
      if (!cells) return cells.failure();
      auto finer = refine_cells(mesh, cells.value());
      if (!finer) return Error{who + ": " + finer.error(), finer.failure().kind};
      mesh = std::move(finer.value().mesh);
      hand_down(parent, finer.value().parent);
    }
  }
  return {};
}

Result<void> add_fiber_field(const SceneFiberField& field, Mesh& mesh) {
  if (field.name.empty()) return Error{"it has no name, by which fibers and muscles would find it; give one"};
  for (const auto* list : {&mesh.cell_fields, &mesh.fields}) {
    for (const MeshField& f : *list) {
      if (f.name == field.name)
        return Error{"the mesh has a field \"" + field.name + "\" already; give another name"};
    }
  }
  auto directions = laplace_directions(mesh, field);
  if (!directions) return directions.failure();
  MeshField made;
  made.name = field.name;
  made.components = 3;
  for (const Vec3& d : directions.value()) made.values.insert(made.values.end(), {d.x, d.y, d.z});
  mesh.cell_fields.push_back(std::move(made));
  return {};
}

}  // namespace

Result<MadeBody> make_body(const SceneBody& body, const std::string& folder, const std::string& where,
                           const Mesh* given) {
  MadeBody made;
  BodyDef& def = made.def;
  def.name = body.name;
  def.element = body.element;
  def.guard_stiffness = body.guard_stiffness;
  def.guard_threshold = body.guard_threshold;
  auto mesh = given ? Result<Mesh>(*given) : make_mesh(body, folder, made.surface);
  if (!mesh) return Error{where + ".mesh: " + mesh.error()};
  def.mesh = std::move(mesh).value();
  if (auto r = name_places(body, folder, def.mesh); !r) return Error{where + "." + r.error()};
  if (auto r = refine(body, folder, def.mesh, made.parent); !r)
    return Error{where + "." + r.error(), r.failure().kind};
  for (std::size_t k = 0; k < body.fiber_fields.size(); ++k) {
    if (auto r = add_fiber_field(body.fiber_fields[k], def.mesh); !r)
      return Error{where + "." + place("fiber_fields", k) + ": " + r.error()};
  }
  for (std::size_t m = 0; m < body.materials.size(); ++m) {
    auto refined = refined_numbers(body.materials[m], folder, made.parent);
    auto material = refined ? make_material(refined.value(), folder, &def.mesh) : refined.failure();
    if (!material) return Error{where + "." + place("materials", m) + ": " + material.error()};
    def.materials.push_back(
        {body.materials[m].region, std::move(material).value(), body.materials[m].density});
  }
  return made;
}

}  // namespace isochor
