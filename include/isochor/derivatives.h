// How an equilibrium answers to small changes.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "isochor/ids.h"
#include "isochor/measures.h"
#include "isochor/types.h"

namespace isochor {

// What is changed: the amount of an effect, or a dead force on a point of a body.
struct ResponseInput {
  EffectId effect{};  // whose amount, where no force is given
  BodyId body{};      // where the force acts, at a point at rest [m]
  Vec3 point{};
  Vec3 force{};  // [N]; its size is the unit of the derivative. Zero: the input is the amount

  static ResponseInput amount_of(EffectId effect) { return {effect, {}, {}, {}}; }
  static ResponseInput force_at(BodyId body, const Vec3& point, const Vec3& force) {
    return {{}, body, point, force};
  }
};

// Derivatives of the equilibrium by one input, per unit of the amount or of the force as it was given.
struct Response {
  std::vector<std::vector<Vec3>> positions;    // of the nodes, by body as in World::bodies()
  std::vector<Gauge> gauges;                   // of World::gauges(): their values are derivatives
  std::vector<std::array<Vec3, 2>> reactions;  // force and moment, by effect as in World::effects()
  // False: a contact or a bounded row is about to close or to open, so that the derivative is that of one
  // side, or friction holds on to what it pulls with. `note` says which.
  bool regular = true;
  std::string note;
  // Directions in which the equilibrium is unstable under fixed loads; -1: the solver cannot tell.
  Index unstable_directions = -1;

  // Position of a node: d x_node / d input.
  Vec3 of_node(std::size_t body, Index node) const { return positions[body][static_cast<std::size_t>(node)]; }
};

}  // namespace isochor
