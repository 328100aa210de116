#include "studies/torture_bench.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "studies/judge.h"

namespace isochor::studies {

namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double length(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

// Moves each node by up to a twentieth of the shortest edge at it; nodes on a plane of the bounding box stay
// in it, and nodes of any other surface stay where they are.
void jitter(Mesh& mesh, unsigned seed) {
  constexpr double share = 0.05;
  std::vector<double> edge(mesh.nodes.size(), std::numeric_limits<double>::infinity());
  const auto corners = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  for (std::size_t c = 0; c + corners <= mesh.cells.size(); c += corners) {
    for (std::size_t a = 0; a < corners; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const auto i = static_cast<std::size_t>(mesh.cells[c + a]),
                   j = static_cast<std::size_t>(mesh.cells[c + b]);
        const double l = length(mesh.nodes[i] - mesh.nodes[j]);
        edge[i] = std::min(edge[i], l);
        edge[j] = std::min(edge[j], l);
      }
    }
  }
  Vec3 lower = mesh.nodes[0], upper = lower;
  for (const Vec3& x : mesh.nodes) {
    for (int k = 0; k < 3; ++k) {
      lower[k] = std::min(lower[k], x[k]);
      upper[k] = std::max(upper[k], x[k]);
    }
  }
  const double size = length(upper - lower);
  std::vector<bool> on_surface(mesh.nodes.size(), false);
  for (const MeshSurface& s : mesh.surfaces) {
    for (const Index i : s.faces) on_surface[static_cast<std::size_t>(i)] = true;
  }
  TortureNoise noise(seed);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    Vec3& x = mesh.nodes[i];
    const Vec3 was = x;
    bool planar = false;
    for (int k = 0; k < 3; ++k) {
      const double move = share * edge[i] * noise.next();
      const bool in_plane =
          std::abs(was[k] - lower[k]) < 1e-9 * size || std::abs(was[k] - upper[k]) < 1e-9 * size;
      planar = planar || in_plane;
      if (!in_plane) x[k] += move;
    }
    if (on_surface[i] && !planar) x = was;
  }
}

}  // namespace

std::string_view to_string(TortureVerdict verdict) {
  switch (verdict) {
    case TortureVerdict::solved:
      return "solved";
    case TortureVerdict::told:
      return "told";
    case TortureVerdict::stopped:
      return "stopped";
    case TortureVerdict::broken:
      break;
  }
  return "broken";
}

ElasticConstants torture_constants(const TortureSettings& settings, double young) {
  ElasticConstants c;
  c.young = young;
  c.poisson = settings.poisson;
  return c;
}

TortureBench::TortureBench(const TortureSettings& settings, WorldOptions options) : settings_(settings) {
  if (!options.scheme) {
    options.scheme = settings.step > 0 ? (settings.scheme ? settings.scheme : implicit_euler()) : statics();
  }
  // In statics gravity grows with the load factor, so that increments can be cut.
  if (settings.step <= 0) options.gravity_curve = Curve::ramp(1);
  options.method = settings.method;
  options.threads = 1;
  auto world = World::create(std::move(options));
  if (world)
    world_.emplace(std::move(world).value());
  else
    refusal_ = world.error();
}

void TortureBench::add_body(Result<Mesh> mesh, const Result<MaterialPtr>& material, double density,
                            bool lives_through_inversion) {
  lives_through_inversion_ = lives_through_inversion;
  if (ok() && !mesh) refusal_ = mesh.error();
  if (ok() && !material) refusal_ = material.error();
  if (!ok()) return;
  BodyDef def;
  def.mesh = std::move(mesh).value();
  if (settings_.seed > 0) jitter(def.mesh, settings_.seed);
  def.element = settings_.element;
  def.materials = {{"", material.value(), density}};
  auto id = world_->add_body(std::move(def));
  if (!id) {
    refusal_ = id.error();
    return;
  }
  body_ = id.value();
  if (settings_.one_field) return;
  VolumeDef rows;
  rows.body = body_;
  add(volume(rows));
}

