#include "scenes/run/error_places.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "engine/base/base.h"
#include "isochor/gradients.h"
#include "scenes/effects/kind.h"
#include "scenes/probes.h"
#include "scenes/run/accuracy.h"

namespace isochor {

namespace {

template <class T>
std::optional<std::size_t> place_of(const std::vector<T>& items, const std::string& name) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].name == name) return i;
  }
  return {};
}

Vec3 unit_of(Component c, const Vec3& value) {
  if (c == Component::x) return {1, 0, 0};
  if (c == Component::y) return {0, 1, 0};
  if (c == Component::z) return {0, 0, 1};
  const double size = norm(value);
  return size > 0 ? (1 / size) * value : Vec3{0, 0, 1};
}

class Outputs {
 public:
  Outputs(const SceneDef& scene, const BuiltScene& built, const RunResult& result)
      : scene_(scene), built_(built), last_(result.records.back()) {}

  std::optional<Output> of_probe(std::size_t p, Component c) const {
    const ProbeDef& probe = scene_.probes[p];
    const Vec3 direction = unit_of(c, last_.probes[p]);
    const BodyId body = built_.bodies[static_cast<std::size_t>(probe.body)];
    const MaterialPoint place = locate(built_.world.mesh(body), probe.point);
    const auto nodes = std::span(place.nodes).first(static_cast<std::size_t>(place.count));
    std::vector<Vec3> weights;
    for (std::size_t k = 0; k < nodes.size(); ++k) weights.push_back(place.weights[k] * direction);
    return Output::positions(body, std::vector<Index>(nodes.begin(), nodes.end()), std::move(weights));
  }

  // Nothing where the metric has no derivative that is known.
  std::optional<Output> of_metric(const MetricDef& m) const {
    switch (m.quantity) {
      case Quantity::displacement:
        if (const auto p = place_of(scene_.probes, m.of)) return of_probe(*p, m.component);
        return {};
      case Quantity::cavity_pressure:
      case Quantity::cavity_volume: {
        const auto c = place_of(scene_.cavities, m.of);
        if (!c) return {};
        return Output::gauge(built_.ids(cavities_kind)[*c],
                             m.quantity == Quantity::cavity_volume ? "volume" : "pressure");
      }
      case Quantity::reaction_force:
      case Quantity::reaction_moment: {
        const auto d = place_of(scene_.dirichlet, m.of);
        if (!d) return {};
        const bool force = m.quantity == Quantity::reaction_force;
        const Vec3 along =
            unit_of(m.component, force ? last_.reactions[*d].force : last_.reactions[*d].moment);
        const EffectId support = built_.ids(dirichlet_kind)[*d];
        return force ? Output::reaction(support, along) : Output::reaction(support, {}, along);
      }
      case Quantity::elastic_energy:
        return Output::elastic_energy();
      default:
        return {};
    }
  }

 private:
  const SceneDef& scene_;
  const BuiltScene& built_;
  const StepRecord& last_;
};

std::string digits(double value, int count) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", count, value);
  return text;
}

AnswerOrigin named(const std::string& name, ErrorOrigin origin) {
  return {name, std::move(origin.cells), origin.by_output, std::move(origin.note), {}};
}

// Cells of all bodies by their share, the largest first; equal ones by their number.
struct Share {
  double value = 0;
  std::size_t body = 0;
  Index cell = 0;
};

std::vector<Share> sorted_shares(const AnswerOrigin& origin) {
  std::vector<Share> all;
  for (std::size_t b = 0; b < origin.cells.size(); ++b) {
    for (std::size_t c = 0; c < origin.cells[b].size(); ++c) {
      if (origin.cells[b][c] > 0) all.push_back({origin.cells[b][c], b, static_cast<Index>(c)});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Share& a, const Share& b) { return a.value > b.value; });
  return all;
}

// As many of the largest as hold that part of the whole.
std::size_t count_holding(const std::vector<Share>& all, double part) {
  double sum = 0;
  std::size_t n = 0;
  while (n < all.size() && sum < part) sum += all[n++].value;
  return n;
}

}  // namespace

