// The torture suite: hard cases, each asked the same question: does it end at a solution, or say truthfully
// that it does not? Studies run the whole matrix, tests a sample of it.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "isochor/world.h"

namespace isochor::studies {

struct TortureSettings {
  double poisson = 0.5;
  double step = 0;  // [s]; 0: statics
  double load = 1;  // multiple of what the case calls for
  Element element = Element::tet4_edge_smoothed;
  bool one_field = false;  // no volume rows; Poisson's ratio below 0.5
  Method method = Method::automatic;
  SchemePtr scheme;   // of dynamics; empty: implicit Euler
  unsigned seed = 0;  // moves the nodes of the mesh a little; 0: not at all
};

enum class TortureVerdict {
  solved,   // balanced within the tolerances and right in every check of the case
  told,     // no equilibrium exists, or the case refuses these settings, and the engine said so
  stopped,  // an equilibrium should exist; the engine reported that it found none, the state is the last one
  broken,   // a number that is not finite, a wrong state called converged, a rejected step that left traces
};
std::string_view to_string(TortureVerdict verdict);

struct TortureResult {
  TortureVerdict verdict = TortureVerdict::broken;
  std::string reason;
  int steps = 0, iterations = 0, cutbacks = 0, shifted = 0, projected = 0, rescues = 0, stand_ins = 0;
  double volume_row_residual = 0, min_J = 0, seconds = 0;
  double drift = 0;    // of the quantity that the case watches, relative; 0 where it watches none
  double reached = 1;  // part of the load, or of the time
};

struct TortureCase {
  std::string_view name, title;
  double largest_load = 1;  // of the sweep
  bool dynamic = true, statics = true;
  TortureResult (*run)(const TortureSettings& settings);
  double further_load = 0;  // of the sweep beside 1, 3 and 10; 0: none
  bool large = false;       // its mesh has nodes enough with linear elements
  double longest_step = 1;  // [s] that it makes sense with
};

std::span<const TortureCase> torture_cases();
const TortureCase* find_torture_case(std::string_view name);

}  // namespace isochor::studies
