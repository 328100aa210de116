// Derivatives of the equilibrium that a state is at. The state solves the problem of its own time; problems
// that differ in one input a little are solved to first order with its factors (SaddlePoint::respond). What
// is read off a state then follows by a difference along that answer.
#include "isochor/derivatives.h"

#include <algorithm>
#include <cmath>

#include "engine/base/out_of_memory.h"
#include "engine/base/text.h"
#include "engine/scene/embedding.h"
#include "engine/world/world_impl.h"

namespace isochor {

namespace {

// An input, moved off where it is.
class Input {
 public:
  Input(Amount* amount, PointInBody point, const Vec3& force, State& state)
      : amount_(amount), point_(std::move(point)), force_(force), state_(state), before_(state.forces) {}
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  ~Input() { move(0); }

  void move(double by) {
    if (amount_) {
      amount_->shift(by);
      return;
    }
    state_.forces = before_;
    if (by == 0) return;
    state_.forces.resize(state_.x.size());
    for (std::size_t k = 0; k < point_.nodes.size(); ++k)
      state_.forces[at(point_.nodes[k])] += (by * point_.weight[k]) * force_;
  }
  // About as large as the input itself.
  double size() const { return amount_ ? std::max(1.0, std::abs(amount_->value(state_.t))) : 1; }

 private:
  Amount* amount_;
  PointInBody point_;
  Vec3 force_;
  State& state_;
  std::vector<Vec3> before_;
};

// Everything that an input may change in a problem, one number after another.
std::vector<double> numbers_of(const SaddleProblem& p) {
  std::vector<double> all(p.target.begin(), p.target.end());
  all.insert(all.end(), p.prescribed.begin(), p.prescribed.end());
  for (const auto& list : {p.force, p.position}) {
    for (const Vec3& v : list) all.insert(all.end(), {v.x, v.y, v.z});
  }
  return all;
}

// How far an input is moved for a central difference: far where the problem is linear in it, as rounding then
// counts for less.
double difference_of(Input& input, const std::function<SaddleProblem()>& problem) {
  constexpr double small = 1e-4, straight = 1e-12;
  const double far = input.size();
  const std::vector<double> here = numbers_of(problem());
  input.move(far);
  const std::vector<double> up = numbers_of(problem());
  input.move(-far);
  const std::vector<double> down = numbers_of(problem());
  input.move(0);
  double bend = 0, change = 0;
  for (std::size_t k = 0; k < here.size(); ++k) {
    bend = std::max(bend, std::abs(up[k] - 2 * here[k] + down[k]));
    change = std::max(change, std::abs(up[k]) + std::abs(down[k]));
  }
  return bend <= straight * change ? far : small * far;
}

}  // namespace

struct World::Impl::Derivatives {
  World::Impl& w;
  SaddlePoint& method;
  std::vector<Vec3> dx_up, dx_down;
  std::vector<double> up, down;
  SaddleReport report;

  explicit Derivatives(World::Impl& world) : w(world), method(world.methods.chosen()) {
    for (auto* list : {&dx_up, &dx_down}) list->resize(w.state.x.size());
    for (auto* list : {&up, &down}) list->resize(w.state.lambda.size());
  }

  SaddleProblem problem() { return w.data->problem(w.system(), w.state, w.state.t); }

  Result<void> linearize() {
    if (method.linearize(problem(), w.state.x, w.state.lambda, report)) return {};
    if (report.status == SaddleStatus::converged) {
      return Error{"derivatives: method " + w.methods.description() +
                   " has no factors of the whole system; leave WorldOptions::method automatic"};
    }
    return Error{"derivatives: the equilibrium has none here, its matrix is singular" +
                 (report.message.empty() ? std::string() : " (" + report.message + ")") +
                 ": a limit point, or a body that nothing holds"};
  }

