// Gradients of an equilibrium. Outline of a query:
//   1. The state is looked at: forces and rows in balance? Then evaluated with Hessians and factored as it
//   is.
//   2. Every output becomes a right-hand side: how it depends on positions, multipliers and supports' forces.
//   3. Adjoint: one solve an output; then each parameter is what the solution makes of the change dR/dp that
//      it brings to the equations. Tangent: one solve a parameter with dR/dp; then each output along it.
// The matrix is symmetric but where friction is coupled, so both use the same factors; there the adjoint is
// found from solves with the matrix itself (solve_transposed()).
#include "isochor/gradients.h"

#include <algorithm>
#include <cmath>

#include "engine/base/out_of_memory.h"
#include "engine/base/text.h"
#include "engine/solvers/gmres.h"
#include "engine/step/time_scheme.h"
#include "engine/world/gradient_parts.h"

namespace isochor {

namespace {

double largest(std::span<const Vec3> list) {
  double out = 0;
  for (const Vec3& v : list) out = std::max(out, norm(v));
  return out;
}

double largest(std::span<const double> list) {
  double out = 0;
  for (const double v : list) out = std::max(out, std::abs(v));
  return out;
}

Result<void> check_memory(const Builder& builder) {
  for (const BodyData& body : builder.bodies()) {
    for (const RegionData& region : body.regions) {
      if (!body.present() || !region.remembers) continue;
      return Error{"gradients: body \"" + body.name + "\", region \"" + region.name + "\": the material " +
                   std::string(region.material->name()) +
                   " remembers what came before, which gradients do not follow; take its law without that, "
                   "or make the statics of a series long-term"};
    }
  }
  return {};
}

}  // namespace

World::Impl::Equilibrium::Equilibrium(Impl& world, const Inertia* its_inertia)
    : w(world),
      inertia(its_inertia),
      method(world.methods.chosen()),
      dx(world.state.x.size()),
      dlambda(world.state.lambda.size()) {}

// To rounding, what a scene that was compiled again has in place of the present one.
bool World::Impl::Equilibrium::is_here(Equations off) const {
  off.add(-1, here);
  double row = 0;
  for (std::size_t r = 0; r < off.theta.size(); ++r)
    row = std::max(row, std::abs(off.theta[r]) / w.system().row_measure()[r]);
  return largest(off.force) <= 1e-9 * force_scale_ && row <= 1e-9 &&
         largest(off.position) <= 1e-12 * w.system().length();
}

// A state that was not solved for, or of a body in motion, has no derivative by these equations.
Result<void> World::Impl::Equilibrium::check_balance() {
  constexpr double limit = 1e-5;
  const System& s = w.system();
  here = equations_at(present(), w.state, watched);
  std::vector<double> magnitude(here.force.size());
  w.assembly().residual_magnitude(magnitude);
  // Where nothing is strained, forces are rounding errors of a stiff body.
  constexpr double nothing = 1e-9;
  force_scale_ = std::max(largest(magnitude), nothing * largest(method.rest_stiffness()) * s.length());
  double force = 0, row = 0, position = 0;
  for (Index i = 0; i < s.nodes(); ++i) {
    Vec3 q = s.unknowns().to_free(i, here.force[at(i)]);
    for (int c = s.unknowns().of(i); c < 3; ++c) q[c] = 0;
    force = std::max(force, norm(q) / force_scale_);
  }
  for (std::size_t r = 0; r < here.theta.size(); ++r) {
    double theta = here.theta[r];
    if (s.has_bounds()) {
      const double d = s.row_metric()[r], l = w.state.lambda[r];
      theta = d * (std::clamp(l + theta / d, s.row_lower()[r], s.row_upper()[r]) - l);
    }
    row = std::max(row, std::abs(theta) / s.row_measure()[r]);
  }
  std::vector<Vec3> gap(s.free_bases().size());
  for (Index i = 0; i < s.nodes(); ++i) {
    if (const Index b = s.basis_of()[at(i)]; b >= 0) gap[at(b)] = here.position[at(b)] - w.state.x[at(i)];
  }
  position = largest(way_of(gap)) / s.length();
  if (force <= limit && row <= limit && position <= limit) return {};
  return Error{"gradients: the state is no equilibrium: forces are out of balance by " + number(force) +
               " of the largest, rows by " + number(row) + " of their measure, supports by " +
               number(position) + " of the scene's length; advance in statics until it is one"};
}

Result<void> World::Impl::Equilibrium::linearize(bool unstable) {
  if (auto r = check_balance(); !r) return r;
  if (!method.linearize(problem(), w.state.x, w.state.lambda, report)) {
    if (report.status == SaddleStatus::converged) {
      return Error{"gradients: method " + w.methods.description() +
                   " has no factors of the whole system; leave WorldOptions::method automatic"};
    }
    return Error{"gradients: the matrix of the equilibrium is singular" +
                 (report.message.empty() ? std::string() : " (" + report.message + ")") +
                 ": a limit point, or a body that nothing holds; move the load away from there"};
  }
  if (w.system().has_lag()) {
    evaluate_here();
    lag.emplace(w.system(), w.assembly(), w.state.x);
  }
  const Index directions = report.negative_pivots < 0 ? 0 : report.negative_pivots - w.system().rows();
  if (directions == 0 || unstable) return {};
  return Error{"gradients: the equilibrium is unstable in " + std::to_string(directions) +
               (directions == 1 ? " direction" : " directions") +
               " (behind a limit point, or buckled); set GradientQuery::unstable if that is meant"};
}

// The step of the same problem with other loads, targets and given positions.
Result<void> World::Impl::Equilibrium::respond(double factor, std::span<const Vec3> load,
                                               std::span<const double> row, std::span<const Vec3> way,
                                               std::vector<Vec3>& x, std::vector<double>& lambda) {
  SaddleProblem p = problem();
  std::vector<Vec3> force(p.force.begin(), p.force.end()), position(p.position.begin(), p.position.end());
  std::vector<double> target(p.target.begin(), p.target.end());
  for (std::size_t i = 0; i < force.size(); ++i) force[i] += factor * load[i];
  for (std::size_t r = 0; r < target.size(); ++r) target[r] += factor * row[r];
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (const Index b = w.system().basis_of()[i]; b >= 0) position[at(b)] += factor * way[i];
  }
  p.force = force;
  p.target = target;
  p.position = position;
  if (!method.respond(p, x, lambda, report)) return Error{"gradients: the linear system was not solved"};
  return {};
}

