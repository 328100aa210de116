#include "contract/scene_probe.h"

#include <random>
#include <stdexcept>

#include "support/meshes.h"

namespace test {

using namespace isochor;

SceneProbe::SceneProbe(const SceneCase& c) {
  BodyDef body;
  body.mesh = c.mesh;
  body.element = c.element;
  body.materials = c.materials;
  std::vector<BodyDef> bodies = {body};
  for (const Mesh& mesh : c.more_bodies) {
    bodies.push_back(body);
    bodies.back().name.append(1, ' ').append(std::to_string(bodies.size()));
    bodies.back().mesh = mesh;
  }
  compiled_ = compile(bodies, c.effects);
  if (!compiled_.system) throw std::runtime_error(c.name + ": " + compiled_.error);
  x_ = rest();
  std::mt19937 random(23);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (Vec3& p : x_) p = c.stretch * wavy(p) + 0.004 * Vec3{unit(random), unit(random), unit(random)};
}

std::vector<double> SceneProbe::multipliers(std::size_t count) const {
  std::vector<double> out(count);
  for (std::size_t i = 0; i < count; ++i) out[i] = 0.4 * std::sin(1.0 + 2.7 * static_cast<double>(i));
  return out;
}

std::vector<Vec3> SceneProbe::direction(unsigned seed) const {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Vec3> d(x_.size());
  for (Vec3& v : d) v = {unit(random), unit(random), unit(random)};
  return d;
}

std::vector<Vec3> SceneProbe::moved(std::span<const Vec3> d, double h) const {
  std::vector<Vec3> x = x_;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += h * d[i];
  return x;
}

Slots::Slots(const StencilPool& pool) {
  const double nan = std::nan("");
  const std::size_t slots = pool.nodes().item.size(), functions = static_cast<std::size_t>(pool.functions());
  energy.assign(at(pool.stencils()), nan);
  value.assign(at(pool.stencils()) * functions, nan);
  gradient.assign(slots, Vec3{nan, nan, nan});
  jacobian.assign(slots * functions, Vec3{nan, nan, nan});
  Mat3 unset;
  unset.m.fill(nan);
  hessian.assign(pool.has_hessian() ? static_cast<std::size_t>(pool.hessian_offset().back()) : 0, unset);
}

bool all_finite(const Slots& s) {
  bool finite = true;
  for (const double e : s.energy) finite = finite && std::isfinite(e);
  for (const double v : s.value) finite = finite && std::isfinite(v);
  for (const Vec3& g : s.gradient) finite = finite && std::isfinite(dot(g, g));
  for (const Vec3& g : s.jacobian) finite = finite && std::isfinite(dot(g, g));
  for (const Mat3& h : s.hessian) {
    for (const double v : h.m) finite = finite && std::isfinite(v);
  }
  return finite;
}

PoolProbe::PoolProbe(const StencilPool& pool, const SceneProbe& scene)
    : pool_(pool),
      scene_(scene),
      multiplier_(scene.multipliers(at(pool.stencils()) * static_cast<std::size_t>(pool.functions()))) {}

StencilRequest PoolProbe::request(Want want, Definiteness definiteness, Index begin, Index end,
                                  std::span<const Vec3> x, std::span<const double> multiplier) const {
  StencilRequest r{want, definiteness, begin, end, x, scene_.rest(), multiplier};
  r.increment.h = kProbeStep;
  r.increment.before = scene_.rest();
  return r;
}

Slots PoolProbe::evaluate(Want want, const std::vector<Vec3>& x) const {
  return evaluate(want, x, multiplier_);
}

Slots PoolProbe::evaluate(Want want, const std::vector<Vec3>& x, const std::vector<double>& multiplier,
                          Definiteness definiteness) const {
  Slots slots(pool_);
  pool_.evaluate(request(want, definiteness, 0, pool_.stencils(), x, multiplier), slots.spans());
  return slots;
}

Slots PoolProbe::evaluate_between(const std::vector<Vec3>& before, const std::vector<Vec3>& x) const {
  Slots slots(pool_);
  StencilRequest r = request(Want::gradient, Definiteness::exact, 0, pool_.stencils(), x, multiplier_);
  r.increment.before = before;
  pool_.evaluate(r, slots.spans());
  return slots;
}

Slots PoolProbe::evaluate_at(double t) const {
  Slots slots(pool_);
  StencilRequest r =
      request(Want::gradient, Definiteness::exact, 0, pool_.stencils(), scene_.x(), multiplier_);
  r.increment.t0 = r.increment.t1 = t;
  pool_.evaluate(r, slots.spans());
  return slots;
}

Slots PoolProbe::evaluate_split(const std::vector<Vec3>& x, Index grain) const {
  Slots slots(pool_);
  for (Index end = pool_.stencils(); end > 0; end -= grain) {
    const Index begin = std::max(Index{0}, end - grain);
    pool_.evaluate(request(Want::hessian, Definiteness::exact, begin, end, x, multiplier_), slots.spans());
  }
  return slots;
}

Slots PoolProbe::evaluate_range(const std::vector<Vec3>& x, Index begin, Index end) const {
  Slots slots(pool_);
  pool_.evaluate(request(Want::hessian, Definiteness::exact, begin, end, x, multiplier_), slots.spans());
  return slots;
}

void PoolProbe::evaluate_into(Slots& slots, Want want, Definiteness definiteness,
                              const std::vector<Vec3>& x) const {
  pool_.evaluate(request(want, definiteness, 0, pool_.stencils(), x, multiplier_), slots.spans());
}

Eigen::MatrixXd PoolProbe::dense_hessian(const Slots& slots, Index stencil) const {
  const auto n = static_cast<Eigen::Index>(pool_.nodes()[stencil].size());
  Eigen::MatrixXd H(3 * n, 3 * n);
  auto block = static_cast<std::size_t>(pool_.hessian_offset()[at(stencil)]);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b <= a; ++b, ++block) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          H(3 * a + i, 3 * b + j) = slots.hessian[block](i, j);
          H(3 * b + j, 3 * a + i) = slots.hessian[block](i, j);
        }
      }
    }
  }
  return H;
}

}  // namespace test
