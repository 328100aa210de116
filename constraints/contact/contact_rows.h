// Rows of contact: one a point, gap - target - C multiplier = 0 with multiplier <= 0, C the compliance over
// the point's area. A layer may stiffen with what presses: C multiplier then holds up to a knee of pressure
// alone, and the depth beyond it ends near twice the one there.
#pragma once

#include <limits>

#include "engine/system/pool.h"

namespace isochor {

// Of a pair of surfaces.
struct ContactLayer {
  double compliance = 0;  // [m/Pa]
  double knee = 0;        // pressure up to which it is linear, infinity: always [Pa]
  double modulus = 0;     // shear modulus of the softer body [Pa]
};

class ContactRows : public RowPool, public LawRows {
 public:
  ContactRows(std::string name, double resolve_time) : name_(std::move(name)), resolve_time_(resolve_time) {}
  std::string_view name() const override { return name_; }
  void update(double t, std::span<double> value) const override {
    const double left = std::max(0.0, 1 - t / resolve_time_);
    for (std::size_t r = 0; r < value.size(); ++r)
      value[r] = (overlap.empty() ? 0 : left * overlap[r]) + (allowed.empty() ? 0 : allowed[r]);
  }

  // `compliance` [m/Pa] of the layer, 0: hard; mu: shear modulus that pressures are compared with [Pa].
  void add(double mu, double point_area, double length, double layer_compliance) {
    const Index row = rows();
    map.push({&row, 1});
    weight.push_back(1);
    area.push_back(point_area);
    metric.push_back(1 / (mu * std::sqrt(point_area)));
    measure.push_back(length);
    if (layer_compliance > 0) compliance.push_back({row, row, layer_compliance / point_area});
    lower.push_back(-std::numeric_limits<double>::infinity());
    upper.push_back(0.0);
  }

  RowFacets facets() const override {
    if (knee.empty()) return {};
    return {.law = this};
  }
  bool local() const override { return true; }
  double evaluate_law(const RowIncrement& increment, std::span<const double> lambda, std::span<double> strain,
                      std::span<double> tangent) const override;

  // How far the layer of a row gives way under its multiplier [m], zero or more.
  double depth(Index row, double multiplier) const;

  std::vector<double> area;     // [m^2]
  std::vector<double> knee;     // force up to which the layer is linear [N]; empty: it is so always
  std::vector<double> overlap;  // gap at the start where it is below zero, else zero [m]; empty: none is
  std::vector<double> allowed;  // the same for overlap that stays; empty: none does

 private:
  std::string name_;
  double resolve_time_;
};

}  // namespace isochor
