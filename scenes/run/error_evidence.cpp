#include "scenes/run/error_evidence.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "engine/base/base.h"

namespace isochor {

namespace {

constexpr double kThreeMeshes = 1.25, kLargestRatio = 4, kLargestLocalRatio = 2.5;
// Ratios of differences below that of the order 1/3 tell of no order.
constexpr double kLeastRatio = 1.2599;
// A number so much smaller than the largest of its unit is rounding: a displacement across a plane of
// symmetry.
constexpr double kNone = 1e-9;

const Answer* find(std::span<const Answer> all, const std::string& name) {
  const auto it = std::find_if(all.begin(), all.end(), [&](const Answer& a) { return a.name == name; });
  return it == all.end() ? nullptr : &*it;
}

double relative(double error, const Answer& a, std::span<const Answer> all) {
  double size = 0;
  for (const Answer& other : all) {
    if (other.unit == a.unit) size = std::max(size, kNone * other.size);
  }
  size = std::max(size, a.size);
  if (size > 0) return error / size;
  return error > 0 ? std::numeric_limits<double>::infinity() : 0;
}

// `error_of` an answer of the last run; negative: it has none.
Evidence collect(std::span<const Answer> last, std::span<const Answer> before,
                 const std::function<double(const Answer& mine, const Answer& other)>& error_of,
                 std::string how) {
  Evidence out;
  out.how = std::move(how);
  for (const Answer& mine : last) {
    const Answer* other = find(before, mine.name);
    const double error = other ? error_of(mine, *other) : -1;
    if (error < 0) {
      // A time that one of the runs did not reach leaves its metric without evidence.
      out.largest = std::numeric_limits<double>::infinity();
      out.held_by = mine.name;
      continue;
    }
    AccuracyEntry e{mine.name, mine.unit, mine.shown(), other->shown(), error, {}};
    e.relative = relative(error, mine, last);
    if (out.held_by.empty() || *e.relative > out.largest) {
      out.largest = *e.relative;
      out.held_by = mine.name;
    }
    out.entries.push_back(std::move(e));
  }
  if (out.entries.empty()) out.largest = std::numeric_limits<double>::infinity();
  return out;
}

}  // namespace

double largest_difference(std::span<const Answer> worse, std::span<const Answer> better) {
  return collect(
             better, worse, [](const Answer& a, const Answer& b) { return norm(a.value - b.value); }, "")
      .largest;
}

Evidence from_two_meshes(std::span<const Answer> coarse, std::span<const Answer> fine) {
  return collect(
      fine, coarse, [](const Answer& a, const Answer& b) { return norm(a.value - b.value); },
      "the difference to the same element on the mesh before (two meshes, order 2, safety factor 3)");
}

Evidence from_two_local_meshes(std::span<const Answer> coarse, std::span<const Answer> fine) {
  return collect(
      fine, coarse, [](const Answer& a, const Answer& b) { return kLocalSafety * norm(a.value - b.value); },
      "the difference to the same element on the mesh before (two meshes, safety factor 1.5)");
}

namespace {

Evidence from_three(std::span<const Answer> coarsest, std::span<const Answer> coarse,
                    std::span<const Answer> fine, double largest_ratio) {
  const auto error = [&](const Answer& mine, const Answer& before) -> double {
    const Answer* first = find(coarsest, mine.name);
    if (!first) return -1;
    const Vec3 d = mine.value - before.value, d_before = before.value - first->value;
    const double last = norm(d), previous = norm(d_before);
    if (last == 0) return 0;
    const double ratio = previous / last;
    if (ratio < kLeastRatio || dot(d, d_before) <= 0) return std::max(last, previous);
    return kThreeMeshes * last / (std::min(ratio, largest_ratio) - 1);
  };
  return collect(fine, coarse, error,
                 "the observed order of convergence on three meshes (Richardson, safety factor 1.25)");
}

}  // namespace

Evidence from_three_meshes(std::span<const Answer> coarsest, std::span<const Answer> coarse,
                           std::span<const Answer> fine) {
  return from_three(coarsest, coarse, fine, kLargestRatio);
}

Evidence from_three_local_meshes(std::span<const Answer> coarsest, std::span<const Answer> coarse,
                                 std::span<const Answer> fine) {
  return from_three(coarsest, coarse, fine, kLargestLocalRatio);
}

Evidence together(const Evidence& a, const Evidence& b) {
  Evidence out = a;
  out.largest = 0;
  out.held_by.clear();
  for (AccuracyEntry& e : out.entries) {
    const auto other = std::find_if(b.entries.begin(), b.entries.end(),
                                    [&](const AccuracyEntry& o) { return o.name == e.name; });
    const bool known = other != b.entries.end();
    const double more = known ? other->relative.value_or(0) : std::numeric_limits<double>::infinity();
    e.relative = e.relative.value_or(0) + more;
    if (known) e.indicator += other->indicator;
    if (out.held_by.empty() || *e.relative > out.largest) {
      out.largest = *e.relative;
      out.held_by = e.name;
    }
  }
  // What has no evidence of its own in one of them.
  for (const Evidence* one : {&a, &b}) {
    if (std::isfinite(one->largest)) continue;
    out.largest = one->largest;
    out.held_by = one->held_by;
  }
  return out;
}

Evidence from_two_elements(std::span<const Answer> worse, std::span<const Answer> better,
                           const std::string& worse_name) {
  return collect(
      better, worse,
      [](const Answer& a, const Answer& b) { return kElementSafety * norm(a.value - b.value); },
      "the difference to " + worse_name + " on the same mesh (safety factor 1.5)");
}

}  // namespace isochor
