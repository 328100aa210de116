#include "engine/elements/relaxation_pool.h"

#include <algorithm>
#include <cmath>

#include "engine/elements/contraction.h"
#include "engine/elements/relaxation_rates.h"
#include "engine/math/lane_functions.h"

namespace isochor {

struct RelaxationPool::Point {
  Index stencil = 0;
  int point = 0;
};

// How much of a logarithmic strain is left where an increment begins and where it ends.
struct RelaxationPool::Flow {
  double before = 1, after = 1;
};

// Points on their way: F_v^-1 after the first flow, and F_e.
struct RelaxationPool::Batch {
  Lanes viscous[9], elastic[9];
};

namespace {

// C = A B, row-major.
void multiply(const Lanes A[9], const Lanes B[9], Lanes C[9]) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      C[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
  }
}

// V diag(d) V^T, row-major.
void in_frame(const Lanes V[9], const Lanes d[3], Lanes C[9]) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      C[3 * i + j] = V[3 * i] * d[0] * V[3 * j] + V[3 * i + 1] * d[1] * V[3 * j + 1] +
                     V[3 * i + 2] * d[2] * V[3 * j + 2];
    }
  }
}

}  // namespace

template <class Visit>
void RelaxationPool::for_batches(Index begin, Index end, int points, const Visit& visit) {
  Point batch[kLanes];
  int count = 0;
  for (Index s = begin; s < end; ++s) {
    for (int q = 0; q < points; ++q) {
      batch[count++] = {s, q};
      if (count < kLanes) continue;
      visit(batch, count);
      count = 0;
    }
  }
  if (count > 0) visit(batch, count);
}

RelaxationPool::RelaxationPool(std::string name, std::shared_ptr<const SolidData> data,
                               std::shared_ptr<const Material> spring, double time)
    : name_(std::move(name)),
      data_(std::move(data)),
      geometry_(name_, data_, nullptr, VolumeStrain::linear),
      spring_(std::move(spring)),
      time_(time) {
  nodes_ = data_->nodes;
  finish_topology();
}

int RelaxationPool::memory() const {
  return kNumbers * data_->points * static_cast<int>(nodes_.count());
}

RelaxationPool::Flow RelaxationPool::flow(const StencilIncrement& increment) const {
  // Where nothing has inertia time is that of the loads.
  const double dt = increment.h > 0 ? increment.h : increment.t1 - increment.t0;
  if (!(dt > 0)) return {};
  const double x = dt / time_;
  // Of times that are far apart the quotient is out of the range of numbers, or next to it.
  constexpr double nothing = 1e-300, all = 700;
  if (!(x > nothing)) return {};
  if (x > all) return {0, std::isfinite(x) ? 1 / x : 0};
  return {x / std::expm1(x), -std::expm1(-x) / x};
}

// Both steps up to the end of the stretch.
void RelaxationPool::stretch(const StencilRequest& request, const Flow& flow, const Point* points, int count,
                             Batch& batch) const {
  Lanes F[9] = {}, kept[9] = {}, axes[9] = {}, strain[3] = {};
  for (int l = 0; l < kLanes; ++l) {
    const Point& p = points[std::min(l, count - 1)];
    double at_point[9], unused = 0;
    geometry_.deformation_gradient(p.stencil, p.point, request.x, request.rest, at_point, unused);
    for (int i = 0; i < 9; ++i) F[i][l] = at_point[i];
    for (int i = 0; i < 9; i += 4) kept[i][l] = 1;
    if (request.memory.empty()) continue;
    const double* m = request.memory.data() + kNumbers * (at(p.stencil * data_->points) + at(p.point));
    for (int i = 0; i < 9; ++i) kept[i][l] += m[i];
    for (int i = 0; i < 9; ++i) axes[i][l] = m[9 + i];
    for (int i = 0; i < 3; ++i) strain[i][l] = m[18 + i];
  }
  std::copy_n(kept, 9, batch.viscous);
  if (flow.before < 1) {
    // What is left of it, less one: nothing where there are no axes yet.
    Lanes change[9], flowed[9];
    for (Lanes& v : strain) v = expm1((flow.before - 1) * v);
    in_frame(axes, strain, change);
    multiply(kept, change, flowed);
    for (int i = 0; i < 9; ++i) batch.viscous[i] += flowed[i];
  }
  multiply(F, batch.viscous, batch.elastic);
}

void RelaxationPool::evaluate(const StencilRequest& request, const StencilSlots& slots) const {
  for (Index s = request.begin; s < request.end; ++s) {
    const std::size_t n = nodes_[s].size();
    slots.energy[at(s)] = 0;
    if (request.want == Want::value) continue;
    std::fill_n(slots.gradient.begin() + nodes_.offset[at(s)], n, Vec3{});
    if (request.want == Want::hessian)
      std::fill_n(slots.hessian.begin() + hessian_offset()[at(s)], n * (n + 1) / 2, Mat3{});
  }
  const Flow f = flow(request.increment);
  for_batches(request.begin, request.end, data_->points,
              [&](const Point* points, int count) { flush(request, slots, f, points, count); });
}

