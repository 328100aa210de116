// Every material and every effect of the engine, with what its contract test needs. A source file of
// materials/ or constraints/ that no case covers fails contract.completeness: add a case here.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/elements/material.h"
#include "isochor/effects.h"
#include "support/hyper_dual.h"

namespace test {

// An energy density written for numbers of any kind, independently of the engine's own formula.
using EnergyFormula = std::function<HyperDual(const std::array<HyperDual, 9>& F)>;

struct MaterialCase {
  std::string name;
  std::vector<std::string> covers;  // "materials/neo_hookean"
  std::shared_ptr<const isochor::Material> material;
  EnergyFormula energy;
  double scale = 1;         // stiffness that errors are measured against [Pa]
  double largest_J = 4;     // samples keep to J in (0, largest_J)
  bool inverted = false;    // has a value for J <= 0
  bool stress_free = true;  // P = 0 at F = 1
  bool objective = true;    // does not see rotations in space
  bool isotropic = true;    // does not see rotations of the material
};
std::vector<MaterialCase> material_cases();
// Of the material cases: what is added to a material (registry_additions.cpp).
void add_material_additions(std::vector<MaterialCase>& out);

// Materials by their public functions, for what they promise at small strain.
struct ModelCase {
  std::string name;
  std::vector<std::string> covers;
  std::function<isochor::Result<isochor::MaterialPtr>(const isochor::ElasticConstants&)> make;
  bool elastic_constants = true;  // false: `make` turns E and nu into constants of the material's own
};
std::vector<ModelCase> model_cases();

// A small scene in which an effect's pools and rows come to life. The contract is held by every stencil pool,
// row pool, support and load that the scene is compiled into.
struct SceneCase {
  std::string name;
  std::vector<std::string> covers;
  isochor::Mesh mesh;
  isochor::Element element = isochor::Element::tet4;
  std::vector<isochor::RegionMaterial> materials;
  std::vector<isochor::EffectPtr> effects;
  double stretch = 1;           // of the deformed sample, on top of its waves
  bool stress_free = true;      // no force and zero rows at rest with zero multipliers
  bool rigid_invariant = true;  // the potential does not see rigid motions
  bool own_scale = false;  // metrics of rows are by constants of the author, not by the modulus of a body
  bool numbered_cells = false;  // has a field by cell number: renumbering cells makes another scene
  // Further bodies beside the first, of its element and materials.
  std::vector<isochor::Mesh> more_bodies = {};
};
std::vector<SceneCase> scene_cases();
// Of the scene cases: what attaches, pulls and fills bodies (registry_attachments.cpp).
void add_attachments(std::vector<SceneCase>& out);

// Thin bodies and layers that bend (registry_shells.cpp).
void add_shells(std::vector<SceneCase>& out);

// What solids do by themselves, springs, equations, given motion that is not rigid (registry_active.cpp).
void add_active(std::vector<SceneCase>& out);

// The worked example of docs/adding-a-constraint.md (registry_example.cpp).
void add_worked_example(std::vector<SceneCase>& out);

}  // namespace test
