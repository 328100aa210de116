// What can be read from a world between steps: volumes, energies, orientations, fields.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "isochor/ids.h"
#include "isochor/types.h"

namespace isochor {

// A named number that an effect reports.
struct Gauge {
  std::string effect, kind, quantity, unit;
  double value = 0;
};

struct WorldSize {
  Index nodes = 0, displacement_unknowns = 0, multipliers = 0;
  Index matrix_size = 0;  // displacements and the rows kept in the saddle point
  std::int64_t matrix_nonzeros = 0, factor_nonzeros = 0;
  // Of slots and gather lists, and of tables that clones share with each other [bytes].
  std::size_t engine_bytes = 0, table_bytes = 0;
};

// Volume of a body, or of one of its regions, now and at rest.
struct VolumeMeasures {
  std::string name;                    // of the region, or of the body
  double volume = 0, rest_volume = 0;  // [m^3]
  double min_J = 0, max_J = 0;         // over cells (points of a Tet10)
  // Relative, negative where volume was lost.
  double volume_change() const { return rest_volume > 0 ? volume / rest_volume - 1 : 0; }
};

// What the deformation and the motion of a body look like now.
struct BodyMeasures : VolumeMeasures {
  // What the volume rows of the body leave over, relative to the volume behind them. Compressible bodies may
  // lose volume while it is zero: volume_change() tells what they lost.
  double volume_row_residual = 0;
  double volume_error = 0;              // the same number by its former name
  Vec3 center_of_mass{};                // of the masses at the nodes [m]
  double mass = 0;                      // [kg]
  Vec3 linear_momentum{};               // [kg m/s]
  Vec3 angular_momentum{};              // about the origin [kg m^2/s]
  std::vector<VolumeMeasures> regions;  // in the order of the mesh
};

// A point of a contact that presses. Forces are on the body that the point is of; its partner has the
// opposite.
struct ContactPoint {
  EffectId effect{};
  std::string body, partner;  // of the point and of what it touches: a body, a rigid body or an obstacle
  Index node = -1;            // of the body's mesh, where the point is one of its nodes
  Vec3 position{};            // [m]
  double gap = 0;             // negative within a layer that gives way [m]
  Vec3 normal{};              // away from the partner
  Vec3 normal_force{};        // [N]
  Vec3 friction{};            // [N]
  double area = 0;            // at rest, that it stands for; 0: edges [m^2]
};

// What two partners of all contacts do to each other.
struct ContactPair {
  std::string body, partner;
  Vec3 force{};       // on the body, friction included [N]
  double normal = 0;  // sum of the magnitudes of the normal forces [N]
  Index points = 0;
};

// Energies of the whole scene now. Potentials are those of the loads as they are now, zero at rest positions;
// what loads did on their way there, supports that move, valves, friction and damping do work that is not in
// here.
struct Energies {
  double kinetic = 0;  // [J]
  double elastic = 0;  // elastic_energy() [J]
  double gravity = 0;  // of the weight: -sum m g . (x - X) [J]
  double loads = 0;    // of tractions and point forces: -sum f . (x - X) [J]
  // Of given pressures and tensions, -p (V - V0) and T (L - L0), and of the gas in closed chambers [J].
  double pressures = 0;
  double potential() const { return elastic + gravity + loads + pressures; }
  double total() const { return kinetic + potential(); }
};

// How a set of nodes has turned and moved since rest: the rigid motion that fits it best.
struct Orientation {
  double angle = 0;     // [rad], 0 to pi: more than half a turn reads as the rest of it the other way round
  Vec3 axis{};          // unit vector of the turn, by the right hand; zero for no turn
  Vec3 displacement{};  // of the middle of the set [m]
  // Unit vector. Surfaces: the mean normal of their faces now. Other sets: the direction in which they are
  // flattest at rest, away from the body, turned with them. Zero for what has no direction: closed surfaces,
  // and sets that are more than 0.7 times as thick as they are wide.
  Vec3 normal{};
  double misfit = 0;  // root mean square distance from the shape at rest moved rigidly [m]
};

// Per-node and per-cell results of a body, recovered for output.
struct BodyFields {
  std::vector<double> node_pressure;  // tr(sigma)/3 [Pa], tension positive
  std::vector<double> node_stress;    // Cauchy stress xx yy zz xy yz zx [Pa], 6 a node
  std::vector<double> cell_J;
  std::vector<double> cell_pressure;   // tr(sigma)/3 [Pa]
  std::vector<double> cell_von_mises;  // [Pa]
  std::vector<double> cell_stress;     // Cauchy stress xx yy zz xy yz zx [Pa], 6 a cell
  std::vector<double> cell_max_stretch;
  // Normal and tangential force of contact on the body over the area at rest that a node stands for [Pa], the
  // latter as x y z; zero where nothing touches. Empty: no contact of the scene is about this body.
  std::vector<double> node_contact_pressure;
  std::vector<double> node_friction;
};

}  // namespace isochor
