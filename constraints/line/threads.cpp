// Bonded threads: windings along paths, and the edges of a layer that limits strain.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "constraints/stencil/segment_pool.h"
#include "engine/base/text.h"
#include "isochor/effects/cable.h"
#include "isochor/effects/layer.h"

namespace isochor {

namespace {

class ThreadRows final : public RowPool {
 public:
  ThreadRows(std::string name, double slack) : name_(std::move(name)), slack_(slack) {}
  std::string_view name() const override { return name_; }
  void update(double, std::span<double> value) const override {
    for (std::size_t r = 0; r < value.size(); ++r) value[r] = slack_ * measure[r];
  }

 private:
  std::string name_;
  double slack_;
};

class ThreadInstance final : public EffectInstance {
 public:
  ThreadInstance(std::string kind, std::shared_ptr<const SegmentPool> pool,
                 std::shared_ptr<const ThreadRows> rows, Index row_pool)
      : kind_(std::move(kind)), pool_(std::move(pool)), rows_(std::move(rows)), row_pool_(row_pool) {}
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    double tension = 0, strain = 0;
    const std::size_t first = at(c.system.first_row(row_pool_));
    for (Index s = 0; s < pool_->stencils(); ++s) {
      tension = std::max(tension, c.state.lambda[first + at(s)]);
      strain = std::max(strain, pool_->length(s, c.state.x) / pool_->rest_length(s) - 1);
    }
    const std::string name(rows_->name());
    out.push_back({name, kind_, "largest_tension", "N", tension});
    out.push_back({name, kind_, "largest_strain", "1", strain});
  }

 private:
  std::string kind_;
  std::shared_ptr<const SegmentPool> pool_;
  std::shared_ptr<const ThreadRows> rows_;
  Index row_pool_;
};

// What both effects say about their threads.
struct ThreadLaw {
  std::string kind, name;
  double slack = 0;
  bool pulls_only = true;
};

// One row a segment, whose compliance [m/N] is given for each; none: inextensible.
std::unique_ptr<EffectInstance> add_threads(Builder& builder, const BodyData& body, const ThreadLaw& law,
                                            const std::shared_ptr<SegmentPool>& pool,
                                            std::span<const double> compliance) {
  pool->finish();
  auto rows = std::make_shared<ThreadRows>(law.name, law.slack);
  for (Index s = 0; s < pool->stencils(); ++s) {
    rows->map.push(std::span(&s, 1));
    rows->weight.push_back(1);
    rows->metric.push_back(1 / (stiffest(body) * pool->rest_length(s)));
    rows->measure.push_back(pool->rest_length(s));
    if (!compliance.empty()) rows->compliance.push_back({s, s, compliance[at(s)]});
  }
  if (law.pulls_only) {
    rows->lower.assign(at(pool->stencils()), 0);
    rows->upper.assign(at(pool->stencils()), std::numeric_limits<double>::infinity());
  }
  rows->stencil_pool = builder.add_stencils(pool);
  const Index row_pool = builder.add_rows(rows);
  return std::make_unique<ThreadInstance>(law.kind, pool, rows, row_pool);
}

Result<void> check_thread(const std::string& who, double stiffness, double slack, bool may_be_hard) {
  if (!(stiffness >= 0) || !std::isfinite(stiffness) || (stiffness == 0 && !may_be_hard)) {
    return Error{who + ": stiffness = " + number(stiffness) +
                 (may_be_hard
                      ? " N; it must be positive, or 0 for inextensible threads"
                      : " N/m; it must be positive: edges of a triangle mesh that cannot stretch at all "
                        "leave a surface no way to move")};
  }
  if (!(slack >= 0) || !std::isfinite(slack)) {
    return Error{who + ": slack = " + number(slack) + "; it must be zero or a positive strain"};
  }
  return {};
}

class WindingEffect final : public EffectSource {
 public:
  explicit WindingEffect(WindingDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }
  Result<void> check() const override {
    for (const auto& path : def_.paths) {
      if (path.size() < 2) return Error{who() + ": a path has fewer than two points; give at least two"};
    }
    if (def_.paths.empty()) return Error{who() + ": it has no path; give at least one"};
    return check_thread(who(), def_.stiffness, def_.slack, true);
  }
  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    if (!builder.has_body(def_.body)) return Error{who() + ": " + builder.no_body(def_.body)};
    const BodyData& body = builder.body(def_.body);
    auto pool = std::make_shared<SegmentPool>(def_.name, false);
    for (const auto& path : def_.paths) {
      std::optional<PointInBody> last;
      for (const Vec3& X : path) {
        auto point = embed(body, builder.rest(), X, who());
        if (!point) return point.failure();
        if (last) {
          if (auto r = pool->add(*last, point.value(), builder.rest()); !r) {
            return Error{who() + ": " + r.error()};
          }
        }
        last = std::move(point).value();
      }
    }
    std::vector<double> compliance;
    for (Index s = 0; s < pool->stencils() && def_.stiffness > 0; ++s) {
      compliance.push_back(pool->rest_length(s) / def_.stiffness);
    }
    return add_threads(builder, body, {"winding", def_.name, def_.slack, def_.pulls_only}, pool, compliance);
  }

