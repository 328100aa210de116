// Words of a scene file for the values of enumerations: one table each for reading, writing and the schema.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "scenes/scene.h"

namespace isochor::scene_json {

template <class E>
struct Words;  // specialized below: `static constexpr std::array<std::pair<E, std::string_view>, n> list`

#define ISOCHOR_WORDS(E, N, ...)                                                        \
  template <>                                                                           \
  struct Words<E> {                                                                     \
    static constexpr std::array<std::pair<E, std::string_view>, N> list{{__VA_ARGS__}}; \
  }

ISOCHOR_WORDS(Element, 4, {Element::tet4, "tet4"}, {Element::tet4_edge_smoothed, "tet4_edge_smoothed"},
              {Element::tet10, "tet10"}, {Element::hex8, "hex8"});
ISOCHOR_WORDS(CellType, 3, {CellType::tet4, "tet4"}, {CellType::tet10, "tet10"}, {CellType::hex8, "hex8"});
ISOCHOR_WORDS(MaterialLaw, 15, {MaterialLaw::neo_hookean, "neo_hookean"},
              {MaterialLaw::neo_hookean_ogden, "neo_hookean_ogden"},
              {MaterialLaw::stable_neo_hookean, "stable_neo_hookean"},
              {MaterialLaw::stable_neo_hookean_barrier, "stable_neo_hookean_barrier"},
              {MaterialLaw::isochoric_neo_hookean, "isochoric_neo_hookean"},
              {MaterialLaw::isochoric_extended, "isochoric_extended"}, {MaterialLaw::corotated, "corotated"},
              {MaterialLaw::fixed_corotated, "fixed_corotated"}, {MaterialLaw::stvk, "stvk"},
              {MaterialLaw::stvk_resistant, "stvk_resistant"}, {MaterialLaw::linear, "linear"},
              {MaterialLaw::mooney_rivlin, "mooney_rivlin"}, {MaterialLaw::fung, "fung"},
              {MaterialLaw::arruda_boyce, "arruda_boyce"}, {MaterialLaw::ogden, "ogden"});
ISOCHOR_WORDS(BulkChoice, 2, {BulkChoice::consistent, "consistent"},
              {BulkChoice::bulk_modulus, "bulk_modulus"});
ISOCHOR_WORDS(VolumeStrain, 2, {VolumeStrain::linear, "linear"}, {VolumeStrain::logarithmic, "logarithmic"});
ISOCHOR_WORDS(UnpaintedCells, 2, {UnpaintedCells::none, "none"}, {UnpaintedCells::nearest, "nearest"});
ISOCHOR_WORDS(RowTreatment, 6, {RowTreatment::automatic, "automatic"}, {RowTreatment::saddle, "saddle"},
              {RowTreatment::condensed, "condensed"}, {RowTreatment::bordered, "bordered"},
              {RowTreatment::dual, "dual"}, {RowTreatment::augmented, "augmented"});
ISOCHOR_WORDS(SchemeWord, 5, {SchemeWord::implicit_euler, "implicit_euler"}, {SchemeWord::bdf2, "bdf2"},
              {SchemeWord::generalized_alpha, "generalized_alpha"}, {SchemeWord::newmark, "newmark"},
              {SchemeWord::implicit_midpoint, "implicit_midpoint"});
ISOCHOR_WORDS(Method, 8, {Method::automatic, "automatic"}, {Method::saddle_point, "saddle_point"},
              {Method::condensation, "condensation"}, {Method::dual_gradients, "dual_gradients"},
              {Method::augmented_gradients, "augmented_gradients"}, {Method::dual_ascent, "dual_ascent"},
              {Method::augmented_ascent, "augmented_ascent"}, {Method::position_based, "position_based"});
ISOCHOR_WORDS(CavityControl, 5, {CavityControl::pressure, "pressure"}, {CavityControl::volume, "volume"},
              {CavityControl::volume_ratio, "volume_ratio"}, {CavityControl::gas, "gas"},
              {CavityControl::liquid, "liquid"});
ISOCHOR_WORDS(SupportTreatment, 3, {SupportTreatment::eliminated, "eliminated"},
              {SupportTreatment::multiplier, "multiplier"}, {SupportTreatment::stiffness, "stiffness"});
ISOCHOR_WORDS(CableControl, 3, {CableControl::tension, "tension"}, {CableControl::length, "length"},
              {CableControl::length_ratio, "length_ratio"});
ISOCHOR_WORDS(AnalysisType, 2, {AnalysisType::statics, "static"}, {AnalysisType::dynamics, "dynamic"});
ISOCHOR_WORDS(Definiteness, 3, {Definiteness::exact, "exact"}, {Definiteness::projected, "projected"},
              {Definiteness::absolute, "absolute"});
ISOCHOR_WORDS(Solver, 7, {Solver::automatic, "automatic"}, {Solver::mumps, "mumps"},
              {Solver::cholmod, "cholmod"}, {Solver::eigen, "eigen"}, {Solver::iterative, "iterative"},
              {Solver::multifrontal, "multifrontal"}, {Solver::cholmod_supernodal, "cholmod_supernodal"});
ISOCHOR_WORDS(Component, 4, {Component::magnitude, "magnitude"}, {Component::x, "x"}, {Component::y, "y"},
              {Component::z, "z"});
ISOCHOR_WORDS(ObstacleShape, 7, {ObstacleShape::plane, "plane"}, {ObstacleShape::sphere, "sphere"},
              {ObstacleShape::capsule, "capsule"}, {ObstacleShape::cylinder, "cylinder"},
              {ObstacleShape::box, "box"}, {ObstacleShape::mesh, "mesh"},
              {ObstacleShape::distance_field, "distance_field"});
ISOCHOR_WORDS(FrictionCoupling, 2, {FrictionCoupling::lagged, "lagged"},
              {FrictionCoupling::coupled, "coupled"});
ISOCHOR_WORDS(InitialOverlap, 2, {InitialOverlap::report, "report"}, {InitialOverlap::resolve, "resolve"});
ISOCHOR_WORDS(
    Quantity, 33, {Quantity::displacement, "displacement"}, {Quantity::cavity_pressure, "cavity_pressure"},
    {Quantity::cavity_volume, "cavity_volume"}, {Quantity::cable_tension, "cable_tension"},
    {Quantity::cable_length, "cable_length"}, {Quantity::rigid_x, "rigid_x"}, {Quantity::rigid_y, "rigid_y"},
    {Quantity::rigid_z, "rigid_z"}, {Quantity::contact_force, "contact_force"},
    {Quantity::contact_area, "contact_area"}, {Quantity::contact_pressure, "contact_pressure"},
    {Quantity::contact_gap, "contact_gap"}, {Quantity::reaction_force, "reaction_force"},
    {Quantity::reaction_moment, "reaction_moment"}, {Quantity::orientation_angle, "orientation_angle"},
    {Quantity::orientation_axis, "orientation_axis"}, {Quantity::orientation_normal, "orientation_normal"},
    {Quantity::volume_row_residual, "volume_row_residual"},
    {Quantity::volume_row_residual, "volume_error"},  // its former name, which scenes may still have
    {Quantity::volume_change, "volume_change"}, {Quantity::volume, "volume"},
    {Quantity::constitutive_residual, "constitutive_residual"}, {Quantity::min_J, "min_J"},
    {Quantity::max_J, "max_J"}, {Quantity::elastic_energy, "elastic_energy"},
    {Quantity::kinetic_energy, "kinetic_energy"}, {Quantity::gravity_potential, "gravity_potential"},
    {Quantity::load_potential, "load_potential"}, {Quantity::potential_energy, "potential_energy"},
    {Quantity::total_energy, "total_energy"}, {Quantity::linear_momentum, "linear_momentum"},
    {Quantity::angular_momentum, "angular_momentum"}, {Quantity::newton_iterations, "newton_iterations"});

// "none" stands beside the spaces of the engine: no rows at all.
enum class VolumeSpaceWord : std::uint8_t { node, element, body, ring, zone, none };
ISOCHOR_WORDS(VolumeSpaceWord, 6, {VolumeSpaceWord::node, "node"}, {VolumeSpaceWord::element, "element"},
              {VolumeSpaceWord::body, "body"}, {VolumeSpaceWord::ring, "ring"},
              {VolumeSpaceWord::zone, "zone"}, {VolumeSpaceWord::none, "none"});

#undef ISOCHOR_WORDS

}  // namespace isochor::scene_json