// What is solved is linear in the right-hand side; the difference of two steps is free of what the state
// itself is off.
Result<void> World::Impl::Equilibrium::solve(std::span<const Vec3> load, std::span<const double> row,
                                             std::span<const Vec3> way) {
  // As large as the numbers that it is added to.
  double scale = std::numeric_limits<double>::infinity();
  const auto take = [&](double part, double size) {
    if (part > 0 && size > 0) scale = std::min(scale, size / part);
  };
  take(largest(load), force_scale_);
  take(largest(row),
       row.empty() ? 0 : *std::max_element(w.system().row_measure().begin(), w.system().row_measure().end()));
  take(largest(way), w.system().length());
  if (!std::isfinite(scale)) {
    std::fill(dx.begin(), dx.end(), Vec3{});
    std::fill(dlambda.begin(), dlambda.end(), 0.0);
    return {};
  }
  std::vector<Vec3> x(dx.size());
  std::vector<double> lambda(dlambda.size());
  if (auto r = respond(scale, load, row, way, dx, dlambda); !r) return r;
  if (auto r = respond(-scale, load, row, way, x, lambda); !r) return r;
  for (std::size_t i = 0; i < x.size(); ++i) dx[i] = (0.5 / scale) * (dx[i] - x[i]);
  for (std::size_t r = 0; r < lambda.size(); ++r) dlambda[r] = (0.5 / scale) * (dlambda[r] - lambda[r]);
  return {};
}

bool names_effect(const Output& o) {
  return o.kind == Output::Kind::gauge || o.kind == Output::Kind::reaction || o.kind == Output::Kind::force;
}

bool names_effect(const Parameter& p) {
  return p.kind == Parameter::Kind::amount || p.kind == Parameter::Kind::constant ||
         p.kind == Parameter::Kind::curve;
}

