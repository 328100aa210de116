#include "constraints/chamber/chamber_network.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "isochor/effects/cavity.h"

namespace isochor {

namespace {

// Below this fraction of ambient pressure the law of a gas goes on along its tangent, so that iterates of the
// solver on their way may pass through a vacuum or below. No chamber settles there.
constexpr double kThinnest = 1e-3;

}  // namespace

double ChamberContent::volume(double p) const {
  if (!gas) return 1;
  const double ratio = (ambient + p) / ambient;
  if (ratio >= kThinnest) return std::pow(ratio, -1 / polytropic);
  return std::pow(kThinnest, -1 / polytropic) * (1 - (ratio / kThinnest - 1) / polytropic);
}

double ChamberContent::slope(double p) const {
  if (!gas) return 0;
  const double ratio = std::max((ambient + p) / ambient, kThinnest);
  return -std::pow(ratio, -1 / polytropic) / (polytropic * ratio * ambient);
}

double ChamberContent::integral(double p) const {
  if (!gas) return p;
  const double e = 1 - 1 / polytropic;
  const auto regular = [&](double ratio) {
    return ambient * (polytropic == 1 ? std::log(ratio) : std::expm1(e * std::log(ratio)) / e);
  };
  const double ratio = (ambient + p) / ambient;
  if (ratio >= kThinnest) return regular(ratio);
  const double d = ratio - kThinnest;
  return regular(kThinnest) +
         ambient * std::pow(kThinnest, -1 / polytropic) * (d - 0.5 * d * d / (kThinnest * polytropic));
}

Index ChamberNetwork::add_chamber(ChamberContent content, const EnclosedVolumePool& faces, double row_metric,
                                  Index effect) {
  const Index row = static_cast<Index>(chambers_.size()), first = surfaces_->stencils();
  surfaces_->add_faces(faces);
  surfaces_->finish();
  for (Index f = first; f < surfaces_->stencils(); ++f) {
    map.item.push_back(f);
    weight.push_back(1);
  }
  map.offset.push_back(static_cast<Index>(map.item.size()));
  metric.push_back(row_metric);
  measure.push_back(content.rest_volume);
  owner.push_back(effect);
  own_.push_back(compliance.size());
  compliance.push_back({row, row, 0});
  chambers_.push_back(std::move(content));
  return row;
}

void ChamberNetwork::add_valve(ChamberValve valve) {
  coupling_.push_back(compliance.size());
  if (valve.to >= 0) {
    const Index row = std::max(valve.from, valve.to), col = std::min(valve.from, valve.to);
    const auto it = std::find_if(compliance.begin(), compliance.end(),
                                 [&](const ComplianceEntry& e) { return e.row == row && e.col == col; });
    coupling_.back() = static_cast<std::size_t>(it - compliance.begin());
    if (it == compliance.end()) compliance.push_back({row, col, 0});
  }
  valves_.push_back(std::move(valve));
}

std::optional<Index> ChamberNetwork::find(const std::string& wanted) const {
  for (std::size_t i = 0; i < chambers_.size(); ++i) {
    if (chambers_[i].name == wanted) return static_cast<Index>(i);
  }
  return std::nullopt;
}

double ChamberNetwork::supplied(const RowIncrement& increment, Index i) const {
  const ChamberContent& c = chambers_[at(i)];
  const double* memory = increment.memory.data() + 3 * at(i);
  return memory[0] + (c.supply->value(increment.t1) - memory[2]) * c.rest_volume;
}

double ChamberNetwork::transfer(const ChamberValve& v, const RowIncrement& increment) const {
  const double open = std::max(v.opening->value(increment.t1), 0.0);
  const double factor = (increment.t1 - increment.t0) * v.conductance * open;
  if (factor == 0) return 0;
  const ChamberContent& content = chambers_[at(v.from)];
  const double p = increment.memory[3 * at(v.from) + 1];
  const double q = v.to < 0 ? 0 : increment.memory[3 * at(v.to) + 1];
  const double rise = content.integral(p) - content.integral(q);
  // Equal pressures: the limit of the ratio.
  if (std::abs(p - q) <= 1e-6 * content.ambient) return factor / content.volume(0.5 * (p + q));
  return factor * (p - q) / rise;
}

double ChamberNetwork::evaluate_law(const RowIncrement& increment, std::span<const double> lambda,
                                    std::span<double> strain, std::span<double> tangent) const {
  double potential = 0;
  std::fill(tangent.begin(), tangent.end(), 0.0);
  // First the content of each chamber.
  for (Index i = 0; i < rows(); ++i) {
    strain[at(i)] = supplied(increment, i);
    potential -= strain[at(i)] * integral_at(i, lambda);
  }
  for (std::size_t k = 0; k < valves_.size(); ++k) {
    const ChamberValve& v = valves_[k];
    const double g = transfer(v, increment);
    if (g == 0) continue;
    const double rise = integral_at(v.from, lambda) - integral_at(v.to, lambda);
    strain[at(v.from)] -= g * rise;
    if (v.to >= 0) strain[at(v.to)] += g * rise;
    potential += 0.5 * g * rise * rise;
    if (tangent.empty()) continue;
    const double a = chambers_[at(v.from)].volume(-lambda[at(v.from)]);
    const double b = v.to < 0 ? 0 : chambers_[at(v.to)].volume(-lambda[at(v.to)]);
    tangent[own_[at(v.from)]] += g * a * a;
    if (v.to < 0) continue;
    tangent[own_[at(v.to)]] += g * b * b;
    tangent[coupling_[k]] -= g * a * b;
  }
  for (Index i = 0; i < rows(); ++i) {
    const ChamberContent& c = chambers_[at(i)];
    const double p = -lambda[at(i)], content = strain[at(i)];
    if (!tangent.empty()) tangent[own_[at(i)]] -= std::max(content, 0.0) * c.slope(p);
    strain[at(i)] = content * c.volume(p);
  }
  return potential;
}

void ChamberNetwork::start(std::span<double> memory) const {
  for (std::size_t i = 0; i < chambers_.size(); ++i) {
    const double supply = chambers_[i].supply->value(0);
    memory[3 * i] = supply * chambers_[i].rest_volume;
    memory[3 * i + 1] = 0;
    memory[3 * i + 2] = supply;
  }
}

void ChamberNetwork::accept(const RowIncrement& increment, std::span<const double> lambda,
                            std::span<double> memory) const {
  for (Index i = 0; i < rows(); ++i) {
    memory[3 * at(i)] = supplied(increment, i);
    memory[3 * at(i) + 1] = -lambda[at(i)];
    memory[3 * at(i) + 2] = chambers_[at(i)].supply->value(increment.t1);
  }
  for (const ChamberValve& v : valves_) {
    const double flow = transfer(v, increment) * (integral_at(v.from, lambda) - integral_at(v.to, lambda));
    memory[3 * at(v.from)] -= flow;
    if (v.to >= 0) memory[3 * at(v.to)] += flow;
  }
}

std::shared_ptr<ChamberNetwork> chamber_network(Builder& builder) {
  auto network = builder.shared<ChamberNetwork>("chamber network");
  if (network->row_pool < 0) {
    network->stencil_pool = builder.add_stencils(network->surfaces());
    network->row_pool = builder.add_rows(network);
  }
  return network;
}

namespace {

class ValveInstance final : public EffectInstance {
 public:
  ValveInstance(std::string name, std::shared_ptr<const ChamberNetwork> network, ChamberValve valve)
      : name_(std::move(name)), network_(std::move(network)), valve_(std::move(valve)) {}
  Amount* amount() override { return valve_.opening.get(); }
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    const std::size_t first = at(c.system.first_row(network_->row_pool));
    const double p = -c.state.lambda[first + at(valve_.from)];
    const double q = valve_.to < 0 ? 0 : -c.state.lambda[first + at(valve_.to)];
    const double open = std::max(valve_.opening->value(c.state.t), 0.0);
    out.push_back({name_, "valve", "flow", "m^3/s", valve_.conductance * open * (p - q)});
  }

