#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "scenes/run/accuracy.h"
#include "scenes/run/error_search.h"
#include "scenes/run/run.h"

namespace isochor {

namespace {

using Json = nlohmann::ordered_json;

Json list_of(const Vec3& v) {
  return Json::array({v.x, v.y, v.z});
}

Json stages(const StageSeconds& t) {
  return {{"analyze", t.analyze}, {"evaluate", t.evaluate},       {"gather", t.gather}, {"factor", t.factor},
          {"solve", t.solve},     {"line_search", t.line_search}, {"total", t.total}};
}

Json metric(const MetricValue& m) {
  Json j{{"name", m.def.name}, {"value", m.value}, {"unit", m.def.unit}};
  if (!m.reached) j["reached"] = false;
  if (m.def.reference) j["reference"] = *m.def.reference;
  if (m.error) j["error"] = *m.error;
  if (m.def.tolerance) j["tolerance"] = *m.def.tolerance;
  if (m.within) j["within_tolerance"] = *m.within;
  if (!m.def.source.empty()) j["source"] = m.def.source;
  return j;
}

// What the last state of the run looks like.
void add_state(Json& j, const RunResult& r) {
  const StepRecord& end = r.records.back();
  j["time"] = end.time;
  j["volume_row_residual"] = end.volume_row_residual;
  j["volume_change"] = end.total.volume_change();
  j["constitutive_residual"] = end.constitutive_residual;
  j["min_J"] = end.min_J;
  j["max_J"] = end.max_J;
  j["inverted_cells"] = end.inverted_cells;
  j["elastic_energy_J"] = end.energy.elastic;
  j["kinetic_energy_J"] = end.energy.kinetic;
  j["gravity_potential_J"] = end.energy.gravity;
  j["load_potential_J"] = end.load_potential();
  j["potential_energy_J"] = end.potential_energy();
  j["total_energy_J"] = end.total_energy();
  j["linear_momentum_kg_m_s"] = list_of(end.momentum[0]);
  j["angular_momentum_kg_m2_s"] = list_of(end.momentum[1]);
  for (const VolumeMeasures& p : end.parts) {
    j["volumes"][p.name] = {{"volume_m3", p.volume},
                            {"rest_volume_m3", p.rest_volume},
                            {"volume_change", p.volume_change()},
                            {"min_J", p.min_J},
                            {"max_J", p.max_J}};
  }
  for (const char* key : {"probes", "cavities", "reactions"}) j[key] = Json::object();
  for (std::size_t p = 0; p < r.probes.size(); ++p) j["probes"][r.probes[p]] = list_of(end.probes[p]);
  for (std::size_t c = 0; c < r.cavities.size(); ++c) {
    j["cavities"][r.cavities[c]] = {{"pressure_Pa", end.cavities[c].pressure},
                                    {"volume_m3", end.cavities[c].volume}};
  }
  j["gauges"] = Json::object();
  for (const Gauge& g : end.gauges) {
    j["gauges"][g.effect][g.quantity + (g.unit == "1" ? "" : "_" + g.unit)] = g.value;
  }
  for (std::size_t s = 0; s < r.supports.size(); ++s) {
    j["reactions"][r.supports[s]] = {{"force_N", list_of(end.reactions[s].force)},
                                     {"moment_Nm", list_of(end.reactions[s].moment)}};
  }
}

Json summary(const RunResult& r) {
  Json j;
  j["status"] = to_string(r.status);
  j["reason"] = r.reason;
  j["scene"] = r.scene;
  j["steps"] = r.records.empty() ? 0 : r.records.back().step;
  j["steps_asked"] = r.steps_asked;
  j["newton_iterations"] = r.work.iterations;
  j["factorizations"] = r.work.factorizations;
  j["solves"] = r.work.solves();
  j["wall_s"] = r.wall_s;
  j["stage_s"] = stages(r.stages);
  j["unknowns"] = {{"displacement", r.size.displacement_unknowns}, {"multipliers", r.size.multipliers}};
  j["elements"] = r.elements;
  if (!r.records.empty()) add_state(j, r);
  j["metrics"] = Json::array();
  for (const auto& m : r.metrics) j["metrics"].push_back(metric(m));
  char hash[20];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(r.state_hash));
  j["state_hash"] = hash;
  j["warnings"] = r.warnings;
  j["version"] = version();
  j["build"] = build_description();
  j["machine"] = machine_description();
  j["threads"] = r.threads;
  return j;
}

std::string dump(const Json& j) {
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string summary_json(const RunResult& r) {
  return dump(summary(r));
}

std::string failure_json(const RunResult& r) {
  return dump({{"status", to_string(r.status)}, {"reason", r.reason}, {"scene", r.scene}});
}

namespace {

void add_accuracy(Json& j, const Accuracy& accuracy) {
  Json& a = j["accuracy"];
  a["compared_with"] = accuracy.how;
  a["upper_limit"] = accuracy.comparison == Comparison::worse_element;
  a["reason"] = accuracy.reason;
  a["wall_s"] = accuracy.seconds;
  a["indicators"] = Json::array();
  for (const AccuracyEntry& e : accuracy.entries) {
    Json entry{{"name", e.name},
               {"value", e.value},
               {"unit", e.unit},
               {"compared", e.other},
               {"error", e.indicator}};
    if (e.relative) entry["relative"] = *e.relative;
    if (!e.where.empty()) entry["where"] = e.where;
    a["indicators"].push_back(entry);
  }
}

Json trial(const Trial& t) {
  Json j{{"setting", describe(t.setting)},
         {"status", to_string(t.status)},
         {"elements", t.elements},
         {"unknowns", t.unknowns},
         {"wall_s", t.seconds},
         {"predicted_s", t.predicted_seconds}};
  if (!t.reason.empty()) j["reason"] = t.reason;
  if (t.indicator && std::isfinite(*t.indicator)) j["indicator"] = *t.indicator;
  if (t.of_mesh && std::isfinite(*t.of_mesh)) j["of_mesh"] = *t.of_mesh;
  if (t.of_steps && std::isfinite(*t.of_steps)) j["of_steps"] = *t.of_steps;
  if (t.indicator || t.of_steps) j["held_by"] = t.held_by;
  return j;
}

}  // namespace

std::string summary_json(const RunResult& r, const Accuracy& accuracy) {
  Json j = summary(r);
  add_accuracy(j, accuracy);
  return dump(j);
}

std::string summary_json(const ErrorSearch& s) {
  Json j = summary(s.result);
  add_accuracy(j, s.accuracy);
  Json& a = j["accuracy"];
  a["error_asked"] = s.asked;
  a["search"] = to_string(s.end);
  a["sentence"] = s.sentence;
  a["overrides"] = s.overrides;
  a["search_wall_s"] = s.seconds;
  a["trials"] = Json::array();
  for (const Trial& t : s.trials) a["trials"].push_back(trial(t));
  return dump(j);
}

std::string version() {
  return ISOCHOR_VERSION;
}

std::string build_description() {
  return ISOCHOR_BUILD;
}

std::string machine_description() {
  std::string processor = "unknown processor";
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("model name")) continue;
    if (const auto colon = line.find(": "); colon != std::string::npos) processor = line.substr(colon + 2);
    break;
  }
  return processor + ", " + std::to_string(std::max(1u, std::thread::hardware_concurrency())) + " threads";
}

}  // namespace isochor