// The springs at F_e: energy and its derivatives in F_e.
void RelaxationPool::respond(const StencilRequest& request, const Point* points, int count,
                             const Batch& batch, ResponseBatch& response) const {
  PointBatch at_points;
  for (int i = 0; i < 9; ++i) store(batch.elastic[i], at_points.F[i]);
  for (int l = 0; l < kLanes; ++l) {
    at_points.element[l] = points[std::min(l, count - 1)].stencil;
    at_points.J_before[l] = 1;
  }
  const bool definite = request.want == Want::hessian && request.definiteness != Definiteness::exact;
  spring_->evaluate(definite ? Want::gradient : request.want, at_points, response);
  if (!definite) return;
  Svd3 svd;
  Spectrum spectrum;
  Lanes A[45];
  svd3(batch.elastic, svd);
  spring_->spectrum(at_points, svd, spectrum);
  make_definite(request.definiteness, spectrum);
  assemble(svd, spectrum, A);
  for (int i = 0; i < 45; ++i) store(A[i], response.A[i]);
}

void RelaxationPool::stress(Index stencil, int point, std::span<const Vec3> x, std::span<const Vec3> rest,
                            std::span<const double> memory, double P[9]) const {
  StencilRequest request;
  request.want = Want::gradient;
  request.x = x;
  request.rest = rest;
  request.memory = memory;
  const Point p{stencil, point};
  Batch batch;
  ResponseBatch response;
  stretch(request, {}, &p, 1, batch);
  respond(request, &p, 1, batch, response);
  // dF_e = dF F_v^-1.
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      P[3 * i + j] = 0;
      for (int k = 0; k < 3; ++k) P[3 * i + j] += response.P[3 * i + k][0] * batch.viscous[3 * j + k][0];
    }
  }
}

void RelaxationPool::flush(const StencilRequest& request, const StencilSlots& slots, const Flow& flow,
                           const Point* points, int count) const {
  Batch batch;
  stretch(request, flow, points, count, batch);
  ResponseBatch response;
  respond(request, points, count, batch, response);
  for (int l = 0; l < count; ++l) {
    const Index s = points[l].stencil;
    const auto point = at(s * data_->points) + at(points[l].point);
    const double w = flow.after * data_->weight[point];
    slots.energy[at(s)] += w * response.psi[l];
    if (request.want == Want::value) continue;
    // dF_e = dF F_v^-1: in place of B the nodes have F_v^-T B.
    constexpr std::size_t most = 256;
    const std::size_t n = nodes_[s].size();
    const auto first = at(nodes_.offset[at(s)]);
    const Vec3* B = data_->gradient.data() + static_cast<std::size_t>(data_->points) * first +
                    static_cast<std::size_t>(points[l].point) * n;
    double P[9], A[45];
    for (int i = 0; i < 9; ++i) P[i] = response.P[i][l];
    for (int i = 0; i < 45 && request.want == Want::hessian; ++i) A[i] = response.A[i][l];
    Vec3 few[most];
    std::vector<Vec3> many(n > most ? n : 0);
    Vec3* turned = n > most ? many.data() : few;
    for (std::size_t a = 0; a < n; ++a) {
      for (int j = 0; j < 3; ++j) {
        turned[a][j] = batch.viscous[j][l] * B[a].x + batch.viscous[3 + j][l] * B[a].y +
                       batch.viscous[6 + j][l] * B[a].z;
      }
    }
    contract_gradient(P, w, turned, n, slots.gradient.data() + first);
    if (request.want == Want::hessian)
      contract_hessian(A, w, turned, n, slots.hessian.data() + hessian_offset()[at(s)]);
  }
}

void RelaxationPool::accept(const StencilRequest& request, std::span<double> memory) const {
  const Flow f = flow(request.increment);
  for_batches(0, nodes_.count(), data_->points,
              [&](const Point* points, int count) { keep(request, f, points, count, memory); });
}

// The last flow, and what the next increment has to know.
void RelaxationPool::keep(const StencilRequest& request, const Flow& flow, const Point* points, int count,
                          std::span<double> memory) const {
  Batch batch;
  stretch(request, flow, points, count, batch);
  Svd3 svd;
  svd3(batch.elastic, svd);
  Lanes e[3], grown[3], left[3], shrink[9], viscous[9];
  for (int i = 0; i < 3; ++i) e[i] = log(svd.sigma[i]);
  const Lanes mean = (e[0] + e[1] + e[2]) * (1.0 / 3);
  for (int i = 0; i < 3; ++i) {
    e[i] -= mean;
    left[i] = flow.after * e[i];
    grown[i] = exp(left[i] - e[i]);
  }
  in_frame(svd.V, grown, shrink);
  multiply(batch.viscous, shrink, viscous);
  for (int l = 0; l < count; ++l) {
    double* m = memory.data() + kNumbers * (at(points[l].stencil * data_->points) + at(points[l].point));
    if (!(svd.sigma[2][l] > 0)) continue;  // no state that a step is accepted with
    for (int i = 0; i < 9; ++i) m[i] = viscous[i][l] - (i % 4 == 0 ? 1 : 0);
    for (int i = 0; i < 9; ++i) m[9 + i] = svd.V[i][l];
    for (int i = 0; i < 3; ++i) m[18 + i] = left[i][l];
  }
}

