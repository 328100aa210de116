// The regression guard: guarded cells of all studies against committed expectations. Errors, values and
// iteration counts, never seconds; and the same bits at several thread counts.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "studies/study.h"

namespace isochor::studies {

struct Expectation {
  std::string status;
  Numbers values;
  int iterations = 0;
};
using Expectations = std::map<std::string, Expectation>;  // by "study/cell"

// Where the committed ones are.
std::string expectations_file();
Result<Expectations> read_expectations(const std::string& path);
std::string expectations_json(const Expectations& expectations);

Expectation expectation_of(const Measured& cell);
// What differs beyond tolerance, a sentence each. Values: a millionth, or 1e-9 in absolute terms; iterations:
// a quarter, at least 3; the status exactly.
std::vector<std::string> differences(const Expectation& expected, const Expectation& found);

struct CheckOptions {
  std::vector<int> threads{1, 2};
  std::function<bool()> stop;
  // After each cell, with what was wrong with it.
  std::function<void(const std::string& id, const std::vector<std::string>& findings)> on_cell;
};
struct CheckResult {
  bool interrupted = false;
  std::size_t cells = 0, wrong = 0;
  Expectations found;
};
// Measures all guarded cells at quick size and compares.
CheckResult check_studies(const Expectations& expected, const CheckOptions& options);

}  // namespace isochor::studies
