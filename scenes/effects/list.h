// The effects of a scene: one list each, and one entry each in the table that reader, writer, schema, docs,
// checks, build() and --explain go through. A new effect has a file of its own beside this one, and its three
// lines here.
#pragma once

#include <optional>
#include <vector>

#include "isochor/effects.h"
#include "scenes/effects/volume_rows.h"

namespace isochor {

// They name their body by its place in SceneDef::bodies.
struct SceneEffects {
  // Absent: nodal rows on every body. Bodies that a list leaves out have the complete one-field energy.
  std::optional<std::vector<VolumeRows>> volumes;
  // Bones of supports are read from PoseTrack::file when they have no keyframes.
  std::vector<DirichletDef> dirichlet;
  // Frames are read from DrivenDef::file when there are none.
  std::vector<DrivenDef> driven;
  std::vector<SkinDef> skins;
  std::vector<LinearConstraintDef> linear_constraints;
  std::vector<CavityDef> cavities;
  std::vector<TractionDef> tractions;
  std::vector<PressureDef> pressures;
  std::vector<PointForceDef> forces;
  std::vector<DampingDef> damping;
  std::vector<MuscleDef> muscles;
  std::vector<GrowthDef> growth;
  std::vector<EpidermisDef> epidermis;
  std::vector<MembraneDef> membranes;
  std::vector<ShellDef> shells;
  std::vector<TieDef> ties;
  std::vector<CableDef> cables;
  std::vector<WindingDef> windings;
  std::vector<SpringDef> springs;
  std::vector<StrainLimitDef> layers;
  std::vector<ValveDef> valves;
  std::vector<RigidBodyDef> rigid_bodies;
  std::vector<ContactDef> contacts;
  std::vector<SurfaceContactDef> surface_contacts;
};

struct EffectKind;
extern const EffectKind volumes_kind, dirichlet_kind, driven_kind, skins_kind, linear_constraints_kind,
    cavities_kind, tractions_kind, pressures_kind, forces_kind, damping_kind, muscles_kind, growth_kind,
    epidermis_kind, membranes_kind, shells_kind, ties_kind, cables_kind, windings_kind, springs_kind,
    layers_kind, valves_kind, rigid_bodies_kind, contacts_kind, surface_contacts_kind;

// In the order in which a scene file has them.
inline constexpr const EffectKind* effect_kinds[] = {
    &volumes_kind,  &dirichlet_kind,    &driven_kind,    &skins_kind,           &linear_constraints_kind,
    &cavities_kind, &tractions_kind,    &pressures_kind, &forces_kind,          &damping_kind,
    &muscles_kind,  &growth_kind,       &epidermis_kind, &membranes_kind,       &shells_kind,
    &ties_kind,     &cables_kind,       &windings_kind,  &springs_kind,         &layers_kind,
    &valves_kind,   &rigid_bodies_kind, &contacts_kind,  &surface_contacts_kind};

}  // namespace isochor
