#include "studies/analysis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace isochor::studies {

std::vector<std::size_t> pareto_front(std::span<const double> cost, std::span<const double> error) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < cost.size(); ++i) {
    if (std::isfinite(cost[i]) && std::isfinite(error[i])) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return cost[a] != cost[b] ? cost[a] < cost[b] : error[a] < error[b];
  });
  std::vector<std::size_t> front;
  double best = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (error[i] >= best) continue;
    best = error[i];
    front.push_back(i);
  }
  return front;
}

std::optional<double> observed_order(double unknowns_a, double error_a, double unknowns_b, double error_b,
                                     double dimension) {
  if (!(unknowns_a > 0) || !(unknowns_b > unknowns_a) || !(error_a > 0) || !(error_b > 0)) return {};
  return -dimension * std::log(error_b / error_a) / std::log(unknowns_b / unknowns_a);
}

std::vector<Profile> performance_profiles(const std::vector<std::vector<double>>& costs) {
  std::vector<Profile> out(costs.size());
  if (costs.empty()) return out;
  const std::size_t problems = costs[0].size();
  std::vector<double> best(problems, std::numeric_limits<double>::infinity());
  for (const auto& row : costs) {
    for (std::size_t p = 0; p < problems; ++p) {
      if (std::isfinite(row[p])) best[p] = std::min(best[p], row[p]);
    }
  }
  const auto solved =
      static_cast<double>(std::count_if(best.begin(), best.end(), [](double v) { return std::isfinite(v); }));
  if (solved == 0) return out;
  for (std::size_t s = 0; s < costs.size(); ++s) {
    std::vector<double> ratios;
    for (std::size_t p = 0; p < problems; ++p) {
      if (std::isfinite(costs[s][p])) ratios.push_back(costs[s][p] / best[p]);
    }
    std::sort(ratios.begin(), ratios.end());
    for (std::size_t k = 0; k < ratios.size(); ++k) {
      // Equal ratios are one step.
      if (k + 1 < ratios.size() && ratios[k + 1] == ratios[k]) continue;
      out[s].factor.push_back(ratios[k]);
      out[s].share.push_back(static_cast<double>(k + 1) / solved);
    }
  }
  return out;
}

double wall_seconds(const Measured& m) {
  return m.seconds;
}

double processor_seconds(const Measured& m) {
  return m.cpu_seconds;
}

std::vector<const Measured*> lasting(std::span<const Measured* const> cells, double error) {
  std::vector<const Measured*> out;
  for (const Measured* m : cells) {
    const bool lost =
        m->error && *m->error <= error && std::any_of(cells.begin(), cells.end(), [&](const Measured* finer) {
          return finer->error && *finer->error > error && finer->unknowns() > m->unknowns() &&
                 finer->label("formulation") == m->label("formulation");
        });
    if (!lost) out.push_back(m);
  }
  return out;
}

const Measured* cheapest(std::span<const Measured* const> cells, double error, Cost cost) {
  const Measured* best = nullptr;
  for (const Measured* m : cells) {
    if (!m->error || *m->error > error) continue;
    if (!best || cost(*m) < cost(*best)) best = m;
  }
  return best;
}

std::optional<double> seconds_at(std::span<const Measured* const> cells, double error, Cost cost) {
  std::optional<double> best;
  const auto offer = [&](double seconds) {
    if (!best || seconds < *best) best = seconds;
  };
  for (const Measured* a : cells) {
    if (!a->error) continue;
    if (*a->error <= error) offer(cost(*a));
    for (const Measured* b : cells) {
      // From a coarse mesh that misses it to a finer one that does not.
      if (!b->error || !(*a->error > error) || !(*b->error < error) || !(*b->error > 0)) continue;
      if (!(b->unknowns() > a->unknowns())) continue;
      const double t = std::log(*a->error / error) / std::log(*a->error / *b->error);
      offer(std::exp(std::log(cost(*a)) + t * std::log(cost(*b) / cost(*a))));
    }
  }
  return best;
}

std::optional<double> extrapolated_seconds(std::span<const Measured* const> cells, double error, Cost cost) {
  const Measured *coarse = nullptr, *fine = nullptr;
  for (const Measured* m : cells) {
    if (!m->error || (fine && m->unknowns() <= fine->unknowns())) continue;
    coarse = fine;
    fine = m;
  }
  if (!coarse || !(*fine->error > error) || !(*fine->error < *coarse->error)) return {};
  if (!(cost(*fine) > cost(*coarse))) return {};
  const double t = std::log(*fine->error / error) / std::log(*coarse->error / *fine->error);
  return cost(*fine) * std::exp(t * std::log(cost(*fine) / cost(*coarse)));
}

Cells where(std::span<const Measured> cells, const std::string& key, const std::string& value) {
  Cells out;
  for (const Measured& m : cells) {
    if (m.label(key) == value) out.push_back(&m);
  }
  return out;
}

Cells where(const Cells& cells, const std::string& key, const std::string& value) {
  Cells out;
  std::copy_if(cells.begin(), cells.end(), std::back_inserter(out),
               [&](const Measured* m) { return m->label(key) == value; });
  return out;
}

std::vector<std::string> label_values(std::span<const Measured> cells, const std::string& key) {
  std::vector<std::string> out;
  for (const Measured& m : cells) {
    const std::string value = m.label(key);
    if (!value.empty() && std::find(out.begin(), out.end(), value) == out.end()) out.push_back(value);
  }
  return out;
}

Section all_cells(std::span<const Measured> cells) {
  Section s{"All cells",
            "Seconds: the least and the median of the timed runs, and processor time of all threads. "
            "The whole of it is in results.csv and results.json."};
  Table t;
  t.head = {"cell",     "status",    "value",      "reference",      "error",
            "unknowns", "non-zeros", "iterations", "factorizations", "solves",
            "seconds",  "median",    "CPU",        "state",          "source or reason"};
  for (const Measured& m : cells) {
    if (!m.good()) t.failed.push_back(t.rows.size());
    const auto known = [](const std::optional<double>& v) { return v ? text(*v, 6) : std::string(); };
    t.rows.push_back(
        {m.id, m.status, known(m.value), known(m.reference), m.error ? percent(*m.error) : "",
         m.displacements > 0 ? std::to_string(m.displacements) + " + " + std::to_string(m.multipliers) : "",
         std::to_string(m.nonzeros), std::to_string(m.iterations), std::to_string(m.factorizations),
         std::to_string(m.solves), text(m.seconds), text(m.seconds_median), text(m.cpu_seconds), m.hash,
         m.good() ? m.source : m.reason});
  }
  s.tables.push_back(std::move(t));
  return s;
}

std::string percent(double fraction, int digits) {
  return text(100 * fraction, digits) + " %";
}

}  // namespace isochor::studies