  // Leaves d(x, lambda)/d input in dx_up and up.
  bool solve(Input& input, double difference) {
    input.move(difference);
    if (!method.respond(problem(), dx_up, up, report)) return false;
    input.move(-difference);
    if (!method.respond(problem(), dx_down, down, report)) return false;
    input.move(0);
    const double factor = 0.5 / difference;
    for (std::size_t i = 0; i < dx_up.size(); ++i) dx_up[i] = factor * (dx_up[i] - dx_down[i]);
    for (std::size_t r = 0; r < up.size(); ++r) up[r] = factor * (up[r] - down[r]);
    return true;
  }

  // Gauges and reactions at the state moved along the answer.
  void read(Input& input, double along, std::vector<Gauge>& gauges,
            std::vector<std::array<Vec3, 2>>& reactions) {
    State moved = w.state;
    for (std::size_t i = 0; i < moved.x.size(); ++i) moved.x[i] += along * dx_up[i];
    for (std::size_t r = 0; r < moved.lambda.size(); ++r) moved.lambda[r] += along * up[r];
    input.move(along);
    Assembly& assembly = w.assembly();
    const SaddleProblem p = problem();
    assembly.set_increment({0, {}, w.state.t, w.state.t}, w.pool_memory());
    assembly.renew_lag(moved.x, moved.lambda, p.prescribed);
    assembly.evaluate(Want::gradient, Definiteness::exact, moved.x, moved.lambda, p.prescribed);
    assembly.residual(moved.reactions);
    for (std::size_t i = 0; i < moved.reactions.size(); ++i) moved.reactions[i] -= p.force[i];
    for (const Index e : w.said.order) {
      w.instances[at(e)]->gauges({w.system(), moved}, gauges);
      reactions.push_back(w.reaction_of(e, moved));
    }
    input.move(0);
  }

