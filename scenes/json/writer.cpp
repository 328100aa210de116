#include "scenes/json/writer.h"

#include <cmath>

namespace isochor::scene_json {

Json plain_number(double value) {
  const bool whole = value == std::floor(value) && std::abs(value) < 1e15;
  return whole ? Json(static_cast<std::int64_t>(value)) : Json(value);
}

void Writer::number_or_inf(const char* key, double value, double standard) {
  if (std::isinf(value))
    json_[key] = "inf";
  else
    number(key, value, standard);
}

void Writer::points(const char* key, const std::vector<Vec3>& value) {
  for (const Vec3& p : value) json_[key].push_back(list_of(p));
}

void Writer::boxes(const char* key, const std::vector<std::array<Vec3, 2>>& value) {
  for (const auto& box : value) json_[key].push_back(Json::array({list_of(box[0]), list_of(box[1])}));
}

void Writer::directions(const char* key, const std::vector<Vec3>& value) {
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
    json_[key] = letters;
  else
    points(key, value);
}

void Writer::body(const char* key, BodyId value) {
  const auto b = static_cast<std::size_t>(value);
  // The first body is what the absent key means.
  if (b > 0 && b < scene_.bodies.size()) json_[key] = scene_.bodies[b].name;
}

void Writer::optional_body(const char* key, const std::optional<BodyId>& value) {
  if (value) json_[key] = scene_.bodies[static_cast<std::size_t>(*value)].name;
}

void Writer::required_curve(const char* key, const Curve& value, CurveStart start) {
  const auto& p = value.points;
  const bool constant = scene_.analysis.type == AnalysisType::dynamics || start == CurveStart::constant;
  const double first = start == CurveStart::zero ? 0 : 1;
  if (constant && p.size() == 1) {
    json_[key] = plain_number(p[0][1]);
  } else if (!constant && p.size() == 2 && p[0] == std::array{0.0, first} && p[1][0] == 1) {
    json_[key] = plain_number(p[1][1]);
  } else {
    for (const auto& point : p)
      json_[key].push_back(Json::array({plain_number(point[0]), plain_number(point[1])}));
  }
}

}  // namespace isochor::scene_json
