#include "materials/isochoric_base.h"

#include <algorithm>
#include <cmath>

namespace isochor {

bool is_isochoric(const Material& energy) {
  PointBatch points{};
  ResponseBatch r;
  double size = 0;
  for (int l = 0; l < kLanes; ++l) {
    for (int i = 0; i < 9; i += 4) points.F[i][l] = 1 + 0.1 * (l % 2 == 0 ? 1 : -1);
    points.F[1][l] = l < 2 ? 0 : 0.3;  // and one that is sheared, for the size of stresses
    points.J_before[l] = 1;
  }
  energy.evaluate(Want::gradient, points, r);
  for (auto& p : r.P) size = std::max(size, std::abs(p[2]));
  double stray = 0;
  for (int l = 0; l < 2; ++l)
    for (auto& p : r.P) stray = std::max(stray, std::abs(p[l]));
  return stray <= 1e-10 * size;
}

}  // namespace isochor
