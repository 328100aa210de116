#include "studies/problems.h"

#include <algorithm>

#include "studies/problem_scenes.h"

namespace isochor::studies {

namespace {

constexpr std::string_view kTaylorHood =
    "Taylor-Hood (dolfinx 0.5.2, deal.II 9.4), extrapolated; docs/reference.md";
constexpr std::string_view kClosedForm = "closed form; docs/reference.md";
constexpr std::string_view kFinest =
    "our own finest mesh, Tet10 with linear pressure, extrapolated: isochor study references";

const std::vector<Problem> kProblems{
    {"cantilever",
     "Cantilever, a tenth of gravity",
     cantilever_tenth,
     "tip down",
     -0.4763,
     1e-4 / 0.4763,
     kTaylorHood,
     {std::array{10, 1, 1}, std::array{20, 2, 2}, std::array{30, 3, 3}, std::array{40, 4, 4},
      std::array{60, 6, 6}},
     {std::array{5, 1, 1}, std::array{10, 1, 1}, std::array{20, 2, 2}, std::array{30, 3, 3}},
     {},
     3,
     0.5,
     false,
     {std::array{80, 8, 8}}},
    {"cook",
     "Cook's membrane, 3D",
     cook,
     "edge middle up",
     8.510,
     0.0015 / 8.510,
     kTaylorHood,
     {"cook3d_1", "cook3d_2", "cook3d_3"},
     {"cook3d_coarse_tet10", "cook3d_1_tet10", "cook3d_2_tet10"},
     {"cook3d_1_hex", "cook3d_2_hex", "cook3d_3_hex"}},
    {"cook_plane",
     "Cook's membrane, plane strain",
     cook_plane,
     "edge middle up",
     6.962,
     0.001 / 6.962,
     kTaylorHood,
     {"cook_plane_grid_1", "cook_plane_grid_2", "cook_plane_1", "cook_plane_2"},
     {"cook_plane_tet10"},
     {"cook_plane_1_hex", "cook_plane_2_hex"},
     2},
    {"thick_tube",
     "Thick tube, volume given",
     thick_tube_volume,
     "pressure at stretch 2",
     0.5740535723065197,
     0,
     kClosedForm,
     {"thick_tube_coarse", "thick_tube_1", "thick_tube"},
     {"thick_tube_coarse_tet10", "thick_tube_1_tet10", "thick_tube_tet10"},
     {"thick_tube_coarse_hex", "thick_tube_1_hex", "thick_tube_2_hex"},
     2,
     0.5,
     false,
     {},
     3},
    {"thick_sphere",
     "Thick sphere, volume given",
     thick_sphere_volume,
     "pressure at stretch 2",
     0.8069266031066276,
     0,
     kClosedForm,
     {"thick_sphere_coarse", "thick_sphere_1", "thick_sphere"},
     {"thick_sphere_coarse_tet10", "thick_sphere_1_tet10", "thick_sphere_tet10"},
     {"thick_sphere_coarse_hex", "thick_sphere_1_hex", "thick_sphere_2_hex"},
     3,
     0.5,
     false,
     {},
     3},
    {"torsion",
     "Torsion of a cylinder",
     torsion,
     "torque",
     1.570796326794897,
     0,
     kClosedForm,
     {"torsion_cylinder_coarse", "torsion_cylinder_1", "torsion_cylinder"},
     {"torsion_cylinder_coarse_tet10", "torsion_cylinder_1_tet10", "torsion_cylinder_tet10"},
     {"torsion_cylinder_1_hex", "torsion_cylinder_2_hex"},
     3,
     0.5,
     false,
     {},
     2},
    {"block",
     "Compressed block",
     compressed_block,
     "top down",
     -0.03336,
     3e-3,
     kFinest,
     {std::array{2, 2, 4}, std::array{4, 4, 8}, std::array{8, 8, 16}, std::array{12, 12, 24}},
     {std::array{1, 1, 2}, std::array{2, 2, 4}, std::array{4, 4, 8}, std::array{6, 6, 12}},
     {},
     3,
     0.4999},
    {"cushion",
     "Inflated cushion",
     cushion,
     "rise of the top",
     0.01883,
     3e-3,
     kFinest,
     {"cushion_1", "cushion", "cushion_3"},
     {"cushion_1", "cushion", "cushion_2_tet10"},
     {},
     3,
     0.499,
     false,
     {},
     5},
    {"swing",
     "Swing of a beam",
     swing,
     "tip down",
     -0.3250,
     5e-4,
     kFinest,
     {std::array{10, 1, 1}, std::array{20, 2, 2}, std::array{40, 4, 4}},
     {std::array{5, 1, 1}, std::array{10, 1, 1}, std::array{20, 2, 2}},
     {},
     3,
     0.5,
     true,
     {},
     16},
};

}  // namespace

std::span<const Problem> problems() {
  return kProblems;
}

const Problem& problem(std::string_view name) {
  const auto all = problems();
  const auto it = std::find_if(all.begin(), all.end(), [&](const Problem& p) { return p.name == name; });
  return it == all.end() ? all.front() : *it;
}

std::vector<LevelMesh> meshes(const Problem& p, const Formulation& f) {
  if (f.quadratic()) return p.quadratic;
  const bool boxes = std::holds_alternative<std::array<int, 3>>(p.linear.front());
  if (f.hexahedra() && !boxes) return p.hexahedra;
  std::vector<LevelMesh> all = p.linear;
  if (f.element == Element::tet4) all.insert(all.end(), p.finer.begin(), p.finer.end());
  return all;
}

std::size_t level_count(const Problem& p, const Formulation& f) {
  return meshes(p, f).size();
}

SceneDef make_scene(const Problem& p, const Formulation& f, std::size_t level) {
  const LevelMesh mesh = meshes(p, f)[level];
  SceneVariant variant;
  if (const auto* name = std::get_if<std::string_view>(&mesh)) variant.mesh = *name;
  variant.element = f.element;
  SceneDef scene = p.make(variant);
  if (const auto* divisions = std::get_if<std::array<int, 3>>(&mesh)) {
    if (auto* box = std::get_if<BoxMeshDef>(&scene.bodies[0].mesh)) box->divisions = *divisions;
  }
  apply(f, scene);
  return scene;
}

Cell problem_cell(const Problem& p, const Formulation& f, std::size_t level) {
  Cell c;
  c.id = std::string(p.name) + "/" + std::string(f.name) + "/" + std::to_string(level + 1);
  c.labels = {{"problem", std::string(p.title)},
              {"formulation", std::string(f.label)},
              {"mesh", std::to_string(level + 1)}};
  c.knobs["dimension"] = p.dimension;
  c.knobs["nu"] = p.nu >= 0.5 ? f.most_poisson : p.nu;
  c.scene = make_scene(p, f, level);
  c.metric = std::string(p.metric);
  c.reference = p.reference;
  c.uncertainty = p.uncertainty;
  c.source = std::string(p.source);
  return c;
}

}  // namespace isochor::studies