std::optional<EffectId> TortureBench::hold(std::vector<std::string> surfaces, std::vector<Vec3> directions) {
  DirichletDef def;
  def.name = "hold";
  for (const auto& s : surfaces) def.name += " " + s;
  def.where.body = body_;
  def.where.surfaces = std::move(surfaces);
  def.directions = std::move(directions);
  return add(dirichlet(def));
}

void TortureBench::take(const StepReport& report, TortureResult& out) const {
  out.iterations += report.iterations;
  out.cutbacks += report.rejected_substeps;
  out.shifted += report.shifted;
  out.projected += report.projected;
  out.rescues += report.rescues;
  out.stand_ins += report.dual.stand_ins;
  out.seconds += report.seconds.total;
}

TortureResult TortureBench::refused() const {
  TortureResult out;
  out.verdict = TortureVerdict::told;
  out.reason = refusal_;
  return out;
}

TortureResult TortureBench::judge(TortureResult out, const StepReport& last, bool equilibrium_exists) {
  const BodyMeasures m = world_->measures(body_);
  out.volume_row_residual = m.volume_row_residual;
  out.min_J = m.min_J;
  // A start that is crushed or turned over has no guard until it has come right.
  const bool guarded = !lives_through_inversion_;
  const StateJudge state(
      *world_, {simple_promise(*world_, body_, settings_.element, lives_through_inversion_, guarded)});
  std::vector<std::string> said = world_->warnings();
  said.push_back(last.warning);
  // The state of a run that was refused at its start is the start.
  const bool moved = out.reached > 0 && last.status != StepStatus::invalid;
  if (const auto wrong = moved ? state.accepted(*world_, said, {}) : state.finite(*world_)) {
    out.verdict = TortureVerdict::broken;
    out.reason = wrong->text;
    return out;
  }
  if (last.status == StepStatus::invalid) {
    out.verdict = TortureVerdict::told;
    out.reason = last.reason;
    return out;
  }
  // The rows of an accepted state hold, however it ended.
  if (out.reached > 0 && m.volume_row_residual > 1e-8) {
    out.verdict = TortureVerdict::broken;
    out.reason = "volume rows are off by " + std::to_string(m.volume_row_residual);
    return out;
  }
  if (last.status == StepStatus::converged) {
    out.verdict = TortureVerdict::solved;
    return out;
  }
  out.verdict = equilibrium_exists ? TortureVerdict::stopped : TortureVerdict::told;
  out.reason = last.reason;
  return out;
}

TortureResult TortureBench::run(bool equilibrium_exists) {
  if (!ok()) return refused();
  if (settings_.step > 0)
    return march(settings_.step, std::clamp(static_cast<int>(0.15 / settings_.step), 3, 30));
  TortureResult out;
  const double start = seconds_now();
  const StepReport report = world_->advance(1);
  take(report, out);
  out.steps = 1;
  out.seconds = seconds_now() - start;
  out.reached = world_->time();
  return judge(std::move(out), report, equilibrium_exists);
}

TortureResult TortureBench::march(double h, int steps) {
  if (!ok()) return refused();
  TortureResult out;
  const double start = seconds_now();
  StepReport report;
  (void)world_->compile();  // the state is there from then on; errors come back with the first step
  for (; out.steps < steps; ++out.steps) {
    const std::uint64_t before = world_->state_hash();
    const double t = world_->time();
    report = world_->advance(h);
    take(report, out);
    if (report.status == StepStatus::converged) continue;
    if (world_->time() == t && world_->state_hash() != before) {
      out.verdict = TortureVerdict::broken;
      out.reason = "a rejected step changed the state";
      return out;
    }
    break;
  }
  out.seconds = seconds_now() - start;
  out.reached = static_cast<double>(out.steps) / steps;
  return judge(std::move(out), report, true);
}

}  // namespace isochor::studies
