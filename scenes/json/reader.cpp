#include "scenes/json/reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace isochor::scene_json {

namespace {

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0u : 1u)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& w : words) text += (text.empty() ? "" : ", ") + w;
  return text;
}

}  // namespace

std::string shown(const Json& value) {
  constexpr std::size_t kMost = 60;
  // Strings of a broken file may be anything, also no UTF-8.
  std::string text = value.is_structured() && value.size() > 20
                         ? std::string(value.is_array() ? "a list" : "an object") + " of " +
                               std::to_string(value.size()) + " entries"
                         : value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > kMost) text = text.substr(0, kMost) + "...";
  return text;
}

std::string suggestion(const std::string& word, const std::vector<std::string>& known) {
  if (word.size() > 64) return {};
  std::size_t best = std::max<std::size_t>(2, word.size() / 3) + 1;
  std::string nearest;
  for (const auto& k : known) {
    const std::size_t d = edit_distance(word, k);
    if (d < best) {
      best = d;
      nearest = k;
    }
  }
  return nearest.empty() ? "" : ", did you mean \"" + nearest + "\"?";
}

void Reader::know(const char* key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
}

const Json* Reader::find(const char* key) {
  know(key);
  if (!json_.is_object() || !context_.error.empty()) return nullptr;
  const auto it = json_.find(key);
  return it == json_.end() ? nullptr : &*it;
}

const Json* Reader::require(const char* key) {
  const Json* j = find(key);
  if (!j) fail_here(std::string("\"") + key + "\" is missing");
  return j;
}

void Reader::fail_type(const std::string& where, const char* expected, const Json& j) {
  context_.fail(where, std::string("expected ") + expected + ", found " + shown(j));
}

void Reader::fail_word(const char* key, const Json& j, const std::vector<std::string>& known) {
  const std::string near = j.is_string() ? suggestion(j.get<std::string>(), known) : "";
  context_.fail(at(key), shown(j) + " is none of: " + joined(known) + near);
}

bool Reader::expect_list(const Json& j, const char* key) {
  if (j.is_array()) return true;
  fail_type(at(key), "a list [...]", j);
  return false;
}

bool Reader::read_number(const Json& j, const std::string& where, double& value) {
  if (!j.is_number()) {
    fail_type(where, "a number", j);
    return false;
  }
  const double v = j.get<double>();
  if (!std::isfinite(v)) {
    fail_type(where, "a finite number", j);
    return false;
  }
  value = v;
  return true;
}

bool Reader::read_integer(const Json& j, const std::string& where, int& value) {
  const double v = j.is_number() ? j.get<double>() : 0.5;
  if (v != std::floor(v) || std::abs(v) > std::numeric_limits<int>::max()) {
    fail_type(where, "a whole number", j);
    return false;
  }
  value = static_cast<int>(v);
  return true;
}

bool Reader::read_vector(const Json& j, const std::string& where, Vec3& value) {
  if (!j.is_array() || j.size() != 3) {
    fail_type(where, "three numbers [x, y, z]", j);
    return false;
  }
  for (int k = 0; k < 3; ++k) {
    if (!read_number(j[static_cast<std::size_t>(k)], where + "[" + std::to_string(k) + "]", value[k]))
      return false;
  }
  return true;
}

void Reader::text(const Key& key, std::string& value, const std::string&) {
  const Json* j = find(key.name);
  if (!j) return;
  if (j->is_string())
    value = j->get<std::string>();
  else
    fail_type(at(key.name), "a text \"...\"", *j);
}

void Reader::required_text(const Key& key, std::string& value) {
  if (require(key.name)) text(key, value, {});
}

void Reader::number(const Key& key, double& value, double) {
  if (const Json* j = find(key.name)) read_number(*j, at(key.name), value);
}

void Reader::number_or_inf(const Key& key, double& value, double) {
  const Json* j = find(key.name);
  if (!j) return;
  if (j->is_string() && j->get_ref<const std::string&>() == "inf")
    value = std::numeric_limits<double>::infinity();
  else if (j->is_number())
    read_number(*j, at(key.name), value);
  else
    fail_type(at(key.name), "a number or \"inf\"", *j);
}