 private:
  std::string who() const { return "winding \"" + def_.name + "\""; }
  WindingDef def_;
};

class StrainLimitEffect final : public EffectSource {
 public:
  explicit StrainLimitEffect(StrainLimitDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }
  Result<void> check() const override {
    if (def_.surfaces.empty())
      return Error{who() + ": no surface named; name the faces that the layer covers"};
    return check_thread(who(), def_.stiffness, def_.slack, false);
  }
  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto faces = builder.faces(def_.body, def_.surfaces, def_.name);
    if (!faces) return faces.failure();
    const BodyData& body = builder.body(def_.body);
    const auto per = static_cast<std::size_t>(nodes_per_face(body.mesh.cell_type));
    if (per != 3 && per != 6)
      return Error{who() + ": a layer needs triangular faces; take a mesh of tetrahedra"};
    // Faces at each edge; a curved edge is two threads that meet in its middle.
    std::map<std::pair<Index, Index>, int> edges;
    const auto add = [&](Index a, Index b) { ++edges[{std::min(a, b), std::max(a, b)}]; };
    for (std::size_t f = 0; f < faces.value().size(); f += per) {
      const Index* n = faces.value().data() + f;
      for (std::size_t k = 0; k < 3; ++k) {
        if (per == 3) {
          add(n[k], n[(k + 1) % 3]);
        } else {
          add(n[k], n[3 + k]);
          add(n[3 + k], n[(k + 1) % 3]);
        }
      }
    }
    auto pool = std::make_shared<SegmentPool>(def_.name, false);
    std::vector<double> compliance;
    for (const auto& [ends, count] : edges) {
      if (auto r = pool->add({{ends.first}, {1.0}}, {{ends.second}, {1.0}}, builder.rest()); !r) {
        return Error{who() + ": " + r.error()};
      }
      // Springs along the edges of equilateral triangles: each triangle gives its edges sqrt(3)/4 of the
      // stiffness of the sheet. Half an edge is twice as stiff.
      const double spring = 0.25 * std::numbers::sqrt3 * def_.stiffness * count;
      compliance.push_back(1 / (per == 3 ? spring : 2 * spring));
    }
    return add_threads(builder, body, {"strain_limit", def_.name, def_.slack, def_.pulls_only}, pool,
                       compliance);
  }

 private:
  std::string who() const { return "strain limit \"" + def_.name + "\""; }
  StrainLimitDef def_;
};

}  // namespace

EffectPtr winding(WindingDef def) {
  return std::make_shared<WindingEffect>(std::move(def));
}

EffectPtr strain_limit(StrainLimitDef def) {
  return std::make_shared<StrainLimitEffect>(std::move(def));
}

std::vector<Vec3> helix(const Vec3& start, const Vec3& end, const Vec3& out, double turns, int points) {
  std::vector<Vec3> path;
  const Vec3 axis = end - start;
  const double length = std::sqrt(dot(axis, axis));
  const Vec3 along = length > 0 ? (1 / length) * axis : Vec3{};
  const Vec3 side = cross(along, out);
  for (int i = 0; i < points; ++i) {
    const double s = points > 1 ? static_cast<double>(i) / (points - 1) : 0;
    const double angle = 2 * std::numbers::pi * turns * s;
    path.push_back(start + s * axis + std::cos(angle) * out + std::sin(angle) * side);
  }
  return path;
}

}  // namespace isochor
