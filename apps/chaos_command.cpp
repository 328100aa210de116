// study chaos: random scenes, judged.
#include <array>
#include <chrono>
#include <cstdio>

#include "apps/commands.h"
#include "apps/table.h"
#include "studies/chaos/study.h"

namespace isochor::app {

namespace {

void print_seed(const studies::ChaosOutcome& o, std::size_t done, std::size_t total, double elapsed) {
  const double remaining = elapsed / static_cast<double>(done) * static_cast<double>(total - done);
  const std::string place = std::to_string(done) + "/" + std::to_string(total);
  std::printf("%11s  seed %-8llu %-8s %-20s %6.2f s  ETA %s  %s\n", place.c_str(),
              static_cast<unsigned long long>(o.seed), to_string(o.verdict), o.kind.c_str(), o.seconds,
              duration(remaining).c_str(), o.reason.substr(0, 160).c_str());
  std::fflush(stdout);
}

}  // namespace

int chaos(const StudyArguments& a, const std::function<bool()>& stop) {
  const auto seeds = studies::parse_seeds(a.seeds);
  if (!seeds) {
    std::fprintf(stderr, "isochor: %s\n", seeds.error().c_str());
    return bad_input;
  }
  studies::ChaosStudyOptions options;
  options.first = seeds.value().first;
  options.last = seeds.value().second;
  options.folder = a.folder.empty() ? "out/study/chaos" : a.folder;
  options.limit = a.limit;
  options.jobs = a.jobs;
  options.keep = a.keep;
  options.judge_time = !a.untimed;
  if (a.quick) options.size = studies::ChaosSize::small();
  options.stop = stop;
  const auto start = std::chrono::steady_clock::now();
  options.on_seed = [&](const studies::ChaosOutcome& o, std::size_t done, std::size_t total) {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    if (!a.quiet || o.verdict == studies::ChaosVerdict::broken) print_seed(o, done, total, elapsed.count());
  };
  const studies::ChaosStudyResult result = studies::run_chaos_study(options);
  if (!result.failure.empty()) {
    std::fprintf(stderr, "isochor: %s\n", result.failure.c_str());
    return bad_input;
  }
  std::array<std::size_t, 5> count{};
  for (const auto& o : result.outcomes) ++count[static_cast<std::size_t>(o.verdict)];
  std::printf("\nchaos: %zu seeds in %s: %zu solved, %zu told, %zu refused, %zu stopped, %zu broken\n",
              result.outcomes.size(), duration(result.seconds).c_str(), count[0], count[1], count[2],
              count[3], count[4]);
  std::printf("outputs in %s/: seeds.csv, tables.md, and seeds/N/scene.json of what is broken\n",
              options.folder.c_str());
  if (result.interrupted) return interrupted;
  return result.broken > 0 ? not_converged : success;
}

}  // namespace isochor::app
