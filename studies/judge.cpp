#include "studies/judge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "engine/base/text.h"
#include "engine/elements/reference_element.h"

namespace isochor::studies {

namespace {

bool all_finite(std::span<const Vec3> values) {
  return std::all_of(values.begin(), values.end(), [](const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  });
}

const ReferenceElement& reference_of(CellType type) {
  if (type == CellType::tet4) return tet4_element();
  return type == CellType::tet10 ? tet10_element() : hex8_element();
}

bool flag(const std::vector<bool>& flags, Index region) {
  const auto r = static_cast<std::size_t>(region);
  return r < flags.size() && flags[r];
}

Index region_of(const Mesh& mesh, std::size_t cell) {
  return mesh.cell_region.empty() ? 0 : mesh.cell_region[cell];
}

}  // namespace

StateJudge::StateJudge(const World& world, std::vector<BodyPromise> promises) {
  for (BodyPromise& promise : promises) {
    Body body;
    body.promise = std::move(promise);
    const Mesh& mesh = world.mesh(body.promise.body);
    body.cells = cell_points(mesh, world.rest_positions(body.promise.body), body.promise);
    if (body.promise.element == Element::tet4_edge_smoothed)
      body.patches = edge_patches(mesh, body.cells, body.promise);
    bodies_.push_back(std::move(body));
  }
}

StateJudge::Points StateJudge::cell_points(const Mesh& mesh, std::span<const Vec3> rest,
                                           const BodyPromise& promise) {
  const ReferenceElement& e = reference_of(mesh.cell_type);
  const auto nodes = static_cast<std::size_t>(e.nodes);
  const bool smoothed = promise.element == Element::tet4_edge_smoothed;
  Points out;
  for (std::size_t c = 0; (c + 1) * nodes <= mesh.cells.size(); ++c) {
    for (std::size_t q = 0; q < static_cast<std::size_t>(e.points); ++q) {
      const Vec3* d = e.shape_gradient.data() + q * nodes;
      Vec3 column[3]{};  // of dX/dxi
      for (std::size_t a = 0; a < nodes; ++a) {
        const Vec3& X = rest[static_cast<std::size_t>(mesh.cells[c * nodes + a])];
        for (int k = 0; k < 3; ++k) column[k] += d[a][k] * X;
      }
      const Vec3 dual[3] = {cross(column[1], column[2]), cross(column[2], column[0]),
                            cross(column[0], column[1])};
      const double scale = dot(column[0], dual[0]);
      out.begin.push_back(out.node.size());
      for (std::size_t a = 0; a < nodes; ++a) {
        out.node.push_back(mesh.cells[c * nodes + a]);
        out.gradient.push_back((1 / scale) * (d[a].x * dual[0] + d[a].y * dual[1] + d[a].z * dual[2]));
      }
      out.weight.push_back(e.weight[q] * scale);
      out.cell.push_back(static_cast<Index>(c));
      const Index region = region_of(mesh, c);
      out.needs_J.push_back(flag(promise.cell_needs_J, region) ||
                            (!smoothed && flag(promise.law_needs_J, region)));
    }
  }
  out.begin.push_back(out.node.size());
  return out;
}

// The tets of one region around an edge, each with a sixth of its volume; F is their mean.
StateJudge::Points StateJudge::edge_patches(const Mesh& mesh, const Points& tets,
                                            const BodyPromise& promise) {
  std::map<std::tuple<Index, Index, Index>, std::vector<std::size_t>> edges;
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const Index i = tets.node[4 * t + a], j = tets.node[4 * t + b];
        edges[{region_of(mesh, t), std::min(i, j), std::max(i, j)}].push_back(t);
      }
    }
  }
  Points out;
  for (const auto& [edge, around] : edges) {
    double volume = 0;
    for (const std::size_t t : around) volume += tets.weight[t];
    std::map<Index, Vec3> gradient;
    for (const std::size_t t : around) {
      for (std::size_t a = 4 * t; a < 4 * t + 4; ++a)
        gradient[tets.node[a]] += (tets.weight[t] / volume) * tets.gradient[a];
    }
    out.begin.push_back(out.node.size());
    for (const auto& [node, g] : gradient) {
      out.node.push_back(node);
      out.gradient.push_back(g);
    }
    out.weight.push_back(volume / 6);
    out.cell.push_back(tets.cell[around.front()]);
    out.needs_J.push_back(flag(promise.law_needs_J, std::get<0>(edge)));
  }
  out.begin.push_back(out.node.size());
  return out;
}