std::vector<AnswerOrigin> origins_of_answers(const SceneDef& scene, BuiltScene& built,
                                             const RunResult& result) {
  const Outputs outputs(scene, built, result);
  std::vector<std::string> names;
  std::vector<std::optional<Output>> wanted;
  std::vector<Output> known;
  std::size_t probe = 0;
  for (const Answer& a : answers_of(result)) {
    const auto m = place_of(scene.metrics, a.name);
    names.push_back(a.name);
    if (a.vector)
      wanted.push_back(outputs.of_probe(probe++, Component::magnitude));
    else
      wanted.push_back(m ? outputs.of_metric(scene.metrics[*m]) : std::nullopt);
    if (wanted.back()) known.push_back(*wanted.back());
  }
  std::vector<AnswerOrigin> out;
  const auto strain = built.world.error_origins({});
  if (!strain) return out;
  const auto together = built.world.error_origins(known);
  std::size_t next = 0;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!wanted[k]) {
      out.push_back(named(names[k], strain.value().front()));
      out.back().note = "no derivative of it is known";
    } else if (together) {
      out.push_back(named(names[k], together.value()[next++]));
    } else {
      // One that is refused does not take the others with it.
      const auto alone = built.world.error_origins(std::span(&*wanted[k], 1));
      out.push_back(named(names[k], alone ? alone.value().front() : strain.value().front()));
      if (!alone) out.back().note = alone.error();
    }
  }
  for (AnswerOrigin& origin : out) origin.where = describe_origin(origin, built);
  return out;
}

void add_places(const std::vector<AnswerOrigin>& origins, std::vector<AccuracyEntry>& entries) {
  for (AccuracyEntry& e : entries) {
    if (const auto k = place_of(origins, e.name)) e.where = origins[*k].where;
  }
}

std::vector<double> largest_shares(const std::vector<AnswerOrigin>& origins, std::size_t body) {
  std::vector<double> out;
  for (const AnswerOrigin& origin : origins) {
    if (body >= origin.cells.size()) continue;
    const std::vector<double>& cells = origin.cells[body];
    out.resize(cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c) out[c] = std::max(out[c], cells[c]);
  }
  return out;
}

std::vector<std::vector<Index>> cells_to_refine(const std::vector<AnswerOrigin>& origins, double most) {
  std::vector<std::vector<Index>> out;
  for (const AnswerOrigin& origin : origins) {
    const auto all = sorted_shares(origin);
    out.resize(std::max(out.size(), origin.cells.size()));
    for (std::size_t k = 0, n = count_holding(all, most); k < n; ++k) out[all[k].body].push_back(all[k].cell);
  }
  for (auto& cells : out) {
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  }
  return out;
}

std::string describe_origin(const AnswerOrigin& origin, const BuiltScene& built) {
  const auto all = sorted_shares(origin);
  if (all.empty()) return {};
  const std::size_t n = count_holding(all, 0.75);
  std::size_t cells = 0;
  for (const auto& body : origin.cells) cells += body.size();
  // The middle of what they hold, in the body that holds most of it.
  std::vector<double> of_body(origin.cells.size());
  for (std::size_t k = 0; k < n; ++k) of_body[all[k].body] += all[k].value;
  const auto most =
      static_cast<std::size_t>(std::max_element(of_body.begin(), of_body.end()) - of_body.begin());
  const BodyId body = built.bodies[most];
  const Mesh& mesh = built.world.mesh(body);
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  Vec3 middle{};
  for (std::size_t k = 0; k < n; ++k) {
    if (all[k].body != most) continue;
    for (std::size_t a = 0; a < per; ++a) {
      const auto node = static_cast<std::size_t>(mesh.cells[static_cast<std::size_t>(all[k].cell) * per + a]);
      middle += (all[k].value / of_body[most] / static_cast<double>(per)) * mesh.nodes[node];
    }
  }
  return origin.name + ": three quarters of its error come from " +
         digits(100 * static_cast<double>(n) / static_cast<double>(cells), 2) + " % of the cells, around (" +
         digits(middle.x, 3) + ", " + digits(middle.y, 3) + ", " + digits(middle.z, 3) + ") m in \"" +
         built.world.body_name(body) + "\"";
}

}  // namespace isochor
