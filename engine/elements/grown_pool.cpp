#include "engine/elements/grown_pool.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/elements/solid_point.h"
#include "engine/elements/volume_strain.h"

namespace isochor {

// One point of one stencil on its way through a batch.
struct GrownPool::Lane {
  Index stencil = 0;
  int point = 0;
  GrownState grown{};
  double root = 1;           // of det F_g
  double F[9] = {};          // F_e
  double volume_strain = 0;  // det F_e - 1
  VolumeResponse phi{};
  double sigma = 0;  // multiplier of Phi over the root: a pressure
};

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void times(const double A[9], const double B[9], double C[9]) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      C[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
  }
}

}  // namespace

double GrownPool::grown_mean(Index stencil, const GrownState& grown, const StencilRequest& request) const {
  return (mean_volume_strain(stencil, request.x, request.rest) - (grown.J - 1)) / grown.J;
}

void GrownPool::elastic_gradient(const StencilRequest& request, Index stencil, int point, double F[9]) const {
  double whole[9], unused = 0;
  deformation_gradient(stencil, point, request.x, request.rest, whole, unused);
  times(whole, growth_->at(stencil, growth_->amount->at(request.increment.t1)).inverse, F);
}

void GrownPool::evaluate(const StencilRequest& request, const StencilSlots& slots) const {
  clear(request, slots);
  const double amount = growth_->amount->at(request.increment.t1);
  const bool of_mean = is_of_mean(strain_) && data_.functions > 0;
  Lane lanes[kLanes];
  int count = 0;
  for (Index s = request.begin; s < request.end; ++s) {
    const GrownState grown = growth_->at(s, amount);
    if (!grown.valid) {
      slots.energy[at(s)] = kInfinity;
      continue;
    }
    VolumeResponse mean{};
    if (of_mean) mean = volume_response(strain_, grown_mean(s, grown, request));
    for (int q = 0; q < data_.points; ++q) {
      Lane& lane = lanes[count++];
      lane.stencil = s;
      lane.point = q;
      lane.grown = grown;
      lane.root = std::sqrt(grown.J);
      double F[9];
      deformation_gradient(s, q, request.x, request.rest, F, lane.volume_strain);
      times(F, grown.inverse, lane.F);
      lane.volume_strain = (lane.volume_strain - (grown.J - 1)) / grown.J;
      // Each point adds to the mean in proportion; how Phi bends is added cell by cell.
      lane.phi =
          of_mean ? VolumeResponse{mean.value, mean.first, 0} : volume_response(strain_, lane.volume_strain);
      lane.sigma = 0;
      for (int k = 0; k < data_.functions && request.want != Want::value; ++k) {
        const auto function = static_cast<std::size_t>(data_.functions) * at(s) + at(k);
        lane.sigma +=
            data_.shape[at(q * data_.functions + k)] * request.function_multiplier[function] / lane.root;
      }
      if (count == kLanes) {
        flush(request, slots, lanes, count);
        count = 0;
      }
    }
  }
  if (count > 0) flush(request, slots, lanes, count);
  if (!of_mean || request.want != Want::hessian) return;
  for (Index s = request.begin; s < request.end; ++s) {
    if (const GrownState grown = growth_->at(s, amount); grown.valid) add_bending(request, slots, s, grown);
  }
}

void GrownPool::flush(const StencilRequest& request, const StencilSlots& slots, const Lane* lanes,
                      int count) const {
  const bool definite = request.want == Want::hessian && request.definiteness != Definiteness::exact;
  PointBatch batch;
  ResponseBatch response;
  for (int l = 0; l < kLanes; ++l) {
    const Lane& lane = lanes[std::min(l, count - 1)];
    for (int i = 0; i < 9; ++i) batch.F[i][l] = lane.F[i];
    batch.element[l] = lane.stencil;
    batch.J_before[l] = 1;
    if (remembers_) batch.kept[l] = kept(request.memory, lane.stencil, lane.point);
    if (1 + lane.volume_strain >= looks_back_below_ || request.increment.before.empty()) continue;
    double F[9], before = 0;
    deformation_gradient(lane.stencil, lane.point, request.increment.before, request.rest, F, before);
    batch.J_before[l] = (1 + before) / lane.grown.J;
  }
  if (material_) material_->evaluate(definite ? Want::gradient : request.want, batch, response);
  if (definite) definite_hessian(request, lanes, count, batch, response);
  for (int l = 0; l < count; ++l) {
    double P[9] = {}, A[45] = {};
    for (int i = 0; i < 9 && material_ && request.want != Want::value; ++i) P[i] = response.P[i][l];
    const bool second = definite || (material_ && request.want == Want::hessian);
    for (int i = 0; i < 45 && second; ++i) A[i] = response.A[i][l];
    write(request, slots, lanes[l], material_ ? response.psi[l] : 0, P, A);
  }
  // A logarithm of what is inside out: no value, whatever the material says.
  if (!has_logarithm(strain_) || data_.functions == 0) return;
  for (int l = 0; l < count; ++l) {
    if (std::isinf(lanes[l].phi.value)) slots.energy[at(lanes[l].stencil)] = kInfinity;
  }
}