// With A^T = A + D, where D = [L^T - L, -l; l^T, 0] is about what rubs alone, z = A^-1 (b + w) and
//   w + D A^-1 w = - D A^-1 b,
// which takes few steps of GMRES, each a solve with A.
Result<void> World::Impl::Equilibrium::solve_transposed(std::span<const Vec3> load,
                                                        std::span<const double> row) {
  const std::vector<Vec3> nowhere(load.size());
  if (auto r = solve(load, row, nowhere); !r || !lag) return r;
  const std::size_t nodes = load.size(), size = 3 * nodes + row.size();
  constexpr int most = 60;
  constexpr double exact = 1e-13;
  const std::span<const double> measure = w.system().row_measure();
  // D z as numbers of about the same size, from dx and dlambda.
  const auto turned = [&](std::span<double> out) {
    std::vector<Vec3> along(nodes), back(nodes);
    std::vector<double> rows(row.size(), 0.0);
    lag->add(dx, dlambda, along);
    lag->add_transposed(1, dx, back, rows);
    for (std::size_t i = 0; i < nodes; ++i) {
      for (int c = 0; c < 3; ++c) out[3 * i + at(c)] = (back[i][c] - along[i][c]) / force_scale_;
    }
    for (std::size_t r = 0; r < rows.size(); ++r) out[3 * nodes + r] = rows[r] / measure[r];
  };
  std::vector<Vec3> force(nodes);
  std::vector<double> target(row.size());
  Result<void> solved;
  const auto apart = [&](std::span<const double> v) {
    for (std::size_t i = 0; i < nodes; ++i) {
      for (int c = 0; c < 3; ++c) force[i][c] = force_scale_ * v[3 * i + at(c)];
    }
    for (std::size_t r = 0; r < target.size(); ++r) target[r] = measure[r] * v[3 * nodes + r];
  };
  const auto times = [&](std::span<const double> v, std::span<double> out) {
    apart(v);
    if (solved) solved = solve(force, target, nowhere);
    turned(out);
    for (std::size_t i = 0; i < size; ++i) out[i] += v[i];
  };
  std::vector<double> right(size), found(size, 0.0);
  turned(right);
  for (double& v : right) v = -v;
  Gmres gmres(size, most, Gmres::Directions::made_again);
  const int steps = gmres.solve(right, found, exact, times, [](std::span<double>) { return true; });
  if (!solved) return solved;
  if (steps < 0 || !(gmres.left() <= 1e-9 * gmres.start_norm()))
    return Error{"gradients: the transposed system was not solved; ask for tangents"};
  apart(found);
  for (std::size_t i = 0; i < nodes; ++i) force[i] += load[i];
  for (std::size_t r = 0; r < target.size(); ++r) target[r] += row[r];
  return solve(force, target, nowhere);
}

namespace {

bool is_cells(const Parameter& p) {
  return p.kind == Parameter::Kind::cells;
}

// Whether outputs are solved for, or parameters.
Result<bool> choose_adjoint(const GradientQuery& q, bool unsymmetric) {
  const bool cells = std::any_of(q.parameters.begin(), q.parameters.end(), is_cells);
  const bool wants_adjoint = q.mode == GradientQuery::Mode::adjoint;
  if (cells && q.mode == GradientQuery::Mode::tangent)
    return Error{
        "gradients: cell_stiffness is a number a cell, and tangents would solve as often; ask by the "
        "adjoint"};
  if (cells || wants_adjoint) return true;
  if (unsymmetric || q.mode == GradientQuery::Mode::tangent) return false;
  return q.outputs.size() <= q.parameters.size();
}

// The error with the place of what it is about: "gradients: outputs[2]: ...".
Error placed(const Error& error, const char* list, std::size_t k) {
  constexpr std::string_view call = "gradients: ";
  if (error.kind == ErrorKind::no_memory || !error.message.starts_with(call)) return error;
  return Error{std::string(call) + list + "[" + std::to_string(k) +
               "]: " + error.message.substr(call.size())};
}

// Effects that a query names.
Result<void> check_effects(const World& world, const GradientQuery& query) {
  const auto check = [&](EffectId e, const char* list, std::size_t k) -> Result<void> {
    if (auto r = world.check(e); !r) return placed(Error{"gradients: " + r.error()}, list, k);
    return {};
  };
  for (std::size_t j = 0; j < query.outputs.size(); ++j) {
    if (!names_effect(query.outputs[j])) continue;
    if (auto r = check(query.outputs[j].effect, "outputs", j); !r) return r;
  }
  for (std::size_t k = 0; k < query.parameters.size(); ++k) {
    if (!names_effect(query.parameters[k])) continue;
    if (auto r = check(query.parameters[k].effect, "parameters", k); !r) return r;
  }
  return {};
}

}  // namespace