StateJudge::Determinant StateJudge::determinant(const Points& points, std::size_t point,
                                                std::span<const Vec3> x) {
  // Positions are those of the world: far from its origin they cancel in the columns.
  constexpr double unit = 16 * std::numeric_limits<double>::epsilon();
  Vec3 column[3]{};
  double lost[3]{}, size[3]{};
  for (std::size_t a = points.begin[point]; a < points.begin[point + 1]; ++a) {
    const Vec3& at = x[static_cast<std::size_t>(points.node[a])];
    for (int k = 0; k < 3; ++k) {
      column[k] += points.gradient[a][k] * at;
      lost[k] += unit * std::abs(points.gradient[a][k]) * std::sqrt(dot(at, at));
    }
  }
  for (int k = 0; k < 3; ++k) size[k] = std::sqrt(dot(column[k], column[k]));
  return {dot(column[0], cross(column[1], column[2])),
          lost[0] * size[1] * size[2] + size[0] * lost[1] * size[2] + size[0] * size[1] * lost[2] +
              unit * size[0] * size[1] * size[2]};
}

JudgedShape StateJudge::shape(const World& world, std::size_t index) const {
  const Body& body = bodies_[index];
  const auto x = world.positions(body.promise.body);
  JudgedShape out;
  out.min_J = out.min_law_J = std::numeric_limits<double>::infinity();
  enum class Sign { positive, flat, negative };
  std::vector<Sign> cells(body.cells.size() == 0 ? 0 : at(body.cells.cell.back()) + 1, Sign::positive);
  for (std::size_t p = 0; p < body.cells.size(); ++p) {
    const Determinant d = determinant(body.cells, p, x);
    const double w = body.cells.weight[p];
    out.min_J = std::min(out.min_J, d.J);
    out.rest_volume += w;
    out.volume += w * d.J;
    out.log_volume += w * std::log(d.J);
    Sign& sign = cells[at(body.cells.cell[p])];
    if (d.flat()) sign = std::max(sign, Sign::flat);
    if (!d.negative()) continue;
    sign = Sign::negative;
    if (body.cells.needs_J[p]) ++out.forbidden;
    if (out.first_cell < 0) out.first_cell = body.cells.cell[p];
  }
  out.inverted = std::count(cells.begin(), cells.end(), Sign::negative);
  out.flat = std::count(cells.begin(), cells.end(), Sign::flat);
  for (std::size_t p = 0; p < body.patches.size(); ++p) {
    const Determinant d = determinant(body.patches, p, x);
    out.min_law_J = std::min(out.min_law_J, d.J);
    if (d.negative() && body.patches.needs_J[p]) ++out.forbidden;
  }
  if (body.patches.size() == 0) out.min_law_J = out.min_J;
  return out;
}

std::optional<Finding> StateJudge::finite(const World& world) const {
  for (const Body& body : bodies_) {
    const BodyId id = body.promise.body;
    if (!all_finite(world.positions(id))) return Finding{"not finite", "positions that are not finite"};
    if (!all_finite(world.velocities(id))) return Finding{"not finite", "velocities that are not finite"};
  }
  return {};
}

namespace {

// Notes the first number that is none, or, of a size, is negative.
class NumberCheck {
 public:
  void look(const std::string& what, double value) {
    if (!std::isfinite(value)) note("not finite", what, value);
  }
  void look(const std::string& what, const Vec3& v) {
    for (int k = 0; k < 3; ++k) look(what, v[k]);
  }
  void look(const std::string& what, std::span<const double> values) {
    for (const double v : values) look(what, v);
  }
  void size(const std::string& what, double value) {
    look(what, value);
    if (value < 0) note("negative", what, value);
  }
  void sizes(const std::string& what, std::span<const double> values) {
    for (const double v : values) size(what, v);
  }
  std::optional<Finding> found;

