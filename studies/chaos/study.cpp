#include "studies/chaos/study.h"

#include <poll.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <map>

#include "scenes/run/outputs.h"
#include "studies/chaos/child.h"

namespace isochor::studies {

namespace {

constexpr const char* kMethods[] = {"automatic",        "saddle_point",        "condensation",
                                    "dual_gradients",   "augmented_gradients", "dual_ascent",
                                    "augmented_ascent", "position_based"};

std::string quoted(std::string text) {
  for (char& c : text) {
    if (c == '"' || c == '\n' || c == '\r') c = '\'';
  }
  return "\"" + text + "\"";
}

std::string row(const ChaosOutcome& o) {
  char numbers[200];
  std::snprintf(numbers, sizeof numbers, "%llu,%s,%s,%d,%d,%d,%.3f,%.3f,%.6g,%ld,",
                static_cast<unsigned long long>(o.seed), to_string(o.verdict), o.kind.c_str(), o.steps,
                o.asked, o.iterations, o.seconds, std::max(0.0, o.overshoot), o.min_J, o.inverted);
  return numbers + quoted(o.reason) + "\n";
}

std::string csv(const std::vector<ChaosOutcome>& outcomes) {
  std::string text = "seed,verdict,kind,steps,asked,iterations,seconds,overshoot,min_J,inverted,reason\n";
  for (const ChaosOutcome& o : outcomes) text += row(o);
  return text;
}

struct Count {
  std::array<std::size_t, 5> verdicts{};
  std::vector<std::uint64_t> broken;
  void add(const ChaosOutcome& o) {
    ++verdicts[static_cast<std::size_t>(o.verdict)];
    if (o.verdict == ChaosVerdict::broken) broken.push_back(o.seed);
  }
};

std::string seeds_of(const std::vector<std::uint64_t>& seeds, std::size_t most) {
  std::string text;
  for (std::size_t i = 0; i < std::min(most, seeds.size()); ++i)
    text += (i > 0 ? " " : "") + std::to_string(seeds[i]);
  return text + (seeds.size() > most ? " ..." : "");
}

std::string table(const std::string& head, const std::map<std::string, Count>& counts) {
  std::string text =
      "| " + head + " | seeds | solved | told | refused | stopped | broken | seeds that are broken |\n";
  text += "|---|---|---|---|---|---|---|---|\n";
  for (const auto& [name, count] : counts) {
    std::size_t all = 0;
    for (const std::size_t n : count.verdicts) all += n;
    text += "| " + name + " | " + std::to_string(all);
    for (const std::size_t n : count.verdicts) text += " | " + std::to_string(n);
    text += " | " + seeds_of(count.broken, 12) + " |\n";
  }
  return text + "\n";
}

ChaosChild child_of(std::uint64_t seed, const ChaosStudyOptions& options) {
  const std::string folder = options.folder + "/seeds/" + std::to_string(seed);
  return {seed, folder, options.limit, [&] {
            return run_chaos_scene(chaos_scene(seed, options.size), {folder, options.judge_time});
          }};
}

}  // namespace

std::string chaos_tables(const std::vector<ChaosOutcome>& outcomes, const ChaosSize& size) {
  std::map<std::string, Count> all, methods, parts, kinds;
  double overshoot = 0;
  for (const ChaosOutcome& o : outcomes) {
    const SceneDef scene = chaos_scene(o.seed, size).scene;
    all["all"].add(o);
    methods[kMethods[static_cast<std::size_t>(scene.analysis.options.method)]].add(o);
    for (const std::string& part : parts_of(scene)) parts[part].add(o);
    if (o.verdict == ChaosVerdict::broken) kinds[o.kind].add(o);
    overshoot = std::max(overshoot, o.overshoot);
  }
  std::string text = "# Chaos\n\n" + table("", all);
  char line[100];
  std::snprintf(line, sizeof line, "Budgets were overshot by %.2f s at most.\n\n", overshoot);
  text += line;
  text += "| broken | seeds | |\n|---|---|---|\n";
  for (const auto& [kind, count] : kinds)
    text += "| " + kind + " | " + std::to_string(count.broken.size()) + " | " + seeds_of(count.broken, 1000) +
            " |\n";
  return text + "\n" + table("method", methods) + table("part of the scene", parts);
}

ChaosStudyResult run_chaos_study(const ChaosStudyOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  ChaosStudyResult result;
  std::error_code code;
  std::filesystem::create_directories(options.folder + "/seeds", code);
  if (code) {
    result.failure = options.folder + ": cannot be made: " + code.message();
    return result;
  }
  const std::size_t total = static_cast<std::size_t>(options.last - options.first + 1);
  std::vector<ChaosChild> running;
  std::uint64_t next = options.first;
  const auto finish = [&](ChaosOutcome out) {
    if (out.verdict == ChaosVerdict::broken) ++result.broken;
    if (out.verdict != ChaosVerdict::broken && !options.keep)
      std::filesystem::remove_all(options.folder + "/seeds/" + std::to_string(out.seed), code);
    result.outcomes.push_back(out);
    if (auto r = write_text(options.folder + "/seeds.csv", csv(result.outcomes)); !r)
      result.failure = r.error();
    if (options.on_seed) options.on_seed(out, result.outcomes.size(), total);
  };
  while (result.failure.empty() && (next <= options.last || !running.empty())) {
    result.interrupted = options.stop && options.stop();
    if (result.interrupted) break;  // what runs is ended with its owner
    while (next <= options.last && running.size() < static_cast<std::size_t>(std::max(1, options.jobs)))
      running.push_back(child_of(next++, options));
    std::vector<pollfd> pipes;
    for (const ChaosChild& child : running) pipes.push_back({child.pipe(), POLLIN, 0});
    poll(pipes.data(), pipes.size(), 50);
    for (std::size_t i = running.size(); i-- > 0;) {
      if (!running[i].ended()) continue;
      ChaosOutcome out = running[i].outcome();
      std::vector<ChaosChild> others;
      for (std::size_t k = 0; k < running.size(); ++k) {
        if (k != i) others.push_back(std::move(running[k]));
      }
      running.swap(others);
      finish(std::move(out));
    }
  }
  std::sort(result.outcomes.begin(), result.outcomes.end(),
            [](const ChaosOutcome& a, const ChaosOutcome& b) { return a.seed < b.seed; });
  const std::string tables = chaos_tables(result.outcomes, options.size);
  if (auto r = write_text(options.folder + "/tables.md", tables); !r) result.failure = r.error();
  if (auto r = write_text(options.folder + "/seeds.csv", csv(result.outcomes)); !r)
    result.failure = r.error();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

Result<std::pair<std::uint64_t, std::uint64_t>> parse_seeds(const std::string& text) {
  const auto dash = text.find('-');
  const std::string low = text.substr(0, dash),
                    high = dash == std::string::npos ? low : text.substr(dash + 1);
  std::uint64_t first = 0, last = 0;
  const auto whole = [](const std::string& part, std::uint64_t& value) {
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    return error == std::errc{} && end == part.data() + part.size();
  };
  if (!whole(low, first) || !whole(high, last) || last < first)
    return Error{"--seeds " + text + ": give two whole numbers, the lower one first, as in 1-100"};
  return std::pair{first, last};
}

}  // namespace isochor::studies
