#include "engine/elements/solid_pool.h"

#include <algorithm>
#include <cmath>

#include "engine/elements/solid_point.h"
#include "engine/elements/volume_strain.h"

namespace isochor {

// One point of one stencil on its way through a batch.
struct SolidPool::Lane {
  Index stencil = 0;
  int point = 0;
  double F[9] = {};
  double volume_strain = 0;  // J - 1 without cancellation
  VolumeResponse mean{};     // of the mean of J, where the strain is of it
};

namespace {

VolumeResponse point_response(VolumeStrain strain, double j_minus_1) {
  if (strain == VolumeStrain::linear) return {j_minus_1, 1, 0};
  const double J = 1 + j_minus_1;
  if (J <= 0) return {-std::numeric_limits<double>::infinity(), 0, 0};
  if (strain != VolumeStrain::logarithmic) return volume_response(strain, j_minus_1);
  return {std::log1p(j_minus_1), 1 / J, -1 / (J * J)};
}

}  // namespace

SolidPool::SolidPool(std::string name, std::shared_ptr<const SolidData> data,
                     std::shared_ptr<const Material> material, VolumeStrain strain)
    : name_(std::move(name)),
      material_(std::move(material)),
      strain_(strain),
      shared_(std::move(data)),
      data_(*shared_) {
  if (material_) looks_back_below_ = material_->looks_back_below();
  remembers_ = material_ && material_->remembers();
  nodes_ = data_.nodes;
  finish_topology();
}

StencilFacets SolidPool::facets() const {
  StencilFacets f;
  if (remembers_) f.remembering = this;
  return f;
}

void SolidPool::elastic_gradient(const StencilRequest& request, Index stencil, int point, double F[9]) const {
  double unused = 0;
  deformation_gradient(stencil, point, request.x, request.rest, F, unused);
}

void SolidPool::accept(const StencilRequest& request, std::span<double> memory) const {
  PointBatch batch;
  double next[kLanes];
  const int all = SolidPool::memory();
  for (int first = 0; first < all; first += kLanes) {
    for (int l = 0; l < kLanes; ++l) {
      const int p = std::min(first + l, all - 1);
      const Index s = p / data_.points;
      double F[9];
      elastic_gradient(request, s, p % data_.points, F);
      for (int i = 0; i < 9; ++i) batch.F[i][l] = F[i];
      batch.element[l] = s;
      batch.J_before[l] = 1;
      batch.kept[l] = next[l] = memory[at(p)];
    }
    material_->keep(batch, next);
    for (int l = 0; l < kLanes && first + l < all; ++l) memory[at(first + l)] = next[l];
  }
}

double SolidPool::volume(Index stencil) const {
  double v = 0;
  for (int q = 0; q < data_.points; ++q) v += data_.weight[at(stencil * data_.points + q)];
  return v;
}

void SolidPool::deformation_gradient(Index stencil, int point, std::span<const Vec3> x,
                                     std::span<const Vec3> rest, double F[9], double& volume_strain) const {
  const auto nodes = nodes_[stencil];
  const Vec3* B = data_.gradient.data() +
                  static_cast<std::size_t>(data_.points) * at(nodes_.offset[at(stencil)]) +
                  static_cast<std::size_t>(point) * nodes.size();
  // Displacements against the first node: exact at rest and under translation, and J - 1 keeps all its
  // digits.
  double h[9] = {};
  const Vec3 u0 = x[at(nodes[0])] - rest[at(nodes[0])];
  for (std::size_t a = 1; a < nodes.size(); ++a) {
    const Vec3 u = x[at(nodes[a])] - rest[at(nodes[a])] - u0;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) h[3 * i + k] += u[i] * B[a][k];
    }
  }
  double c[9];
  cofactor(h, c);
  const double trace = h[0] + h[4] + h[8];
  const double second = c[0] + c[4] + c[8];
  const double third = h[0] * c[0] + h[1] * c[1] + h[2] * c[2];
  volume_strain = trace + second + third;
  for (int i = 0; i < 9; ++i) F[i] = h[i] + (i % 4 == 0 ? 1.0 : 0.0);
}