 private:
  void note(const char* kind, const std::string& what, double value) {
    if (!found) found = Finding{kind, what + " is " + number(value)};
  }
};

void look_at_body(const World& world, BodyId body, NumberCheck& check) {
  const std::string of = "body \"" + world.body_name(body) + "\": ";
  const BodyMeasures m = world.measures(body);
  check.size(of + "rest volume", m.rest_volume);
  check.size(of + "mass", m.mass);
  check.size(of + "residual of the volume rows", m.volume_row_residual);
  check.look(of + "volume", m.volume);
  check.look(of + "J", m.min_J);
  check.look(of + "J", m.max_J);
  check.look(of + "center of mass", m.center_of_mass);
  check.look(of + "momentum", m.linear_momentum);
  check.look(of + "momentum", m.angular_momentum);
  for (const VolumeMeasures& r : m.regions) {
    check.look(of + "volume of a region", r.volume);
    check.look(of + "J of a region", r.min_J);
    check.look(of + "J of a region", r.max_J);
  }
  const BodyFields f = world.fields(body);
  check.look(of + "pressure of nodes", f.node_pressure);
  check.look(of + "stress of nodes", f.node_stress);
  check.look(of + "J of cells", f.cell_J);
  check.look(of + "pressure of cells", f.cell_pressure);
  check.sizes(of + "von Mises stress of cells", f.cell_von_mises);
  check.look(of + "stress of cells", f.cell_stress);
  check.sizes(of + "stretch of cells", f.cell_max_stretch);
  check.look(of + "contact pressure", f.node_contact_pressure);
  check.look(of + "friction", f.node_friction);
}

}  // namespace

std::optional<Finding> StateJudge::numbers(const World& world) const {
  NumberCheck check;
  for (const Body& body : bodies_) look_at_body(world, body.promise.body, check);
  const Energies e = world.energies();
  check.size("kinetic energy", e.kinetic);
  for (const double v : {e.elastic, e.gravity, e.loads, e.pressures}) check.look("energy", v);
  for (const Vec3& v : world.momentum()) check.look("momentum", v);
  constexpr const char* kSizes[] = {"length", "area", "touching", "friction_force", "static_friction"};
  for (const Gauge& g : world.gauges()) {
    // Infinite: nothing is within the reach of its search.
    if (g.quantity == "smallest_gap" && g.value == std::numeric_limits<double>::infinity()) continue;
    const std::string what = "\"" + g.effect + "\" " + g.quantity;
    if (std::find(std::begin(kSizes), std::end(kSizes), g.quantity) != std::end(kSizes))
      check.size(what, g.value);
    else
      check.look(what, g.value);
  }
  return std::move(check.found);
}

const std::string* StateJudge::tells_inversion(std::span<const std::string> said) {
  for (const std::string& text : said) {
    const bool inverted = text.find("inverted") != std::string::npos ||
                          text.find("inside out") != std::string::npos ||
                          text.find("turned over") != std::string::npos;
    const bool counts = std::any_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (inverted && counts) return &text;
  }
  return nullptr;
}

std::optional<Finding> StateJudge::accepted(const World& world, std::span<const std::string> said,
                                            const JudgeLimits& limits) const {
  if (auto wrong = finite(world)) return wrong;
  const double elastic = world.elastic_energy(), kinetic = world.kinetic_energy();
  if (!std::isfinite(elastic) || !std::isfinite(kinetic)) {
    return Finding{"not finite",
                   "elastic energy " + number(elastic) + " J, kinetic energy " + number(kinetic) + " J"};
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const JudgedShape s = shape(world, b);
    const std::string& name = world.body_name(bodies_[b].promise.body);
    if (s.forbidden > 0) {
      return Finding{"inverted", "body \"" + name + "\": J < 0 at " + std::to_string(s.forbidden) +
                                     " points whose law, guard or rows have no value there, smallest J " +
                                     number(std::min(s.min_J, s.min_law_J))};
    }
    if (s.inverted > 0 && tells_inversion(said) == nullptr) {
      return Finding{"inverted unsaid", "body \"" + name + "\": " + std::to_string(s.inverted) +
                                            " cells are inverted, smallest J " + number(s.min_J) +
                                            ", first cell " + std::to_string(s.first_cell + 1) +
                                            ", and no warning says so"};
    }
    const double reported = world.measures(bodies_[b].promise.body).min_J;
    if (!(std::abs(reported - s.min_J) <= 1e-6 * (1 + std::abs(s.min_J)))) {
      return Finding{"measures",
                     "body \"" + name + "\": min J is " + number(s.min_J) + ", reported " + number(reported)};
    }
  }
  const double rows = world.constitutive_residual();
  if (!(rows <= limits.rows))
    return Finding{"rows", "residual of rows " + number(rows) + ", allowed " + number(limits.rows)};
  return {};
}

BodyPromise simple_promise(const World& world, BodyId body, Element element, bool lives_through_inversion,
                           bool guarded) {
  const std::size_t regions = std::max<std::size_t>(1, world.mesh(body).regions.size());
  BodyPromise promise;
  promise.body = body;
  promise.element = element;
  promise.law_needs_J.assign(regions, !lives_through_inversion);
  promise.cell_needs_J.assign(regions, guarded && element == Element::tet4_edge_smoothed);
  return promise;
}

}  // namespace isochor::studies