// --- Rates -------------------------------------------------------------------------------------------------

namespace {

Small unit() {
  return {1, 0, 0, 0, 1, 0, 0, 0, 1};
}

Small deviator(Small a) {
  const double mean = (a[0] + a[4] + a[8]) / 3;
  for (std::size_t i = 0; i < 9; i += 4) a[i] -= mean;
  return a;
}

// Zero is a solid without axes yet.
Small axes_of(std::span<const double> memory) {
  Small out;
  std::copy_n(memory.begin() + 9, 9, out.begin());
  return out == Small{} ? unit() : out;
}

}  // namespace

void RelaxationPool::smooth(std::span<const double, kNumbers> memory, std::span<double, kSmooth> out) {
  Small strain{};
  for (std::size_t i = 0; i < 3; ++i) strain[4 * i] = memory[18 + i];
  const Small axes = axes_of(memory), whole = times(times(axes, strain), turned_over(axes));
  for (std::size_t i = 0; i < 9; ++i) {
    out[i] = memory[i];
    out[9 + i] = whole[i];
  }
}

// Along each number of the memory and of F in turn.
RelaxationPool::Rates RelaxationPool::rates(const StencilRequest& request, Index stencil, int point) const {
  const Flow f = flow(request.increment);
  const Point here{stencil, point};
  Batch batch;
  stretch(request, f, &here, 1, batch);
  StencilRequest exact = request;
  exact.want = Want::hessian;
  exact.definiteness = Definiteness::exact;
  ResponseBatch response;
  respond(exact, &here, 1, batch, response);
  Svd3 svd;
  svd3(batch.elastic, svd);
  Small viscous, elastic, axes_now, spring, F{};
  std::array<double, 3> e, squares;
  for (std::size_t i = 0; i < 9; ++i) {
    viscous[i] = batch.viscous[i][0];
    elastic[i] = batch.elastic[i][0];
    axes_now[i] = svd.V[i][0];
    spring[i] = response.P[i][0];
  }
  double unused = 0;
  geometry_.deformation_gradient(stencil, point, request.x, request.rest, F.data(), unused);
  const std::span<const double> kept =
      request.memory.subspan(kNumbers * (at(stencil * data_->points) + at(point)), kNumbers);
  Small before = unit();
  for (std::size_t i = 0; i < 9; ++i) before[i] += kept[i];
  const Isotropic flowed = exponential(f.before - 1, axes_of(kept), {kept[18], kept[19], kept[20]});
  for (std::size_t i = 0; i < 3; ++i) squares[i] = svd.sigma[i][0] * svd.sigma[i][0];
  const Isotropic strain = logarithm(axes_now, squares);
  const double mean = (strain.value[0] + strain.value[1] + strain.value[2]) / 3;
  for (std::size_t i = 0; i < 3; ++i) e[i] = 0.5 * (strain.value[i] - mean);
  const Isotropic shrink = exponential(f.after - 1, axes_now, e);
  Rates out;
  for (std::size_t k = 0; k < kSmooth + 9; ++k) {
    Small d_before{}, d_strain{}, d_F{};
    (k < 9 ? d_before : k < 18 ? d_strain : d_F)[k % 9] = 1;
    d_strain = scaled(0.5, sum(d_strain, turned_over(d_strain)));
    const Small d_viscous = sum(times(d_before, flowed.whole()), times(before, flowed.along(d_strain)));
    const Small d_elastic = sum(times(d_F, viscous), times(F, d_viscous));
    if (k < kSmooth) {
      Small d_spring{};
      for (int i = 0; i < 9; ++i) {
        for (int j = 0; j < 9; ++j) d_spring[at(i)] += response.A[packed(i, j)][0] * d_elastic[at(j)];
      }
      const Small d_P = sum(times(d_spring, turned_over(viscous)), times(spring, turned_over(d_viscous)));
      for (std::size_t i = 0; i < 9; ++i) out.stress[kSmooth * i + k] = f.after * d_P[i];
    }
    const Small half = times(turned_over(elastic), d_elastic);
    const Small d_e = scaled(0.5, deviator(strain.along(sum(half, turned_over(half)))));
    const Small d_kept = sum(times(d_viscous, shrink.whole()), times(viscous, shrink.along(d_e)));
    for (std::size_t i = 0; i < 9; ++i) {
      out.memory[(kSmooth + 9) * i + k] = d_kept[i];
      out.memory[(kSmooth + 9) * (9 + i) + k] = f.after * d_e[i];
    }
  }
  return out;
}

}  // namespace isochor
