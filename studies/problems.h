// Problems with a known answer, on several meshes.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "scenes/library.h"
#include "studies/formulations.h"
#include "studies/study.h"

namespace isochor::studies {

// A mesh of scenes/meshes by name, or the divisions of a box.
using LevelMesh = std::variant<std::string_view, std::array<int, 3>>;

struct Problem {
  std::string_view name, title;
  SceneDef (*make)(const SceneVariant&);
  std::string_view metric;  // of the scene
  double reference = 0;
  double uncertainty = 0;  // of the reference, relative
  std::string_view source;
  std::vector<LevelMesh> linear, quadratic;  // coarse to fine, for Tet4 and Tet10
  // For Hex8; empty: the formulations on hexahedra are left out. Boxes take the meshes of the Tet4.
  std::vector<LevelMesh> hexahedra = {};
  int dimension = 3;     // 2: a slab one element thick, refined in its plane
  double nu = 0.5;       // of the scene
  bool dynamic = false;  // a motion: the time step adds an error of its own
  // Meshes of the Tet4 without smoothing, which need finer ones; after those of `linear`.
  std::vector<LevelMesh> finer = {};
  int few_steps = 1;  // steps (of load or time) that are enough for a percent
};

std::span<const Problem> problems();
const Problem& problem(std::string_view name);  // must exist

std::vector<LevelMesh> meshes(const Problem& p, const Formulation& f);
std::size_t level_count(const Problem& p, const Formulation& f);
// The problem on one of its meshes; `level` starts at 0, the coarsest.
SceneDef make_scene(const Problem& p, const Formulation& f, std::size_t level);

// The same as a cell with the problem's metric and reference, labeled with problem, formulation and mesh.
Cell problem_cell(const Problem& p, const Formulation& f, std::size_t level);

}  // namespace isochor::studies