Result<Gradients> World::gradients(const GradientQuery& query) try {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r.failure();
  if (w.settled)
    return Error{"gradients: the state is unfinished, no equilibrium; take a step without a budget first"};
  if (w.options.scheme->has_inertia()) {
    return Error{
        "gradients: the scheme has inertia; gradients are those of statics, so make the world with "
        "statics() or continuation()"};
  }
  if (auto r = check_memory(w.said.builder); !r) return r.failure();
  if (auto r = check_effects(*this, query); !r) return r.failure();
  Impl::Equilibrium eq(w);
  for (std::size_t j = 0; j < query.outputs.size(); ++j) {
    if (auto r = eq.watch(query.outputs[j]); !r) return placed(r.failure(), "outputs", j);
  }
  const auto adjoint = choose_adjoint(query, w.system().has_lag());
  if (!adjoint) return adjoint.failure();
  const auto& treated = w.system().treated();
  if (adjoint.value() && w.system().has_lag() && !(treated.bordered.empty() && treated.dual.empty()))
    return Error{
        "gradients: with friction, or a pressure on faces with a free rim, the matrix is unsymmetric, and "
        "some of "
        "its rows are eliminated by borders or in the dual, which its adjoint does not follow; ask for "
        "tangents"};
  if (auto r = eq.linearize(query.unstable); !r) return r.failure();

  Gradients out;
  out.adjoint = adjoint.value();
  std::vector<OutputSeed> seeds;
  for (std::size_t j = 0; j < query.outputs.size(); ++j) {
    auto seed = eq.seed_of(query.outputs[j]);
    if (!seed) return placed(seed.failure(), "outputs", j);
    out.values.push_back(seed.value().value);
    seeds.push_back(std::move(seed).value());
  }
  std::vector<Adjoint> adjoints;
  for (std::size_t j = 0; out.adjoint && j < seeds.size(); ++j) {
    auto a = eq.adjoint_of(seeds[j]);
    if (!a) return a.failure();
    adjoints.push_back(std::move(a).value());
  }
  out.by.assign(seeds.size(), std::vector<std::vector<double>>(query.parameters.size()));
  for (std::size_t k = 0; k < query.parameters.size(); ++k) {
    const Parameter& p = query.parameters[k];
    if (is_cells(p)) {
      for (std::size_t j = 0; j < seeds.size(); ++j) {
        auto cells = eq.by_cells(seeds[j], adjoints[j], p.body);
        if (!cells) return placed(cells.failure(), "parameters", k);
        out.by[j][k] = std::move(cells).value();
      }
      continue;
    }
    auto change = eq.change_by(p);
    if (!change) return placed(change.failure(), "parameters", k);
    if (!out.adjoint) {
      Equations load(w.system(), eq.watched.size());
      load.add(-1, change.value());
      if (auto r = eq.solve(load.force, load.theta, eq.way_of(change.value().position)); !r)
        return r.failure();
    }
    for (std::size_t j = 0; j < seeds.size(); ++j) {
      out.by[j][k] = {out.adjoint ? eq.by_adjoint(seeds[j], adjoints[j], change.value())
                                  : eq.by_tangent(seeds[j], change.value())};
    }
  }
  // Last, as it evaluates the state.
  auto irregular = w.irregular();
  out.regular = irregular.note.empty();
  out.note = std::move(irregular.note);
  out.undecided = std::move(irregular.effects);
  return out;
} catch (const std::bad_alloc&) {
  impl_->methods.drop();
  return no_memory("gradients");
}

}  // namespace isochor
