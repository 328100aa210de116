// run --price: what errors would cost.
#include <cmath>
#include <cstdio>

#include "apps/commands.h"
#include "apps/stop.h"
#include "apps/table.h"
#include "scenes/run/machine_cost.h"
#include "scenes/run/price.h"
#include "scenes/run/step_errors.h"

namespace isochor::app {

namespace {

std::string memory(double bytes) {
  return bytes < 1e9 ? number(1e-6 * bytes, 2) + " MB" : number(1e-9 * bytes, 2) + " GB";
}

std::string counted(double value) {
  return std::to_string(std::llround(value));
}

void print_rows(const Price& p) {
  Table table({"error", "element and mesh", "unknowns", "seconds", "with runs before it", "memory"});
  table.numbers_from(2, 5);
  for (const PriceRow& row : p.rows) {
    const std::string error = number(100 * row.error, 2) + " %";
    if (!row.setting) {
      table.add({error, "not within the levels that --error tries", "", "", "", ""});
      continue;
    }
    table.add({error, describe(*row.setting), counted(row.cost.unknowns), duration(row.cost.seconds()),
               duration(row.search_s), memory(row.cost.bytes())});
  }
  std::printf("\n%s", table.text("  ").c_str());
  std::printf("  by %zu runs in %s; errors as of second order, times by what elements cost on this machine\n",
              p.trials.size(), duration(p.seconds).c_str());
}

void print_json(const Price& p) {
  std::string text = "[";
  for (const PriceRow& row : p.rows) {
    char line[256];
    std::snprintf(line, sizeof line,
                  "%s\n {\"error\": %g, \"setting\": \"%s\", \"unknowns\": %.0f, \"seconds\": %.3g, "
                  "\"seconds_with_runs_before\": %.3g, \"memory_bytes\": %.3g}",
                  text == "[" ? "" : ",", row.error, row.setting ? describe(*row.setting).c_str() : "",
                  row.cost.unknowns, row.cost.seconds(), row.search_s, row.cost.bytes());
    text += line;
  }
  std::printf("%s\n]\n", text.c_str());
}

}  // namespace

int price(const RunArguments& a, const SceneDef& scene) {
  PriceOptions options;
  options.run.threads = a.threads;
  options.run.budget = a.budget;
  options.run.stop = stop_wanted;
  const bool tables = !a.quiet && !a.json;
  options.model = machine_cost_model(a.threads, stop_wanted, [&](const std::string& text) {
    if (!a.quiet) std::fprintf(stderr, "isochor: note: %s\n", text.c_str());
  });
  options.on_trial = [&](const Trial& t) {
    if (tables) print_trial(t);
  };
  const Price found = price_of(scene, options);
  if (!found.reason.empty()) {
    std::fprintf(stderr, "isochor: --price: %s\n", found.reason.c_str());
    if (stop_wanted()) return interrupted;
    return found.trials.empty() ? bad_input : exit_code(found.trials.back().status);
  }
  if (a.json)
    print_json(found);
  else
    print_rows(found);
  if (tables && steps_matter(scene))
    std::printf("  for the steps of the scene; --error cuts them where they hold an answer up\n");
  return success;
}

}  // namespace isochor::app