void Reader::optional_number(const Key& key, std::optional<double>& value) {
  const Json* j = find(key.name);
  double v = 0;
  if (j && read_number(*j, at(key.name), v)) value = v;
}

void Reader::integer(const Key& key, int& value, int) {
  if (const Json* j = find(key.name)) read_integer(*j, at(key.name), value);
}

void Reader::flag(const Key& key, bool& value, bool) {
  const Json* j = find(key.name);
  if (!j) return;
  if (j->is_boolean())
    value = j->get<bool>();
  else
    fail_type(at(key.name), "true or false", *j);
}

void Reader::vector(const Key& key, Vec3& value, const Vec3&) {
  if (const Json* j = find(key.name)) read_vector(*j, at(key.name), value);
}

void Reader::required_vector(const Key& key, Vec3& value) {
  if (const Json* j = require(key.name)) read_vector(*j, at(key.name), value);
}

void Reader::integers(const Key& key, std::array<int, 3>& value) {
  const Json* j = find(key.name);
  if (!j) return;
  if (!j->is_array() || j->size() != 3)
    return fail_type(at(key.name), "three whole numbers [nx, ny, nz]", *j);
  for (std::size_t k = 0; k < 3; ++k)
    read_integer((*j)[k], at(key.name) + "[" + std::to_string(k) + "]", value[k]);
}

void Reader::names(const Key& key, std::vector<std::string>& value) {
  const Json* j = find(key.name);
  if (!j) return;
  if (j->is_string()) {
    value = {j->get<std::string>()};
    return;
  }
  if (!j->is_array()) return fail_type(at(key.name), "a name or a list of names", *j);
  for (std::size_t i = 0; i < j->size(); ++i) {
    if (!(*j)[i].is_string())
      return fail_type(at(key.name) + "[" + std::to_string(i) + "]", "a name", (*j)[i]);
    value.push_back((*j)[i].get<std::string>());
  }
}

void Reader::indices(const Key& key, std::vector<Index>& value) {
  const Json* j = find(key.name);
  if (!j || !expect_list(*j, key.name)) return;
  for (std::size_t i = 0; i < j->size(); ++i) {
    if (!read_integer((*j)[i], at(key.name) + "[" + std::to_string(i) + "]", value.emplace_back())) return;
  }
}

void Reader::numbers(const Key& key, std::vector<double>& value) {
  const Json* j = find(key.name);
  if (!j || !expect_list(*j, key.name)) return;
  for (std::size_t i = 0; i < j->size(); ++i) {
    if (!read_number((*j)[i], at(key.name) + "[" + std::to_string(i) + "]", value.emplace_back())) return;
  }
}

void Reader::optional_vector(const Key& key, std::optional<Vec3>& value) {
  if (const Json* j = find(key.name)) read_vector(*j, at(key.name), value.emplace());
}

void Reader::paths(const Key& key, std::vector<std::vector<Vec3>>& value) {
  const Json* j = find(key.name);
  if (!j || !expect_list(*j, key.name)) return;
  for (std::size_t i = 0; i < j->size(); ++i) {
    const std::string place = at(key.name) + "[" + std::to_string(i) + "]";
    if (!(*j)[i].is_array()) return fail_type(place, "a list of points", (*j)[i]);
    auto& path = value.emplace_back();
    for (std::size_t k = 0; k < (*j)[i].size(); ++k) {
      if (!read_vector((*j)[i][k], place + "[" + std::to_string(k) + "]", path.emplace_back())) return;
    }
  }
}

void Reader::points(const Key& key, std::vector<Vec3>& value) {
  const Json* j = find(key.name);
  if (!j || !expect_list(*j, key.name)) return;
  for (std::size_t i = 0; i < j->size(); ++i) {
    if (!read_vector((*j)[i], at(key.name) + "[" + std::to_string(i) + "]", value.emplace_back())) return;
  }
}