 private:
  std::string name_;
  std::shared_ptr<const ChamberNetwork> network_;
  ChamberValve valve_;
};

class ValveEffect final : public EffectSource {
 public:
  explicit ValveEffect(ValveDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }
  Result<void> check() const override {
    if (!(def_.conductance > 0) || !std::isfinite(def_.conductance)) {
      return Error{who() + "conductance = " + number(def_.conductance) +
                   " m^3/(s Pa); it must be a positive number"};
    }
    for (const auto& p : def_.amount.points) {
      if (!(p[1] >= 0) || !std::isfinite(p[1])) {
        return Error{who() + "opening " + number(p[1]) + "; it is 0 when shut and positive when open"};
      }
    }
    if (def_.from == def_.to)
      return Error{who() + "it leads from \"" + def_.from + "\" to itself; name two chambers"};
    return {};
  }
  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto network = chamber_network(builder);
    ChamberValve valve;
    valve.conductance = def_.conductance;
    valve.opening = std::make_shared<Amount>(def_.amount);
    for (const auto& [name, place] : {std::pair(def_.from, &valve.from), std::pair(def_.to, &valve.to)}) {
      if (place == &valve.to && name.empty()) continue;
      const auto found = network->find(name);
      if (!found) {
        return Error{who() + "there is no chamber \"" + name +
                     "\" with control gas or liquid; add such a cavity before the valve"};
      }
      *place = *found;
    }
    if (valve.to >= 0) {
      const ChamberContent &a = network->chamber(valve.from), &b = network->chamber(valve.to);
      if (a.gas != b.gas || (a.gas && (a.polytropic != b.polytropic || a.ambient != b.ambient))) {
        return Error{
            who() + "\"" + def_.from + "\" and \"" + def_.to +
            "\" hold different contents; both must be liquid, or gas of one polytropic exponent and one "
            "ambient pressure"};
      }
    }
    network->add_valve(valve);
    return std::unique_ptr<EffectInstance>(std::make_unique<ValveInstance>(def_.name, network, valve));
  }

 private:
  std::string who() const { return "valve \"" + def_.name + "\": "; }
  ValveDef def_;
};

}  // namespace

EffectPtr valve(ValveDef def) {
  return std::make_shared<ValveEffect>(std::move(def));
}

}  // namespace isochor