// In F_e: F_g is given, so that what is definite in F_e is so in x.
void GrownPool::definite_hessian(const StencilRequest& request, const Lane* lanes, int count,
                                 const PointBatch& batch, ResponseBatch& response) const {
  Lanes first = {}, second = {};
  for (int l = 0; l < count; ++l) {
    first[l] = lanes[l].sigma * lanes[l].phi.first;
    second[l] = lanes[l].sigma * lanes[l].phi.second;
  }
  definite_point_hessian(request.definiteness, material_.get(), batch, first, second, response);
}

void GrownPool::write(const StencilRequest& request, const StencilSlots& slots, const Lane& lane, double psi,
                      const double* P_material, const double* A_material) const {
  const auto s = at(lane.stencil), functions = static_cast<std::size_t>(data_.functions);
  const double rest = data_.weight[s * at(data_.points) + at(lane.point)];
  const double w = rest * lane.grown.J, v = rest * lane.root;
  const double* N = data_.shape.data() + at(lane.point) * functions;
  slots.energy[s] += w * psi;
  for (std::size_t k = 0; k < functions; ++k) slots.value[s * functions + k] += v * N[k] * lane.phi.value;
  if (request.want == Want::value) return;

  // dF_e = dF F_g^-1: in place of B the nodes have F_g^-T B.
  constexpr std::size_t most = 256;
  const std::size_t n = nodes_[lane.stencil].size(), first = at(nodes_.offset[s]);
  const Vec3* B = data_.gradient.data() + at(data_.points) * first + at(lane.point) * n;
  Vec3 few[most];
  std::vector<Vec3> many(n > most ? n : 0);
  Vec3* own = n > most ? many.data() : few;
  const double* R = lane.grown.inverse;
  for (std::size_t a = 0; a < n; ++a) {
    for (int j = 0; j < 3; ++j) own[a][j] = B[a].x * R[j] + B[a].y * R[3 + j] + B[a].z * R[6 + j];
  }
  double P[9], g[9];
  cofactor(lane.F, g);
  for (int i = 0; i < 9; ++i) P[i] = P_material[i] + lane.sigma * lane.phi.first * g[i];
  contract_gradient(P, w, own, n, slots.gradient.data() + first);
  for (std::size_t a = 0; functions > 0 && a < n; ++a) {
    const Vec3 d = (v * lane.phi.first) * Vec3{g[0] * own[a].x + g[1] * own[a].y + g[2] * own[a].z,
                                               g[3] * own[a].x + g[4] * own[a].y + g[5] * own[a].z,
                                               g[6] * own[a].x + g[7] * own[a].y + g[8] * own[a].z};
    for (std::size_t k = 0; k < functions; ++k) slots.jacobian[first * functions + k * n + a] += N[k] * d;
  }
  if (request.want != Want::hessian) return;
  double A[45];
  std::copy_n(A_material, 45, A);
  // A definite one holds the share of the volume rows already.
  if (lane.sigma != 0 && request.definiteness == Definiteness::exact)
    add_volume_hessian(lane.F, g, lane.sigma * lane.phi.first, lane.sigma * lane.phi.second, A);
  contract_hessian(A, w, own, n, slots.hessian.data() + hessian_offset()[s]);
}

// With v = integral of J_e - 1 over a cell of volume V the row is sqrt(J_g) V Phi(v/V).
void GrownPool::add_bending(const StencilRequest& request, const StencilSlots& slots, Index stencil,
                            const GrownState& grown) const {
  const auto s = at(stencil);
  const double multiplier = request.function_multiplier[s];
  const VolumeResponse phi = volume_response(strain_, grown_mean(stencil, grown, request));
  if (multiplier == 0 || phi.first == 0) return;
  double c = multiplier * phi.second / (volume(stencil) * std::sqrt(grown.J) * phi.first * phi.first);
  if (request.definiteness != Definiteness::exact && c < 0)
    c = request.definiteness == Definiteness::absolute ? -c : 0;
  const std::size_t n = nodes_[stencil].size();
  const Vec3* d = slots.jacobian.data() + at(nodes_.offset[s]);
  add_outer_products(c, d, n, slots.hessian.data() + hessian_offset()[s]);
}

}  // namespace isochor
