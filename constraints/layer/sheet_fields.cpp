#include "constraints/layer/sheet_fields.h"

#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

// Of a plane stress 11, 22, 12.
double von_mises(double a, double b, double c) {
  return std::sqrt(std::max(a * a - a * b + b * b + 3 * c * c, 0.0));
}

// The moment of a triangle in the frame (a, b) of its plane at rest: 11, 22, 12 [N].
std::array<double, 3> moment_in(const std::array<EdgeMoment, 3>& edge, const std::array<Index, 3>& row,
                                std::span<const double> moments, const Vec3& a, const Vec3& b) {
  std::array<double, 3> sum{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (row[k] < 0) continue;
    const double m = moments[at(row[k])] * edge[k].scale;
    const double ta = dot(edge[k].t, a), tb = dot(edge[k].t, b), ua = dot(edge[k].u, a),
                 ub = dot(edge[k].u, b);
    sum[0] += m * ta * ua;
    sum[1] += m * tb * ub;
    sum[2] += 0.5 * m * (ta * ub + tb * ua);
  }
  return sum;
}

}  // namespace

std::vector<SheetCell> recover_sheet(const SheetRecovery& sheet, const GaugeContext& context) {
  const std::span<const Vec3> rest = context.system.parts().rest, x = context.state.x;
  std::vector<double> moments;
  if (sheet.row_pool >= 0 && sheet.solid) {
    const auto first = at(context.system.first_row(sheet.row_pool));
    moments = moments_of(
        sheet.bending, x,
        std::span<const double>(context.state.lambda).subspan(first, at(sheet.bending.rows->rows())));
  }
  const double leverage = 6 / (sheet.thickness * sheet.thickness);
  std::vector<SheetCell> cells(at(sheet.membrane->stencils()));
  for (Index t = 0; t < sheet.membrane->stencils(); ++t) {
    const MembranePool::Stress s = sheet.membrane->stress(t, x, rest, context.state.t, sheet.thickness);
    double worst = von_mises(s.cauchy[0], s.cauchy[1], s.cauchy[2]);
    if (!moments.empty()) {
      const auto [a, b] = sheet.membrane->axes(t);
      const auto M = moment_in(edge_moments(sheet.membrane->nodes()[t].data(), rest),
                               sheet.bending.row_of[at(t)], moments, a, b);
      for (const double side : {-leverage, leverage}) {
        worst = std::max(worst, von_mises(s.cauchy[0] + side * M[0], s.cauchy[1] + side * M[1],
                                          s.cauchy[2] + side * M[2]));
      }
    }
    Mat3 sigma;
    add_outer(sigma, s.cauchy[0], s.across[0], s.across[0]);
    add_outer(sigma, s.cauchy[1], s.across[1], s.across[1]);
    add_outer(sigma, s.cauchy[2], s.across[0], s.across[1]);
    add_outer(sigma, s.cauchy[2], s.across[1], s.across[0]);
    cells[at(t)] = {{sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2), sigma(2, 0)},
                    s.stretch,
                    s.J,
                    worst};
  }
  return cells;
}

}  // namespace isochor
