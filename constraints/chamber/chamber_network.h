// Chambers whose content has a law of its own, gas or liquid, and what flows between them. All of a scene
// are rows of one pool, so that valves may couple any two.
#pragma once

#include "constraints/stencil/face_pool.h"
#include "engine/scene/builder.h"

namespace isochor {

// What fills a chamber. Amounts of content are volumes: of gas, at ambient pressure.
struct ChamberContent {
  std::string name;
  bool gas = true;
  double polytropic = 1;           // n of p V^n
  double ambient = 101325;         // absolute pressure outside [Pa]
  double rest_volume = 0;          // [m^3]
  std::shared_ptr<Amount> supply;  // supplied so far, over the rest volume

  // Volume of a unit of content at gauge pressure p, its slope, and its integral from p = 0.
  double volume(double p) const;
  double slope(double p) const;
  double integral(double p) const;
};

struct ChamberValve {
  Index from = -1, to = -1;  // chambers; to < 0: outside
  double conductance = 0;    // [m^3/(s Pa)]
  std::shared_ptr<Amount> opening;
};

// Rows v_i(x) - c_i(lambda) = 0 with lambda_i = -p_i. Chamber i holds, at the end of a step of length h,
//
//   m_i = m_i(start) + supplied during the step - h sum of flows out,   c_i = m_i phi_i(p_i)
//
// with the volume phi of a unit of content. The flow is backward Euler: conductance times the difference of
// the integrals mu of phi, rescaled by (p_i - p_j) / (mu_i - mu_j) of the last accepted step, which makes it
// proportional to the difference of pressures to the order of the time step. In this form the law has a
// potential, U = -sum (m_i(start) + supplied) mu_i + h/2 sum G (mu_i - mu_j)^2, and a symmetric tangent.
class ChamberNetwork final : public RowPool, public LawRows, public RememberingRows {
 public:
  // `effect`: whose chamber it is.
  Index add_chamber(ChamberContent content, const EnclosedVolumePool& faces, double metric, Index effect);
  void add_valve(ChamberValve valve);
  std::optional<Index> find(const std::string& name) const;
  const ChamberContent& chamber(Index i) const { return chambers_[at(i)]; }
  const std::shared_ptr<EnclosedVolumePool>& surfaces() const { return surfaces_; }
  // Of chamber i, from the numbers that the pool keeps [m^3].
  static double held(std::span<const double> memory, Index i) { return memory[3 * at(i)]; }

  std::string_view name() const override { return "chambers"; }
  RowFacets facets() const override { return {.law = this, .remembering = this}; }
  double evaluate_law(const RowIncrement& increment, std::span<const double> lambda, std::span<double> strain,
                      std::span<double> tangent) const override;
  // A chamber keeps its content, its pressure and what it was supplied with so far.
  int memory() const override { return 3 * static_cast<int>(chambers_.size()); }
  void start(std::span<double> memory) const override;
  void accept(const RowIncrement& increment, std::span<const double> lambda,
              std::span<double> memory) const override;
  // h G of a valve in this step [m^3/Pa].
  double transfer(const ChamberValve& valve, const RowIncrement& increment) const;

  Index row_pool = -1;

 private:
  // Content before anything flows in this step.
  double supplied(const RowIncrement& increment, Index i) const;
  double integral_at(Index i, std::span<const double> lambda) const {
    return i < 0 ? 0 : chambers_[at(i)].integral(-lambda[at(i)]);
  }

  std::vector<ChamberContent> chambers_;
  std::vector<ChamberValve> valves_;
  std::vector<std::size_t> own_;       // compliance entry of each chamber
  std::vector<std::size_t> coupling_;  // compliance entry of each valve, where it couples two chambers
  std::shared_ptr<EnclosedVolumePool> surfaces_ = std::make_shared<EnclosedVolumePool>("chambers", Vec3{});
};

// The network of the scene being built, entered into it on first use.
std::shared_ptr<ChamberNetwork> chamber_network(Builder& builder);

}  // namespace isochor
