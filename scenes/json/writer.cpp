#include "scenes/json/writer.h"

#include <cmath>

namespace isochor::scene_json {

void Writer::number_or_inf(const Key& key, double& value, double standard) {
  if (std::isinf(value))
    json_[key.name] = "inf";
  else
    number(key, value, standard);
}

void Writer::points(const Key& key, std::vector<Vec3>& value) {
  for (const Vec3& p : value) json_[key.name].push_back(list_of(p));
}

void Writer::paths(const Key& key, std::vector<std::vector<Vec3>>& value) {
  for (const auto& path : value) {
    Json points = Json::array();
    for (const Vec3& p : path) points.push_back(list_of(p));
    json_[key.name].push_back(std::move(points));
  }
}

void Writer::boxes(const Key& key, std::vector<std::array<Vec3, 2>>& value) {
  for (const auto& box : value) json_[key.name].push_back(Json::array({list_of(box[0]), list_of(box[1])}));
}

void Writer::directions(const Key& key, std::vector<Vec3>& value) {
  if (value.empty()) return;
  std::string letters;
  for (const Vec3& d : value) {
    for (int k = 0; k < 3; ++k) {
      Vec3 axis{};
      axis[k] = 1;
      if (d == axis) letters += static_cast<char>('x' + k);
    }
  }
  if (letters.size() == value.size())
    json_[key.name] = letters;
  else
    points(key, value);
}

void Writer::body(const Key& key, BodyId& value) {
  const auto b = static_cast<std::size_t>(value);
  // The first body is what the absent key means.
  if (b > 0 && b < scene_.bodies.size()) json_[key.name] = scene_.bodies[b].name;
}

void Writer::optional_body(const Key& key, std::optional<BodyId>& value) {
  if (value) json_[key.name] = scene_.bodies[static_cast<std::size_t>(*value)].name;
}

void Writer::required_curve(const Key& key, Curve& value, CurveStart start) {
  const auto& p = value.points;
  const bool constant = scene_.analysis.type == AnalysisType::dynamics || start == CurveStart::constant;
  const double first = start == CurveStart::zero ? 0 : 1;
  if (constant && p.size() == 1) {
    json_[key.name] = plain_number(p[0][1]);
  } else if (!constant && p.size() == 2 && p[0] == std::array{0.0, first} && p[1][0] == 1) {
    json_[key.name] = plain_number(p[1][1]);
  } else {
    for (const auto& point : p)
      json_[key.name].push_back(Json::array({plain_number(point[0]), plain_number(point[1])}));
  }
}

void Writer::choice(const Key& key, int& value, int standard, std::span<const keys::Word> words) {
  if (value == standard) return;
  for (const keys::Word& word : words) {
    if (word.value != value) continue;
    json_[key.name] = word.name;
    return;
  }
}

void Writer::settings_at(const Key& key, const keys::Object& object) {
  Json inner;
  write(inner, object);
  if (!inner.empty()) json_[key.name] = std::move(inner);
}

bool Writer::optional_at(const Key& key, const keys::Object& object, bool present) {
  if (present) write(json_[key.name], object);
  return present;
}

bool Writer::list_at(const Key& key, const keys::List& list, bool present) {
  if (!present) return false;
  Json& all = json_[key.name] = Json::array();
  for (std::size_t i = 0; i < list.size(list.list); ++i) {
    all.push_back(Json::object());
    write(all.back(), list.item(list.list, i));
  }
  return true;
}

}  // namespace isochor::scene_json