bool Reader::read_box(const Json& j, const std::string& where, std::array<Vec3, 2>& value) {
  if (!j.is_array() || j.size() != 2) {
    fail_type(where, "two corners [[x, y, z], [x, y, z]]", j);
    return false;
  }
  for (std::size_t c = 0; c < 2; ++c) {
    if (!read_vector(j[c], where + "[" + std::to_string(c) + "]", value[c])) return false;
  }
  return true;
}

void Reader::boxes(const Key& key, std::vector<std::array<Vec3, 2>>& value) {
  const Json* j = find(key.name);
  if (!j || !expect_list(*j, key.name)) return;
  for (std::size_t i = 0; i < j->size(); ++i) {
    if (!read_box((*j)[i], at(key.name) + "[" + std::to_string(i) + "]", value.emplace_back())) return;
  }
}

void Reader::optional_box(const Key& key, std::optional<std::array<Vec3, 2>>& value) {
  if (const Json* j = find(key.name)) read_box(*j, at(key.name), value.emplace());
}

void Reader::read_direction(const Json& j, const std::string& where, std::vector<Vec3>& value) {
  if (!j.is_string()) {
    read_vector(j, where, value.emplace_back());
    return;
  }
  for (const char c : j.get_ref<const std::string&>()) {
    if (c < 'x' || c > 'z') return fail_type(where, "letters of x, y and z (as in \"xz\") or a vector", j);
    value.emplace_back()[c - 'x'] = 1;
  }
}

void Reader::directions(const Key& key, std::vector<Vec3>& value) {
  const Json* j = find(key.name);
  if (!j) return;
  if (j->is_string())
    read_direction(*j, at(key.name), value);
  else if (expect_list(*j, key.name)) {
    for (std::size_t i = 0; i < j->size(); ++i) {
      read_direction((*j)[i], at(key.name) + "[" + std::to_string(i) + "]", value);
    }
  }
  if (value.empty()) fail_type(at(key.name), "at least one direction; leave the key out to hold all", *j);
}

void Reader::angle(const Key& radians, const Key& degrees, double& value) {
  not_both(radians.name, degrees.name);
  const Json* r = find(radians.name);
  const Json* d = find(degrees.name);
  if (!r && !d)
    return fail_here(std::string("\"") + radians.name + "\" [rad] or \"" + degrees.name + "\" is missing");
  if (r)
    read_number(*r, at(radians.name), value);
  else if (read_number(*d, at(degrees.name), value))
    value *= std::numbers::pi / 180;
}

void Reader::optional_angle(const Key& radians, const Key& degrees, double& value, double) {
  const bool given = json_.is_object() && (json_.contains(radians.name) || json_.contains(degrees.name));
  if (given) return angle(radians, degrees, value);
  know(radians.name);
  know(degrees.name);
}

void Reader::body(const Key& key, BodyId& value) {
  const Json* j = find(key.name);
  if (!j) {
    if (!context_.ids.empty()) value = context_.ids.front();
    return;
  }
  if (!j->is_string()) return fail_type(at(key.name), "the name of a body", *j);
  if (context_.bodies.empty())
    return context_.fail(at(key.name), shown(*j) + " names no body: there is none; add one first");
  const auto it = std::find(context_.bodies.begin(), context_.bodies.end(), j->get_ref<const std::string&>());
  if (it == context_.bodies.end()) return fail_word(key.name, *j, context_.bodies);
  const auto n = static_cast<std::size_t>(it - context_.bodies.begin());
  value = context_.ids.empty() ? BodyId{n} : context_.ids[n];
}

void Reader::optional_body(const Key& key, std::optional<BodyId>& value) {
  if (!find(key.name)) return;
  BodyId id{};
  body(key, id);
  value = id;
}

void Reader::read_plain_curve(double end, Curve& value, CurveStart start) const {
  if (context_.analysis == AnalysisType::dynamics || start == CurveStart::constant)
    value = Curve::constant(end);
  else if (start == CurveStart::zero)
    value = Curve::ramp(end);
  else
    value = Curve{{{0, 1}, {1, end}}};
}

