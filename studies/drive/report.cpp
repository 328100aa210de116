#include "studies/drive/report.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "engine/base/text.h"

namespace isochor::drive {

namespace {

std::string full(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"\n") == std::string::npos) return name;
  std::string out = "\"";
  for (const char c : name) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

nlohmann::ordered_json bound(double value) {
  if (!std::isfinite(value)) return nullptr;
  return value;
}

}  // namespace

const char* word(const Reached& step) {
  return step.reached ? "reached" : (step.nearest ? "nearest" : "not converged");
}

std::string drive_csv(const Drive& drive) {
  std::string out = "time";
  for (const Actuator& a : drive.actuators) out += "," + quoted(a.effect);
  for (const inverse::Quantity& g : drive.targets.goals) out += "," + quoted(g.name);
  for (const inverse::Quantity& g : drive.targets.goals) out += "," + quoted("target " + g.name);
  out += ",distance,end,gradients\n";
  for (std::size_t k = 0; k < drive.steps.size(); ++k) {
    const Reached& r = drive.steps[k];
    out += full(r.time);
    for (const double v : r.amount) out += "," + full(v);
    for (const double v : r.position) out += "," + full(v);
    for (const double v : drive.targets.value[k]) out += "," + full(v);
    out += "," + full(r.distance) + "," + word(r) + "," + std::to_string(r.iterations) + "\n";
  }
  return out;
}

std::string drive_json(const Drive& drive) {
  using Json = nlohmann::ordered_json;
  Json out;
  out["all_reached"] = drive.all_reached();
  out["reason"] = drive.reason;
  out["amounts"] = Json::array();
  for (const Actuator& a : drive.actuators) {
    out["amounts"].push_back(Json{
        {"effect", a.effect}, {"least", bound(a.least)}, {"most", bound(a.most)}, {"rate", bound(a.rate)}});
  }
  out["goals"] = Json::array();
  for (const inverse::Quantity& g : drive.targets.goals) out["goals"].push_back(g.name);
  out["steps"] = Json::array();
  for (std::size_t k = 0; k < drive.steps.size(); ++k) {
    const Reached& r = drive.steps[k];
    out["steps"].push_back(Json{{"time", r.time},
                                {"end", word(r)},
                                {"distance", r.distance},
                                {"amounts", r.amount},
                                {"positions", r.position},
                                {"targets", drive.targets.value[k]},
                                {"at_bound", r.at_bound},
                                {"gradients", r.iterations}});
  }
  if (!drive.curves.empty()) {
    out["increments"] = drive.increments;
    out["curves"] = Json::array();
    for (const Curve& curve : drive.curves) out["curves"].push_back(curve.points);
  }
  return out.dump(2) + "\n";
}

std::string amounts_csv(const Drive& drive) {
  if (drive.curves.empty()) return "";
  std::string out = "time";
  for (const Actuator& a : drive.actuators) out += "," + quoted(a.effect);
  out += "\n";
  for (std::size_t p = 0; p < drive.curves.front().points.size(); ++p) {
    out += full(drive.curves.front().points[p][0]);
    for (const Curve& curve : drive.curves) out += "," + full(curve.points[p][1]);
    out += "\n";
  }
  return out;
}

std::vector<std::string> table_head(const Drive& drive) {
  std::vector<std::string> out{"time", "end", "distance"};
  for (const Actuator& a : drive.actuators) out.push_back(a.effect);
  out.push_back("at a bound");
  return out;
}

std::vector<std::string> table_row(const Drive& drive, const Reached& step) {
  std::vector<std::string> out{number(step.time), word(step), number(step.distance)};
  for (std::size_t i = 0; i < drive.actuators.size(); ++i) out.push_back(number(step.amount[i]));
  std::string bounds;
  for (const std::string& name : step.at_bound) bounds += (bounds.empty() ? "" : ", ") + name;
  out.push_back(bounds);
  return out;
}

}  // namespace isochor::drive
