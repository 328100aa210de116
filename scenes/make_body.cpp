// A body of a scene, with its mesh read and its materials made.
#include <cmath>

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

// Every cell into eight, where the body asks for it. What is chosen by place was chosen before, so that it
// stays the same surface at every level.
Result<void> refine(const SceneBody& body, Mesh& mesh) {
  if (body.refine == 0) return {};
  if (std::holds_alternative<LatticeMesh>(body.mesh)) {
    return Error{
        "refine = " + std::to_string(body.refine) +
        ", but the mesh is a lattice, whose cubes fit its surface better when they are made smaller; "
        "halve mesh.lattice.spacing instead"};
  }
  auto finer = refine_mesh(mesh, body.refine);
  if (!finer) return Error{"refine: " + finer.error(), finer.failure().kind};
  mesh = std::move(finer).value();
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
  if (auto r = refine(body, def.mesh); !r) return Error{where + "." + r.error(), r.failure().kind};
  for (std::size_t m = 0; m < body.materials.size(); ++m) {
    auto refined = refined_numbers(body.materials[m], folder, body.refine);
    auto material = refined ? make_material(refined.value(), folder, &def.mesh) : refined.failure();
    if (!material) return Error{where + "." + place("materials", m) + ": " + material.error()};
    def.materials.push_back(
        {body.materials[m].region, std::move(material).value(), body.materials[m].density});
  }
  return made;
}

}  // namespace isochor
