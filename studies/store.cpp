#include "studies/store.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

namespace isochor::studies {

namespace {

using Json = nlohmann::ordered_json;

Json stages_json(const StageSeconds& t) {
  return {{"analyze", t.analyze}, {"evaluate", t.evaluate},       {"gather", t.gather}, {"factor", t.factor},
          {"solve", t.solve},     {"line_search", t.line_search}, {"total", t.total}};
}

StageSeconds stages_of(const Json& j) {
  return {j.at("analyze"), j.at("evaluate"),    j.at("gather"), j.at("factor"),
          j.at("solve"),   j.at("line_search"), j.at("total")};
}

// JSON has no NaN; what is none is left out.
Json numbers_json(const Numbers& numbers) {
  Json j = Json::object();
  for (const auto& [key, value] : numbers) {
    if (std::isfinite(value)) j[key] = value;
  }
  return j;
}

Json cell_json(const Measured& m) {
  Json j{{"id", m.id},
         {"fingerprint", m.fingerprint},
         {"labels", m.labels},
         {"knobs", numbers_json(m.knobs)},
         {"status", m.status},
         {"reason", m.reason},
         {"values", numbers_json(m.values)}};
  if (m.value) j["value"] = *m.value;
  if (m.reference) j["reference"] = *m.reference;
  if (m.error) j["error"] = *m.error;
  j["uncertainty"] = m.uncertainty;
  j["source"] = m.source;
  j["elements"] = m.elements;
  j["nodes"] = m.nodes;
  j["displacements"] = m.displacements;
  j["multipliers"] = m.multipliers;
  j["nonzeros"] = m.nonzeros;
  j["factor_nonzeros"] = m.factor_nonzeros;
  j["engine_bytes"] = m.engine_bytes;
  j["steps"] = m.steps;
  j["iterations"] = m.iterations;
  j["factorizations"] = m.factorizations;
  j["solves"] = m.solves;
  j["threads"] = m.threads;
  j["repeats"] = m.repeats;
  j["seconds"] = m.seconds;
  j["seconds_median"] = m.seconds_median;
  j["cpu_seconds"] = m.cpu_seconds;
  j["stages"] = stages_json(m.stages);
  j["state_hash"] = m.hash;
  return j;
}

std::optional<double> optional_number(const Json& j, const char* key) {
  if (!j.contains(key)) return {};
  return j.at(key).get<double>();
}

Measured cell_of(const Json& j) {
  Measured m;
  m.id = j.at("id");
  m.fingerprint = j.at("fingerprint");
  m.labels = j.at("labels").get<Labels>();
  m.knobs = j.at("knobs").get<Numbers>();
  m.status = j.at("status");
  m.reason = j.at("reason");
  m.values = j.at("values").get<Numbers>();
  m.value = optional_number(j, "value");
  m.reference = optional_number(j, "reference");
  m.error = optional_number(j, "error");
  m.uncertainty = j.at("uncertainty");
  m.source = j.at("source");
  m.elements = j.at("elements");
  m.nodes = j.at("nodes");
  m.displacements = j.at("displacements");
  m.multipliers = j.at("multipliers");
  m.nonzeros = j.at("nonzeros");
  m.factor_nonzeros = j.at("factor_nonzeros");
  m.engine_bytes = j.at("engine_bytes");
  m.steps = j.at("steps");
  m.iterations = j.at("iterations");
  m.factorizations = j.at("factorizations");
  m.solves = j.at("solves");
  m.threads = j.at("threads");
  m.repeats = j.at("repeats");
  m.seconds = j.at("seconds");
  m.seconds_median = j.at("seconds_median");
  m.cpu_seconds = j.at("cpu_seconds");
  m.stages = stages_of(j.at("stages"));
  m.hash = j.at("state_hash");
  return m;
}

std::string number(double v) {
  if (!std::isfinite(v)) return "";
  char text[40];
  std::snprintf(text, sizeof text, "%.12g", v);
  return text;
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + "\"";
}

template <class Map>
void collect(std::set<std::string>& keys, const Map& map) {
  for (const auto& [key, value] : map) keys.insert(key);
}

}  // namespace

std::string results_json(const StoreHead& head, std::span<const Measured> cells) {
  Json list = Json::array();
  for (const Measured& m : cells) list.push_back(cell_json(m));
  const Json j{{"study", head.study},
               {"title", head.title},
               {"size", head.quick ? "quick" : "default"},
               {"complete", head.complete},
               {"version", version()},
               {"build", build_description()},
               {"machine", machine_description()},
               {"threads", head.threads},
               {"cells", list}};
  return j.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::vector<Measured> read_results(const std::string& path) {
  std::ifstream in(path);
  if (!in) return {};
  const Json j = Json::parse(in, nullptr, false);
  if (j.is_discarded() || !j.is_object() || !j.contains("cells")) return {};
  std::vector<Measured> cells;
  for (const Json& cell : j["cells"]) {
    // A file of another version, or one that was edited: the cell is measured again.
    try {
      cells.push_back(cell_of(cell));
    } catch (const Json::exception&) {
    }
  }
  return cells;
}

std::string results_csv(std::span<const Measured> cells) {
  std::set<std::string> labels, knobs, values;
  for (const Measured& m : cells) {
    collect(labels, m.labels);
    collect(knobs, m.knobs);
    collect(values, m.values);
  }
  std::string out = "id";
  for (const auto& k : labels) out += "," + quoted(k);
  for (const auto& k : knobs) out += "," + quoted(k);
  out +=
      ",status,value,reference,error,uncertainty,elements,nodes,displacements,multipliers,nonzeros,"
      "factor_nonzeros,engine_bytes,steps,iterations,factorizations,solves,threads,repeats,seconds,"
      "seconds_median,cpu_seconds,analyze_s,evaluate_s,gather_s,factor_s,solve_s,line_search_s,state_hash";
  for (const auto& k : values) out += "," + quoted(k);
  out += ",source,reason\n";
  const auto known = [](const std::optional<double>& v) { return v ? number(*v) : std::string(); };
  for (const Measured& m : cells) {
    out += quoted(m.id);
    for (const auto& k : labels) out += "," + quoted(m.label(k));
    for (const auto& k : knobs) out += "," + (m.knobs.contains(k) ? number(m.knob(k)) : std::string());
    out += "," + m.status + "," + known(m.value) + "," + known(m.reference) + "," + known(m.error);
    out += "," + number(m.uncertainty);
    for (const std::int64_t v :
         {m.elements, m.nodes, m.displacements, m.multipliers, m.nonzeros, m.factor_nonzeros, m.engine_bytes})
      out += "," + std::to_string(v);
    for (const int v : {m.steps, m.iterations, m.factorizations, m.solves, m.threads, m.repeats})
      out += "," + std::to_string(v);
    for (const double v : {m.seconds, m.seconds_median, m.cpu_seconds, m.stages.analyze, m.stages.evaluate,
                           m.stages.gather, m.stages.factor, m.stages.solve, m.stages.line_search})
      out += "," + number(v);
    out += "," + m.hash;
    for (const auto& k : values) out += "," + number(m.number(k));
    out += "," + quoted(m.source) + "," + quoted(m.reason) + "\n";
  }
  return out;
}

}  // namespace isochor::studies