void SolidPool::clear(const StencilRequest& request, const StencilSlots& slots) const {
  const std::size_t functions = static_cast<std::size_t>(data_.functions);
  for (Index s = request.begin; s < request.end; ++s) {
    const std::size_t n = nodes_[s].size(), first = at(nodes_.offset[at(s)]);
    slots.energy[at(s)] = 0;
    std::fill_n(slots.value.data() + at(s) * functions, functions, 0.0);
    if (request.want == Want::value) continue;
    std::fill_n(slots.gradient.data() + first, n, Vec3{});
    std::fill_n(slots.jacobian.data() + first * functions, n * functions, Vec3{});
    if (request.want == Want::hessian)
      std::fill_n(slots.hessian.data() + hessian_offset()[at(s)], n * (n + 1) / 2, Mat3{});
  }
}

void SolidPool::evaluate(const StencilRequest& request, const StencilSlots& slots) const {
  clear(request, slots);
  Lane lanes[kLanes];
  int count = 0;
  const bool of_mean = is_of_mean(strain_) && data_.functions > 0;
  for (Index s = request.begin; s < request.end; ++s) {
    const double mean = of_mean ? mean_volume_strain(s, request.x, request.rest) : 0;
    for (int q = 0; q < data_.points; ++q) {
      Lane& lane = lanes[count++];
      lane.stencil = s;
      lane.point = q;
      deformation_gradient(s, q, request.x, request.rest, lane.F, lane.volume_strain);
      if (of_mean) {
        // Each point contributes to the mean in proportion; how Phi bends is added cell by cell.
        lane.mean = volume_response(strain_, mean);
        lane.mean.second = 0;
      }
      if (count == kLanes) {
        flush(request, slots, lanes, count);
        count = 0;
      }
    }
  }
  if (count > 0) flush(request, slots, lanes, count);
  if (of_mean && request.want == Want::hessian) add_bending_of_mean(request, slots);
}

void SolidPool::flush(const StencilRequest& request, const StencilSlots& slots, Lane* lanes,
                      int count) const {
  const bool definite = request.want == Want::hessian && request.definiteness != Definiteness::exact;
  PointBatch batch;
  ResponseBatch response;
  if (material_ || definite) {
    for (int l = 0; l < kLanes; ++l) {
      const Lane& lane = lanes[std::min(l, count - 1)];
      for (int i = 0; i < 9; ++i) batch.F[i][l] = lane.F[i];
      batch.element[l] = lane.stencil;
      batch.J_before[l] = 1;
      if (remembers_) batch.kept[l] = kept(request.memory, lane.stencil, lane.point);
      if (1 + lane.volume_strain >= looks_back_below_ || request.increment.before.empty()) continue;
      double F[9];
      deformation_gradient(lane.stencil, lane.point, request.increment.before, request.rest, F,
                           batch.J_before[l]);
      batch.J_before[l] += 1;
    }
  }
  if (material_) material_->evaluate(definite ? Want::gradient : request.want, batch, response);
  if (definite) definite_hessian(request, lanes, count, batch, response);
  for (int l = 0; l < count; ++l) {
    double P[9] = {}, A[45] = {};
    const double psi = material_ ? response.psi[l] : 0;
    if (material_ && request.want != Want::value) {
      for (int i = 0; i < 9; ++i) P[i] = response.P[i][l];
    }
    if (definite || (material_ && request.want == Want::hessian)) {
      for (int i = 0; i < 45; ++i) A[i] = response.A[i][l];
    }
    write(request, slots, lanes[l], psi, P, A);
  }
  // A logarithm of what is inside out: no value, whatever the material says.
  if (!has_logarithm(strain_) || data_.functions == 0) return;
  for (int l = 0; l < count; ++l) {
    if (is_of_mean(strain_) ? std::isinf(lanes[l].mean.value) : 1 + lanes[l].volume_strain <= 0)
      slots.energy[at(lanes[l].stencil)] = std::numeric_limits<double>::infinity();
  }
}

