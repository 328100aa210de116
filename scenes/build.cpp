#include <cmath>

#include "isochor/mesh_io.h"
#include "isochor/schemes.h"
#include "scenes/body_parts.h"
#include "scenes/effects/kind.h"
#include "scenes/step_measures.h"

namespace isochor {

namespace {

SchemePtr make_scheme(const AnalysisDef& a) {
  if (a.type == AnalysisType::statics) return a.path_step ? continuation() : statics();
  switch (a.scheme) {
    case SchemeWord::implicit_euler:
      return implicit_euler();
    case SchemeWord::bdf2:
      return bdf2();
    case SchemeWord::generalized_alpha:
      return generalized_alpha(a.spectral_radius);
    case SchemeWord::newmark:
      return newmark();
    case SchemeWord::implicit_midpoint:
      return implicit_midpoint();
  }
  return nullptr;
}

Result<Mesh> make_mesh(const SceneBody& body, const std::string& folder, DisplaySurface& surface) {
  if (const auto* lattice = std::get_if<LatticeMesh>(&body.mesh)) {
    auto made = make_lattice(*lattice, folder);
    if (!made) return Error{made.error()};
    surface = std::move(made.value().surface);
    return std::move(made.value().mesh);
  }
  if (const auto* box = std::get_if<BoxMeshDef>(&body.mesh)) return box_mesh(*box);
  const auto& file = std::get<MeshFile>(body.mesh);
  auto mesh = read_mesh(path_in(folder, file.path), {file.scale});
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

Result<void> add_bodies(const SceneDef& scene, const BuildOptions& options, BuiltScene& built) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    BodyDef def;
    def.name = body.name;
    def.element = body.element;
    def.guard_stiffness = body.guard_stiffness;
    def.guard_threshold = body.guard_threshold;
    auto mesh = make_mesh(body, scene.folder, built.surfaces.emplace_back());
    if (!mesh) return Error{place("bodies", b) + ".mesh: " + mesh.error()};
    def.mesh = std::move(mesh).value();
    if (auto r = name_places(body, scene.folder, def.mesh); !r)
      return Error{place("bodies", b) + "." + r.error()};
    for (std::size_t m = 0; m < body.materials.size(); ++m) {
      auto material = make_material(body.materials[m], scene.folder);
      if (!material) return Error{place("bodies", b) + "." + place("materials", m) + ": " + material.error()};
      def.materials.push_back(
          {body.materials[m].region, std::move(material).value(), body.materials[m].density});
    }
    if (options.parts) options.parts->bodies.push_back(def);
    auto id = built.world.add_body(std::move(def));
    if (!id) return Error{id.error()};
    built.bodies.push_back(id.value());
  }
  return {};
}

Result<void> add_effects(const SceneDef& scene, const BuildOptions& options, BuiltScene& built) {
  EffectAdder adder(scene, options.parts, built);
  for (const EffectKind* kind : kinds_by_phase()) {
    if (auto r = kind->add(*kind, adder); !r) return r;
  }
  return {};
}

// What is watched of meshes: nodes that have a rotation, regions that there are.
Result<void> check_watched(const SceneDef& scene, const BuiltScene& built) {
  for (std::size_t i = 0; i < scene.orientations.size(); ++i) {
    if (const auto r = built.world.orientation(scene.orientations[i].where); !r)
      return Error{place("orientations", i) + ".where: " + r.error()};
  }
  for (std::size_t i = 0; i < scene.metrics.size(); ++i) {
    const MetricDef& m = scene.metrics[i];
    const bool of_part = m.quantity == Quantity::volume_change || m.quantity == Quantity::volume ||
                         m.quantity == Quantity::min_J || m.quantity == Quantity::max_J;
    if (!of_part || m.of.empty()) continue;
    std::string known;
    bool found = false;
    for (const VolumeMeasures& part : volume_parts(built)) {
      found = found || part.name == m.of;
      known += (known.empty() ? "\"" : ", \"") + part.name + "\"";
    }
    if (!found)
      return Error{place("metrics", i) + ".of = \"" + m.of + "\" names no body or region; there are " +
                   known};
  }
  return {};
}

// How bodies move at the start.
Result<void> set_motion(const SceneDef& scene, BuiltScene& built) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Vec3 v = scene.bodies[b].velocity, w = scene.bodies[b].angular_velocity;
    if (v == Vec3{} && w == Vec3{}) continue;
    const Vec3 center = built.world.measures(built.bodies[b]).center_of_mass;
    std::vector<Vec3> all;
    for (const Vec3& x : built.world.rest_positions(built.bodies[b])) all.push_back(v + cross(w, x - center));
    if (auto r = built.world.set_velocities(built.bodies[b], all); !r) return r;
  }
  return {};
}

}  // namespace

Result<BuiltScene> build(const SceneDef& scene, const BuildOptions& options) {
  if (auto r = check_scene(scene); !r) return Error{r.error()};
  WorldOptions world_options = scene.analysis.options;
  world_options.scheme = make_scheme(scene.analysis);
  world_options.threads = options.threads;
  auto world = World::create(std::move(world_options));
  if (!world) return Error{world.error()};
  BuiltScene built{std::move(world).value()};
  if (auto r = add_bodies(scene, options, built); !r) return Error{r.error()};
  if (auto r = add_effects(scene, options, built); !r) return Error{r.error()};
  if (auto r = built.world.compile(); !r) return Error{r.error()};
  if (auto r = check_watched(scene, built); !r) return Error{r.error()};
  if (auto r = set_motion(scene, built); !r) return Error{r.error()};
  return built;
}

}  // namespace isochor
