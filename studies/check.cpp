#include "studies/check.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "studies/run_study.h"

namespace isochor::studies {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kRelative = 1e-6, kAbsolute = 1e-9;
constexpr double kIterationShare = 0.25;
constexpr int kIterationMargin = 3;

std::string text12(double v) {
  return text(v, 12);
}

}  // namespace

std::string expectations_file() {
  return std::string(ISOCHOR_STUDIES_FOLDER) + "/expectations.json";
}

Result<Expectations> read_expectations(const std::string& path) {
  std::ifstream in(path);
  if (!in) return Error{path + " cannot be read; `isochor study --check --update` writes it"};
  const Json j = Json::parse(in, nullptr, false);
  if (j.is_discarded() || !j.is_object())
    return Error{path + " is no JSON object; `isochor study --check --update` writes it anew"};
  Expectations out;
  for (const auto& [id, cell] : j.items()) {
    try {
      out[id] = {cell.at("status").get<std::string>(), cell.at("values").get<Numbers>(),
                 cell.at("iterations").get<int>()};
    } catch (const Json::exception&) {
      return Error{path + ": entry \"" + id + "\" lacks status, values or iterations"};
    }
  }
  return out;
}

std::string expectations_json(const Expectations& expectations) {
  Json j = Json::object();
  for (const auto& [id, e] : expectations)
    j[id] = {{"status", e.status}, {"iterations", e.iterations}, {"values", e.values}};
  return j.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Expectation expectation_of(const Measured& cell) {
  Expectation e{cell.status, {}, 0};
  // How far a run came that does not converge is nothing to hold it to.
  if (!cell.good()) return e;
  e.iterations = cell.iterations;
  for (const auto& [name, value] : cell.values) {
    if (std::isfinite(value)) e.values[name] = value;
  }
  return e;
}

std::vector<std::string> differences(const Expectation& expected, const Expectation& found) {
  std::vector<std::string> out;
  if (expected.status != found.status) {
    out.push_back("status " + found.status + ", expected " + expected.status);
    return out;
  }
  for (const auto& [name, value] : expected.values) {
    const auto it = found.values.find(name);
    if (it == found.values.end()) {
      out.push_back(name + " is missing, expected " + text12(value));
    } else if (!(std::abs(it->second - value) <= kRelative * std::abs(value) + kAbsolute)) {
      out.push_back(name + " = " + text12(it->second) + ", expected " + text12(value));
    }
  }
  for (const auto& [name, value] : found.values) {
    if (!expected.values.contains(name)) out.push_back(name + " = " + text12(value) + " is new");
  }
  const int margin = std::max(kIterationMargin,
                              static_cast<int>(kIterationShare * static_cast<double>(expected.iterations)));
  if (std::abs(found.iterations - expected.iterations) > margin)
    out.push_back(std::to_string(found.iterations) + " iterations, expected " +
                  std::to_string(expected.iterations) + " within " + std::to_string(margin));
  return out;
}

CheckResult check_studies(const Expectations& expected, const CheckOptions& options) {
  CheckResult result;
  for (const Study& study : studies()) {
    for (const Cell& cell : study.cells(true)) {
      if (!cell.guarded) continue;
      const std::string id = std::string(study.name) + "/" + cell.id;
      std::vector<std::string> findings;
      std::string first_hash;
      for (const int threads : options.threads) {
        if (options.stop && options.stop()) {
          result.interrupted = true;
          return result;
        }
        const bool first = threads == options.threads.front();
        // A probe has no state to compare.
        if (!first && (cell.probe || cell.threads > 0)) continue;
        const Measured m = measure(cell, threads, 0, 0, options.stop);
        if (first) {
          first_hash = m.hash;
          result.found[id] = expectation_of(m);
          const auto it = expected.find(id);
          if (it == expected.end())
            findings.push_back("there is no expectation of it");
          else
            findings = differences(it->second, result.found[id]);
        } else if (m.hash != first_hash) {
          findings.push_back("state " + m.hash + " at " + std::to_string(threads) + " threads, " +
                             first_hash + " at " + std::to_string(options.threads.front()));
        }
      }
      ++result.cells;
      if (!findings.empty()) ++result.wrong;
      if (options.on_cell) options.on_cell(id, findings);
    }
  }
  for (const auto& [id, e] : expected) {
    if (result.found.contains(id)) continue;
    ++result.wrong;
    if (options.on_cell) options.on_cell(id, {"is expected, but no study has it"});
  }
  return result;
}

}  // namespace isochor::studies