double SolidPool::strain_multiplier(const StencilRequest& request, const Lane& lane) const {
  const std::size_t functions = static_cast<std::size_t>(data_.functions);
  const double* N = data_.shape.data() + static_cast<std::size_t>(lane.point) * functions;
  double sigma = 0;
  for (std::size_t k = 0; k < functions; ++k) {
    sigma += N[k] * request.function_multiplier[at(lane.stencil) * functions + k];
  }
  return sigma;
}

void SolidPool::definite_hessian(const StencilRequest& request, const Lane* lanes, int count,
                                 const PointBatch& batch, ResponseBatch& response) const {
  Lanes first = {}, second = {};
  for (int l = 0; l < count && data_.functions > 0; ++l) {
    const double sigma = strain_multiplier(request, lanes[l]);
    if (sigma == 0) continue;
    const VolumeResponse phi =
        is_of_mean(strain_) ? lanes[l].mean : point_response(strain_, lanes[l].volume_strain);
    first[l] = sigma * phi.first;
    second[l] = sigma * phi.second;
  }
  definite_point_hessian(request.definiteness, material_.get(), batch, first, second, response);
}

void SolidPool::write(const StencilRequest& request, const StencilSlots& slots, const Lane& lane, double psi,
                      const double* P_material, const double* A_material) const {
  const Index s = lane.stencil;
  const double w = data_.weight[at(s * data_.points + lane.point)];
  slots.energy[at(s)] += w * psi;
  const std::size_t functions = static_cast<std::size_t>(data_.functions);
  const double* N = data_.shape.data() + static_cast<std::size_t>(lane.point) * functions;
  VolumeResponse phi{};
  double sigma = 0;  // multiplier of the volume strain at this point
  if (functions > 0) {
    phi = is_of_mean(strain_) ? lane.mean : point_response(strain_, lane.volume_strain);
    for (std::size_t k = 0; k < functions; ++k) slots.value[at(s) * functions + k] += w * N[k] * phi.value;
    if (request.want != Want::value) sigma = strain_multiplier(request, lane);
  }
  if (request.want == Want::value) return;

  const std::size_t n = nodes_[s].size();
  const auto first = at(nodes_.offset[at(s)]);
  const Vec3* B = data_.gradient.data() + static_cast<std::size_t>(data_.points) * first +
                  static_cast<std::size_t>(lane.point) * n;
  double P[9], g[9] = {};
  if (functions > 0) cofactor(lane.F, g);
  for (int i = 0; i < 9; ++i) P[i] = P_material[i] + sigma * phi.first * g[i];
  contract_gradient(P, w, B, n, slots.gradient.data() + first);
  for (std::size_t a = 0; functions > 0 && a < n; ++a) {
    const Vec3 d = (w * phi.first) * Vec3{g[0] * B[a].x + g[1] * B[a].y + g[2] * B[a].z,
                                          g[3] * B[a].x + g[4] * B[a].y + g[5] * B[a].z,
                                          g[6] * B[a].x + g[7] * B[a].y + g[8] * B[a].z};
    for (std::size_t k = 0; k < functions; ++k) slots.jacobian[first * functions + k * n + a] += N[k] * d;
  }
  if (request.want != Want::hessian) return;

  double A[45];
  std::copy_n(A_material, 45, A);
  // A definite one holds the share of the volume rows already.
  if (sigma != 0 && request.definiteness == Definiteness::exact)
    add_volume_hessian(lane.F, g, sigma * phi.first, sigma * phi.second, A);
  contract_hessian(A, w, B, n, slots.hessian.data() + hessian_offset()[at(s)]);
}

}  // namespace isochor
