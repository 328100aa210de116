// What `run --explain` prints.
#include <algorithm>
#include <cstdio>

#include "apps/commands.h"
#include "apps/table.h"

namespace isochor::app {

namespace {

std::string share(double part, double whole) {
  return whole > 0 ? number(100 * part / whole, 3) + " %" : "";
}

std::string megabytes(double bytes) {
  return number(bytes / (1024 * 1024), 3) + " MB";
}

void print_pools(const Explanation& e, const RunResult& r) {
  double evaluation = 0, bytes = 0;
  for (const PoolShare& p : e.pools) {
    evaluation += p.seconds;
    bytes += static_cast<double>(p.bytes);
  }
  Table table(
      {"stencils", "number", "rows", "multipliers", "slots", "of all slots", "evaluation", "of the run"});
  table.numbers_from(1, 1);
  for (const PoolShare& p : e.pools) {
    const std::string rows = p.rows_name + (p.prescribed > 0 ? " (given)" : "");
    table.add({p.name, std::to_string(p.stencils), rows,
               p.multipliers > 0 ? std::to_string(p.multipliers) : "",
               megabytes(static_cast<double>(p.bytes)), share(static_cast<double>(p.bytes), bytes),
               share(p.seconds, evaluation),
               share(p.seconds / std::max(evaluation, 1e-300) * r.stages.evaluate, r.stages.total)});
  }
  std::printf("\n%s", table.text("  ").c_str());
}

void print_stages(const RunResult& r) {
  const StageSeconds& t = r.stages;
  Table table({"time", "seconds", "share"});
  table.numbers_from(1, 2);
  const double rest = t.total - t.analyze - t.evaluate - t.gather - t.factor - t.solve - t.line_search;
  const std::pair<const char*, double> stages[] = {
      {"analysis (once)", t.analyze}, {"evaluation", t.evaluate}, {"gathering", t.gather},
      {"factorization", t.factor},    {"solving", t.solve},       {"line search", t.line_search},
      {"everything else", rest}};
  for (const auto& [name, seconds] : stages) table.add({name, number(seconds, 3), share(seconds, t.total)});
  std::printf("\n%s", table.text("  ").c_str());
}

}  // namespace

void print_explanation(const Explanation& e, const RunResult& r) {
  Table effects({"what is on", "why"});
  for (const EffectNote& note : e.effects) effects.add({note.effect, note.why});
  std::printf("\n%s", effects.text("  ").c_str());
  print_pools(e, r);
  print_stages(r);
  const double factor = static_cast<double>(r.size.factor_nonzeros) * sizeof(double);
  Table memory({"size", "", ""});
  memory.add(
      {"unknowns",
       std::to_string(e.displacements) + " displacements + " + std::to_string(e.multipliers) + " multipliers",
       std::to_string(e.held) + " displacements held by supports"});
  memory.add({"matrix", std::to_string(e.nonzeros) + " non-zeros", ""});
  memory.add({"engine", megabytes(static_cast<double>(r.size.engine_bytes)), "slots, gather lists, state"});
  memory.add({"factor", megabytes(factor), std::to_string(r.size.factor_nonzeros) + " non-zeros"});
  std::printf("\n%s", memory.text("  ").c_str());
}

}  // namespace isochor::app
