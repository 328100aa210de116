#include "engine/elements/growth.h"

#include <cmath>

namespace isochor {

GrownState Growth::at(Index element, double a) const {
  const Tensor& G = rate[field ? isochor::at(element) : 0];
  GrownState out;
  if (by_volume) {
    out.J = 1 + a * G[0];
    out.valid = out.J > 0 && std::isfinite(out.J);
    const double shrink = out.valid ? 1 / std::cbrt(out.J) : 1;
    for (int i = 0; i < 9; i += 4) out.inverse[i] = shrink;
    return out;
  }
  const double xx = 1 + a * G[0], yy = 1 + a * G[1], zz = 1 + a * G[2];
  const double xy = a * G[3], yz = a * G[4], zx = a * G[5];
  const double c00 = yy * zz - yz * yz, c01 = yz * zx - xy * zz, c02 = xy * yz - yy * zx;
  out.J = xx * c00 + xy * c01 + zx * c02;
  out.valid = xx > 0 && xx * yy - xy * xy > 0 && out.J > 0 && std::isfinite(out.J);
  if (!out.valid) return out;
  const double d = 1 / out.J;
  out.inverse[0] = d * c00;
  out.inverse[4] = d * (xx * zz - zx * zx);
  out.inverse[8] = d * (xx * yy - xy * xy);
  out.inverse[1] = out.inverse[3] = d * c01;
  out.inverse[2] = out.inverse[6] = d * c02;
  out.inverse[5] = out.inverse[7] = d * (xy * zx - xx * yz);
  return out;
}

std::shared_ptr<const Growth> Growth::gathered(const Lists& cells, std::span<const double> weight) const {
  auto out = std::make_shared<Growth>(*this);
  if (!field) return out;
  out->rate.assign(isochor::at(cells.count()), Tensor{});
  for (Index s = 0; s < cells.count(); ++s) {
    for (Index k = cells.offset[isochor::at(s)]; k < cells.offset[isochor::at(s) + 1]; ++k) {
      const Tensor& G = rate[isochor::at(cells.item[isochor::at(k)])];
      for (std::size_t i = 0; i < 6; ++i) out->rate[isochor::at(s)][i] += weight[isochor::at(k)] * G[i];
    }
  }
  return out;
}

}  // namespace isochor
