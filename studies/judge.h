// What must hold of every state that a step is said to have reached, whatever led there. Nothing here asks
// the engine whether it is content: deformations are computed again from positions and the mesh at rest.
//
// The torture suite and chaos ask the same questions.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "isochor/world.h"

namespace isochor::studies {

// What a body's laws and rows leave no room for, one flag a region of its mesh.
struct BodyPromise {
  BodyId body{};
  Element element = Element::tet4_edge_smoothed;
  std::vector<bool> law_needs_J;   // the energy has no value at J <= 0
  std::vector<bool> cell_needs_J;  // of single cells: a guard, or volume rows of log J
};

// The deformation of a body, as the judge finds it.
struct JudgedShape {
  double min_law_J = 1;          // over points where the energy is evaluated
  double min_J = 1;              // over points of cells
  std::int64_t inverted = 0;     // cells with J < 0 somewhere, beyond the rounding of J
  std::int64_t flat = 0;         // other cells, with a J that rounding does not tell from 0 somewhere
  std::int64_t forbidden = 0;    // points of energies, guards and rows where J > 0 was promised and J < 0
  std::int64_t first_cell = -1;  // of those that are inverted
  double volume = 0, rest_volume = 0;  // [m^3]
  double log_volume = 0;               // integral of log J over the rest [m^3]; NaN where J <= 0
};

// Why a state is wrong: one word to count by, and a sentence.
struct Finding {
  std::string kind, text;
};

struct JudgeLimits {
  double rows = 1e-8;  // residual of rows, relative to their measure
};

class StateJudge {
 public:
  StateJudge(const World& world, std::vector<BodyPromise> promises);

  JudgedShape shape(const World& world, std::size_t body) const;
  // Of any state, however it came about: every number that a host can read is finite, and what is a size is
  // not negative.
  std::optional<Finding> numbers(const World& world) const;
  // The same of positions and velocities alone.
  std::optional<Finding> finite(const World& world) const;
  // Of a state that a step converged to. `said` are the warnings so far: where cells are inverted and the law
  // lives through that, one of them must say so.
  std::optional<Finding> accepted(const World& world, std::span<const std::string> said,
                                  const JudgeLimits& limits) const;
  // The warning that tells about inverted cells, or null.
  static const std::string* tells_inversion(std::span<const std::string> said);

 private:
  // F = sum over nodes of x (x) gradient.
  struct Points {
    std::vector<std::size_t> begin;
    std::vector<Index> node;
    std::vector<Vec3> gradient;
    std::vector<double> weight;
    std::vector<Index> cell;
    std::vector<bool> needs_J;
    std::size_t size() const { return weight.size(); }
  };
  struct Body {
    BodyPromise promise;
    Points cells;    // points of cells
    Points patches;  // where an edge-smoothed body has its energy; else empty
  };
  static Points cell_points(const Mesh& mesh, std::span<const Vec3> rest, const BodyPromise& promise);
  static Points edge_patches(const Mesh& mesh, const Points& tets, const BodyPromise& promise);
  // J, and how far rounding may put it from what another order of the same sums gives.
  struct Determinant {
    double J = 1, rounding = 0;
    bool negative() const { return !(J >= -rounding); }
    bool flat() const { return !negative() && J <= rounding; }
  };
  static Determinant determinant(const Points& points, std::size_t point, std::span<const Vec3> x);

  std::vector<Body> bodies_;
};

// The promise of a body of one law; `lives_through_inversion`: its energy has a value at any J.
BodyPromise simple_promise(const World& world, BodyId body, Element element, bool lives_through_inversion,
                           bool guarded);

}  // namespace isochor::studies
