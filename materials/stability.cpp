// At which stretches an incompressible block of a material is stable: where every small change of its
// principal stretches takes work of the second order, d tau : d epsilon > 0 with the Kirchhoff stress tau and
// logarithmic strains (Drucker's postulate, in the form that codes check fits with). With e_i = log s_i and
// Psi(s) that is a positive definite second derivative over e_0 + e_1 + e_2 = 0.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "materials/strain_law.h"

namespace isochor {

namespace {

constexpr double kLargest = 10;  // stretches from its inverse to it are looked at

struct Path {
  const char* name;
  double second;  // the stretches are s, s^second and what keeps the volume
};
constexpr Path kPaths[] = {{"uniaxial", -0.5}, {"equibiaxial", 1}, {"pure shear", 0}};

enum class Verdict : std::uint8_t { stable, unstable, no_value };

// For a batch of stretches along a path.
std::array<Verdict, kLanes> judge(const Material& material, const Path& path, const double stretch[kLanes]) {
  PointBatch points{};
  Svd3 svd{};
  for (int l = 0; l < kLanes; ++l) {
    const double a = std::log(stretch[l]);
    const double s[3] = {stretch[l], std::exp(path.second * a), std::exp(-(1 + path.second) * a)};
    for (int i = 0; i < 3; ++i) {
      points.F[4 * i][l] = s[i];
      svd.sigma[i][l] = s[i];
      svd.U[4 * i][l] = svd.V[4 * i][l] = 1;
    }
  }
  ResponseBatch r;
  material.evaluate(Want::gradient, points, r);
  Spectrum spectrum = {};
  material.spectrum(points, svd, spectrum);
  std::array<Verdict, kLanes> out{};
  for (std::size_t l = 0; l < kLanes; ++l) {
    if (!std::isfinite(r.psi[l])) {
      out[l] = Verdict::no_value;
      continue;
    }
    // Second derivatives in log s, packed as the spectrum is.
    double H[6];
    constexpr int first[] = {0, 1, 2, 0, 0, 1}, second[] = {0, 1, 2, 1, 2, 2};
    for (int i = 0; i < 6; ++i) {
      H[i] = points.F[4 * first[i]][l] * points.F[4 * second[i]][l] * spectrum.scaling[i][l];
      if (i < 3) H[i] += points.F[4 * i][l] * r.P[4 * i][l];
    }
    const double a = H[0] + H[2] - 2 * H[4], b = H[1] + H[2] - 2 * H[5], c = H[3] + H[2] - H[4] - H[5];
    out[l] = a > 0 && a * b > c * c ? Verdict::stable : Verdict::unstable;
  }
  return out;
}

struct Range {
  double end = kLargest;  // the first stretch from 1 on that is not stable, or the end of what is looked at
  bool unstable = false;
};

// From 1 outward to `limit`, then closer around what is found.
Range search(const Material& material, const Path& path, double limit) {
  double from = 0, to = std::log(limit);
  Range found{limit, false};
  for (int round = 0; round < 6; ++round) {
    const int steps = round == 0 ? 25 * kLanes : kLanes;
    bool hit = false;
    for (int first = 1; first <= steps && !hit; first += kLanes) {
      double stretch[kLanes];
      for (int l = 0; l < kLanes; ++l) stretch[l] = std::exp(from + (to - from) * (first + l) / steps);
      const auto verdicts = judge(material, path, stretch);
      for (int l = 0; l < kLanes && !hit; ++l) {
        const Verdict v = verdicts[static_cast<std::size_t>(l)];
        if (v == Verdict::stable) continue;
        if (v == Verdict::no_value) return found;  // its domain ends before it is unstable
        hit = true;
        found = {stretch[l], true};
        const double low = from + (to - from) * (first + l - 1) / steps;
        to = from + (to - from) * (first + l) / steps;
        from = low;
      }
    }
    if (!hit) break;
  }
  return found;
}

}  // namespace

std::vector<std::string> stability_warnings(std::string_view name, const Material& distortional) {
  std::string text;
  for (const Path& path : kPaths) {
    const Range low = search(distortional, path, 1 / kLargest), high = search(distortional, path, kLargest);
    if (!low.unstable && !high.unstable) continue;
    char part[120];
    if (low.unstable && high.unstable) {
      std::snprintf(part, sizeof part, "%s stretch from %.4g to %.4g", path.name, low.end, high.end);
    } else {
      std::snprintf(part, sizeof part, "%s stretch %s %.4g", path.name, low.unstable ? "above" : "below",
                    low.unstable ? low.end : high.end);
    }
    text += (text.empty() ? "" : ", ") + std::string(part);
  }
  if (text.empty()) return {};
  return {"the constants of " + std::string(name) + " are stable only at " + text +
          "; beyond, stress falls with strain and a solution may not exist or not be the only one"};
}

}  // namespace isochor