void Reader::read_curve(const Json& j, const std::string& where, Curve& value, CurveStart start) {
  if (!j.is_array()) {
    double end = 0;
    if (!j.is_number()) return fail_type(where, "a number or points [[time, value], ...]", j);
    if (read_number(j, where, end)) read_plain_curve(end, value, start);
    return;
  }
  value.points.clear();
  for (std::size_t i = 0; i < j.size(); ++i) {
    const std::string here = where + "[" + std::to_string(i) + "]";
    if (!j[i].is_array() || j[i].size() != 2) return fail_type(here, "a point [time, value]", j[i]);
    auto& p = value.points.emplace_back();
    if (!read_number(j[i][0], here + "[0]", p[0]) || !read_number(j[i][1], here + "[1]", p[1])) return;
  }
}

void Reader::curve(const Key& key, Curve& value, CurveStart start, bool) {
  if (const Json* j = find(key.name))
    read_curve(*j, at(key.name), value, start);
  else
    read_plain_curve(1, value, start);
}

void Reader::required_curve(const Key& key, Curve& value, CurveStart start) {
  if (const Json* j = require(key.name)) read_curve(*j, at(key.name), value, start);
}

void Reader::note(const Key& key) {
  std::string ignored;
  text(key, ignored, {});
}

void Reader::not_both(const char* a, const char* b) {
  if (json_.is_object() && json_.contains(a) && json_.contains(b)) {
    fail_here(std::string("both \"") + a + "\" and \"" + b + "\" are given; give one");
  }
}

void Reader::mesh_form(std::variant<MeshFile, BoxMeshDef, LatticeMesh>& mesh) {
  not_both("file", "box");
  not_both("file", "lattice");
  not_both("box", "lattice");
  if (!json_.is_object()) return;
  if (!json_.contains("file") && !json_.contains("box") && !json_.contains("lattice"))
    fail_here("\"file\", \"box\" or \"lattice\" is missing");
  // The list of known keys is that of all forms.
  for (const char* key : {"file", "box", "lattice", "scale"}) know(key);
  if (json_.contains("box")) mesh = BoxMeshDef{};
  if (json_.contains("lattice")) mesh = LatticeMesh{};
  if (json_.contains("box") && json_.contains("scale"))
    fail_here("\"scale\" belongs to a file; give the box its size");
  if (json_.contains("lattice") && json_.contains("scale"))
    fail_here("\"scale\" belongs to a file; a lattice has its own inside");
}

void Reader::choice(const Key& key, int& value, int, std::span<const keys::Word> words) {
  const Json* j = find(key.name);
  if (!j) return;
  std::vector<std::string> known;
  for (const keys::Word& word : words) {
    if (j->is_string() && j->get_ref<const std::string&>() == word.name) {
      value = word.value;
      return;
    }
    known.emplace_back(word.name);
  }
  fail_word(key.name, *j, known);
}

void Reader::read_object(const Json& j, const std::string& where, const keys::Object& object) {
  Reader inner(j, where, context_);
  object.keys(inner, object.value);
  inner.finish();
}

void Reader::object_at(const Key& key, const keys::Object& object) {
  if (const Json* j = require(key.name)) read_object(*j, at(key.name), object);
}

void Reader::settings_at(const Key& key, const keys::Object& object) {
  if (const Json* j = find(key.name)) read_object(*j, at(key.name), object);
}

bool Reader::optional_at(const Key& key, const keys::Object& object, bool) {
  const Json* j = find(key.name);
  if (j) read_object(*j, at(key.name), object);
  return j != nullptr;
}

bool Reader::list_at(const Key& key, const keys::List& list, bool) {
  const Json* j = find(key.name);
  if (!j || !expect_list(*j, key.name)) return false;
  for (std::size_t i = 0; i < j->size() && context_.error.empty(); ++i)
    read_object((*j)[i], at(key.name) + "[" + std::to_string(i) + "]", list.append(list.list));
  return true;
}

void Reader::finish() {
  if (!json_.is_object() || !context_.error.empty()) return;
  for (const auto& [key, value] : json_.items()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    std::string near = suggestion(key, known_);
    if (near.empty()) near = "; known here: " + joined(known_);
    context_.fail(at(key), "unknown key (value " + shown(value) + ")" + near);
    return;
  }
}

}  // namespace isochor::scene_json
