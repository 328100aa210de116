// What diagrams and tables are made of: fronts, orders, profiles, costs.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "studies/study.h"

namespace isochor::studies {

// Indices of the points that no other beats in both coordinates (less is better), by ascending cost.
std::vector<std::size_t> pareto_front(std::span<const double> cost, std::span<const double> error);

// Order of convergence in the mesh size between two meshes that are refined in `dimension` directions: the
// slope of log error against log unknowns times -dimension. Empty where an error is not positive or the
// unknowns do not grow.
std::optional<double> observed_order(double unknowns_a, double error_a, double unknowns_b, double error_b,
                                     double dimension);

// Performance profile (Dolan & Moré 2002): for each solver the share of problems that it solves within a
// factor of the best. `costs[s][p]` of solver s on problem p; NaN: not solved. A problem that nobody solves
// is left out.
struct Profile {
  std::vector<double> factor, share;  // a staircase: ascending factors
};
std::vector<Profile> performance_profiles(const std::vector<std::vector<double>>& costs);

// What a cell cost [s]: wall time, or processor time of all threads, which a busy machine does not stretch.
using Cost = double (*)(const Measured&);
double wall_seconds(const Measured& m);
double processor_seconds(const Measured& m);

// Cells whose error is at most `error` and stays there on every finer mesh of their formulation: a coarse
// mesh may be right by luck, where errors of two kinds cancel. And those that miss it.
std::vector<const Measured*> lasting(std::span<const Measured* const> cells, double error);

// The cheapest cell whose error is at most `error`; null where none is.
const Measured* cheapest(std::span<const Measured* const> cells, double error, Cost cost = wall_seconds);

// Seconds at which the straight line in log-log through a method's cells crosses `error`, between two of its
// cells or at one; empty where they do not reach it. What a table says when meshes are few.
std::optional<double> seconds_at(std::span<const Measured* const> cells, double error,
                                 Cost cost = wall_seconds);

// Where a method does not reach the error: the line through its two finest meshes, drawn on. A guess, for
// comparisons that say so; empty where the error does not shrink from the one to the other.
std::optional<double> extrapolated_seconds(std::span<const Measured* const> cells, double error,
                                           Cost cost = wall_seconds);

// Helpers to select. Pointers live as long as the list.
using Cells = std::vector<const Measured*>;
Cells where(std::span<const Measured> cells, const std::string& key, const std::string& value);
Cells where(const Cells& cells, const std::string& key, const std::string& value);
// Values of a label in order of first appearance.
std::vector<std::string> label_values(std::span<const Measured> cells, const std::string& key);

// The last section of every study: each cell with what it took, failures in red with their reason.
Section all_cells(std::span<const Measured> cells);

std::string percent(double fraction, int digits = 2);

}  // namespace isochor::studies
