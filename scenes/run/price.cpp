#include "scenes/run/price.h"

#include <chrono>

#include "scenes/run/error_forecast.h"

namespace isochor {

namespace {

using Clock = std::chrono::steady_clock;

class Pricing {
 public:
  Pricing(const SceneDef& scene, const PriceOptions& options, SettingChoices choices, Price& out)
      : scene_(scene), options_(options), choices_(std::move(choices)), forecast_(options.model), out_(out) {
    for (const auto& element : choices_.elements) forecast_.ladders.push_back({element, {}, {}});
  }

  // False: interrupted, or nothing else can be run.
  bool try_next(std::size_t ladder);
  void make_rows();
  bool any() const;

 private:
  const SceneDef& scene_;
  const PriceOptions& options_;
  SettingChoices choices_;
  ErrorForecast forecast_;
  Price& out_;
};

bool Pricing::try_next(std::size_t l) {
  ErrorLadder& ladder = forecast_.ladders[l];
  const auto cost = forecast_.cost(l, ladder.levels());
  if (cost && cost->seconds() > options_.most_seconds) return true;
  Trial trial;
  trial.setting.element = ladder.element;
  trial.setting.refine = ladder.levels();
  trial.predicted_seconds = cost ? cost->seconds() : 0;
  RunOptions run = options_.run;
  run.folder.clear();
  run.on_step = {};
  run.log = {};
  // What was expected to be short and is not.
  const double most = 3 * options_.most_seconds;
  if (!run.budget || *run.budget > most) run.budget = most;
  const RunResult result = run_scene(with_setting(scene_, choices_, trial.setting), run);
  trial.status = result.status;
  trial.reason = result.reason;
  trial.elements = result.elements;
  trial.unknowns = result.size.displacement_unknowns + result.size.multipliers;
  trial.seconds = result.wall_s;
  if (result.status == RunStatus::converged) {
    ladder.answers.push_back(answers_of(result));
    ladder.costs.push_back(cost_of(result, ladder.element));
    if (const auto evidence = forecast_.evidence(l)) {
      trial.indicator = evidence->largest;
      trial.held_by = evidence->held_by;
      trial.how = evidence->how;
    }
  }
  out_.trials.push_back(trial);
  if (options_.on_trial) options_.on_trial(trial);
  return result.status != RunStatus::interrupted;
}

bool Pricing::any() const {
  for (const ErrorLadder& ladder : forecast_.ladders) {
    if (ladder.levels() > 0) return true;
  }
  return false;
}

void Pricing::make_rows() {
  for (const double error : options_.errors) {
    PriceRow row;
    row.error = error;
    double least = 0;  // work of the cheapest plan so far
    for (std::size_t l = 0; l < forecast_.ladders.size(); ++l) {
      const auto plan = forecast_.plan(l, error, std::min(options_.most_levels, choices_.most_levels));
      if (!plan || plan->cost.cells == 0) continue;
      const bool cheaper = plan->work < least || (plan->work == least && plan->cost.work() < row.cost.work());
      if (row.setting && !cheaper) continue;
      least = plan->work;
      row.setting = Setting{};
      row.setting->element = forecast_.ladders[l].element;
      row.setting->refine = plan->level;
      row.cost = plan->cost;
      row.search_s = plan->seconds;
    }
    out_.rows.push_back(row);
  }
}

}  // namespace

Price price_of(const SceneDef& scene, const PriceOptions& options) {
  Price out;
  const auto start = Clock::now();
  if (!has_answers(scene)) {
    out.reason =
        "the scene has no probe and no metric with an error of discretization, so an error of it has no "
        "price; add "
        "one under \"probes\" or \"metrics\"";
    return out;
  }
  if (const auto checked = check_scene(scene); !checked) {
    out.reason = checked.error();
    return out;
  }
  auto choices = setting_choices(scene);
  if (!choices) {
    out.reason = choices.error();
    return out;
  }
  const std::size_t elements = choices.value().elements.size();
  Pricing pricing(scene, options, std::move(choices).value(), out);
  bool goes_on = true;
  for (std::size_t l = 0; l < elements && goes_on; ++l) goes_on = pricing.try_next(l);
  // One element says nothing of its error on one mesh.
  if (elements == 1 && goes_on && pricing.any()) goes_on = pricing.try_next(0);
  out.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  if (!goes_on)
    out.reason = "interrupted";
  else if (!pricing.any())
    out.reason = "no run converged on the mesh of the scene: " + out.trials.back().reason;
  else
    pricing.make_rows();
  return out;
}

}  // namespace isochor