  // Small against the scene, and where nothing moves against the multipliers.
  double length_of_difference() const {
    constexpr double small = 1e-5;
    double largest = 0, multiplier = 0, rate = 0;
    for (const Vec3& v : dx_up) largest = std::max(largest, norm(v));
    for (std::size_t r = 0; r < up.size(); ++r) {
      multiplier = std::max(multiplier, std::abs(w.state.lambda[r]));
      rate = std::max(rate, std::abs(up[r]));
    }
    if (largest > 0) return small * w.system().length() / largest;
    return rate > 0 ? small * std::max(multiplier, rate) / rate : 1;
  }
};

World::Impl::Irregular World::Impl::irregular() {
  constexpr double close = 1e-6;
  const std::vector<double> theta = row_residuals();
  const System& s = system();
  std::vector<double> phi(theta.size());
  assembly().row_values(phi);
  Irregular out;
  Index undecided = 0;
  for (Index p = 0; s.has_bounds() && p < static_cast<Index>(s.parts().row_pools.size()); ++p) {
    const RowPool& pool = *s.parts().row_pools[at(p)];
    if (pool.law != RowLaw::compliant || (pool.lower.empty() && pool.upper.empty())) continue;
    for (std::size_t k = 0; k < at(pool.rows()); ++k) {
      const std::size_t r = at(s.first_row(p)) + k;
      const double d = s.row_metric()[r], l = state.lambda[r];
      const double lower = s.row_lower()[r], upper = s.row_upper()[r];
      if (!std::isfinite(lower) && !std::isfinite(upper)) continue;
      const double gap = (phi[r] - data->target()[r]) / s.row_measure()[r];
      const double pull = std::min(std::abs(l - lower), std::abs(l - upper)) * d / s.row_measure()[r];
      if (std::abs(gap) >= close || pull >= close) continue;
      ++undecided;
      const Index effect = pool.owner.empty() ? said.builder.owners().row_pool[at(p)] : pool.owner[k];
      const std::string name = effect < 0 ? std::string(pool.name()) : said.sources[at(effect)]->name();
      if (std::find(out.effects.begin(), out.effects.end(), name) == out.effects.end())
        out.effects.push_back(name);
    }
  }
  if (undecided > 0) {
    out.note = std::to_string(undecided) + (undecided == 1 ? " row is" : " rows are") +
               " about to touch or to let go: the derivative is that of one side";
  } else if (s.has_lag() && !s.facets().remembering.empty()) {
    // Where points slide, going on and turning back are not the same.
    out.note = "there is friction: the derivative is that for changes so small that nothing slides";
  }
  return out;
}

std::array<Vec3, 2> World::Impl::reaction_of(Index effect, const State& at_state) const {
  std::array<Vec3, 2> sum = instances[at(effect)]->reaction({system(), at_state});
  if (at(effect) >= held_by.size()) return sum;
  for (const HeldDirection& h : held_by[at(effect)]) {
    const Vec3 f = dot(h.direction, at_state.reactions[at(h.node)]) * h.direction;
    sum[0] += f;
    sum[1] += cross(at_state.x[at(h.node)], f);
  }
  return sum;
}

Result<Response> World::Impl::derivative(Derivatives& d, Amount* amount, PointInBody point,
                                         const Vec3& force) {
  Input input(amount, std::move(point), force, state);
  if (!d.solve(input, difference_of(input, [&] { return d.problem(); })))
    return Error{"derivatives: the linear system was not solved"};
  Response out;
  const double along = d.length_of_difference();
  std::vector<Gauge> below;
  std::vector<std::array<Vec3, 2>> reactions_below;
  d.read(input, along, out.gauges, out.reactions);
  d.read(input, -along, below, reactions_below);
  const double factor = 0.5 / along;
  for (std::size_t g = 0; g < out.gauges.size(); ++g)
    out.gauges[g].value = factor * (out.gauges[g].value - below[g].value);
  for (std::size_t e = 0; e < out.reactions.size(); ++e) {
    for (std::size_t k = 0; k < 2; ++k)
      out.reactions[e][k] = factor * (out.reactions[e][k] - reactions_below[e][k]);
  }
  for (const BodyData& body : said.builder.bodies()) {
    if (!body.present()) continue;
    const auto first = d.dx_up.begin() + body.first_node;
    out.positions.emplace_back(first, first + body.mesh.node_count());
  }
  return out;
}

Result<std::vector<Response>> World::derivatives(std::span<const ResponseInput> inputs) try {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r.failure();
  if (w.settled) {
    return Error{"derivatives: the state is unfinished, no equilibrium; take a step without a budget first"};
  }
  Impl::Derivatives d(w);
  if (auto r = d.linearize(); !r) return r.failure();
  const Index wanted = w.system().rows(), found = d.report.negative_pivots;
  std::vector<Response> all;
  for (const ResponseInput& one : inputs) {
    Amount* amount = nullptr;
    PointInBody point;
    const bool pushes = norm(one.force) > 0;
    if (pushes) {
      if (auto r = check(one.body); !r) return Error{"derivatives: " + r.error()};
      auto embedded = embed(w.said.builder.body(one.body), w.system().parts().rest, one.point, "derivatives");
      if (!embedded) return embedded.failure();
      point = std::move(embedded).value();
    } else {
      if (auto r = check(one.effect); !r) return Error{"derivatives: " + r.error()};
      const auto e = static_cast<std::size_t>(one.effect);
      amount = w.instances[e]->amount();
      if (!amount)
        return Error{"derivatives: effect \"" + w.said.sources[e]->name() + "\" has no amount to change"};
      if (w.instances[e]->amount_in_energy()) {
        return Error{"derivatives: the amount of effect \"" + w.said.sources[e]->name() +
                     "\" changes energies, which these do not follow; ask gradients()"};
      }
    }
    auto response = w.derivative(d, amount, std::move(point), one.force);
    if (!response) return response.failure();
    all.push_back(std::move(response).value());
  }
  // Last, as it evaluates the state.
  const std::string note = all.empty() ? std::string() : w.irregular().note;
  for (Response& r : all) {
    r.note = note;
    r.regular = note.empty();
    r.unstable_directions = found < 0 ? -1 : found - wanted;
  }
  return all;
} catch (const std::bad_alloc&) {
  impl_->methods.drop();
  return no_memory("derivatives");
}

}  // namespace isochor
