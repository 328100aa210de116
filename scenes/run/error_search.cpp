#include "scenes/run/error_search.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>

#include "engine/base/available_memory.h"
#include "engine/base/chars.h"
#include "engine/base/text.h"
#include "scenes/run/error_forecast.h"
#include "scenes/run/error_places.h"
#include "scenes/run/outputs.h"
#include "scenes/run/step_errors.h"

namespace isochor {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;
constexpr double kNever = std::numeric_limits<double>::infinity();
// The share of the error of every answer that the cells hold which are refined.
constexpr double kHeld = 0.75;
// Refining some cells halves fewer errors at once.
constexpr int kRoundsPerLevel = 3;
// Cells that one that is refined makes, beside itself, and its neighbors, which must fit.
constexpr double kMadeByOne = 10;
// Steps are cut until their part of the error is no more than this; and so often at most.
constexpr double kOfSteps = 0.4;
constexpr int kMostHalved = 8;
// What runs that tell of the steps may take of the time that is left.
constexpr double kTimeForSteps = 0.3;

std::string two_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, value < 100 ? "%.2g" : "%.0f", value);
  return text;
}

std::string percent(double relative) {
  return std::isfinite(relative) ? two_digits(100 * relative) + " %" : "more than can be told";
}

class Search {
 public:
  Search(const SceneDef& scene, const ErrorSearchOptions& options, ErrorSearch& out)
      : scene_(scene), options_(options), out_(out) {}
  Result<void> prepare();
  void run();

 private:
  bool reached() const { return out_.best && indicator(*out_.best) <= options_.error; }
  bool mesh_reached() const;
  void try_steps();
  void try_both();
  RunResult run_trial(const Setting& setting, bool origins);
  Evidence with_steps(const Evidence& mesh, int halved) const;
  double indicator(std::size_t trial) const { return out_.trials[trial].indicator.value_or(kNever); }
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  std::optional<double> time_left() const;

  bool of_all(std::size_t ladder) const { return !forecast_.ladders[ladder].local_of; }
  int most_levels(std::size_t ladder) const;
  bool affordable(std::size_t ladder);
  std::optional<std::size_t> choose();

  Setting next_setting(std::size_t ladder) const;
  bool wants_origins(std::size_t ladder) const;
  void choose_cells(std::size_t ladder, const RunResult& result);
  // Runs it; false: the search is over.
  bool try_next(std::size_t ladder);
  Result<void> publish(const SceneDef& scene) const;
  bool adopt(std::size_t trial, const RunResult& result, const Evidence& evidence);
  std::string trial_folder() const;
  void conclude();
  std::string why_no_more() const;
  std::string shape() const;

  const SceneDef& scene_;
  const ErrorSearchOptions& options_;
  ErrorSearch& out_;
  SettingChoices choices_;
  ErrorForecast forecast_;
  std::vector<std::string> closed_;  // by ladder: why it has no next run; empty: it has
  std::vector<Setting> next_;        // by ladder, of those where some cells are refined
  StepErrors steps_;
  int halved_ = 0;               // steps of the answer
  double of_steps_ = 0;          // their part of the error
  std::string no_shorter_;       // why steps are not cut further though they are too long
  std::vector<Answer> answers_;  // of the best
  Evidence evidence_;            // of its mesh and element alone
  Clock::time_point start_ = Clock::now();
  bool out_of_time_ = false;
};

Result<void> Search::prepare() {
  if (!(options_.error > 0) || !(options_.error < 1)) {
    return Error{"error = " + number(options_.error) +
                 "; ask for a relative error above 0 and below 1, such as 0.01 or 1%"};
  }
  if (options_.run.budget && !(*options_.run.budget > 0))
    return Error{"budget = " + number(*options_.run.budget) + " s; it must be positive"};
  if (options_.run.resume)
    return Error{
        "resume goes on with one run, and a search for an error makes several; leave one of them out"};
  if (!has_answers(scene_)) {
    return Error{
        "the scene has no probe and no metric with an error of discretization, so there is nothing to "
        "be within an error; add one under \"probes\" or \"metrics\""};
  }
  if (auto r = check_scene(scene_); !r) return r;
  auto choices = setting_choices(scene_);
  if (!choices) return choices.failure();
  choices_ = std::move(choices).value();
  for (const auto& element : choices_.elements) forecast_.ladders.push_back({element, {}, {}});
  for (std::size_t l = 0; choices_.can_local && l < choices_.elements.size(); ++l) {
    if (choices_.elements[l] == Element::tet4) continue;
    forecast_.ladders.push_back({choices_.elements[l], {}, {}});
    forecast_.ladders.back().local_of = l;
  }
  closed_.resize(forecast_.ladders.size());
  next_.resize(forecast_.ladders.size());
  return {};
}

std::optional<double> Search::time_left() const {
  if (!options_.run.budget) return {};
  return *options_.run.budget - elapsed();
}

// --- What is expected -------------------------------------------------------------------------------------

int Search::most_levels(std::size_t l) const {
  return of_all(l) ? std::min(options_.most_levels, choices_.most_levels)
                   : kRoundsPerLevel * options_.most_levels;
}

// Closes the ladder where its next run asks for more than there is.
bool Search::affordable(std::size_t l) {
  const int level = forecast_.ladders[l].levels();
  std::string& closed = closed_[l];
  if (level > most_levels(l)) {
    closed = "the mesh has been refined " + std::to_string(level - 1) + " times, no more is tried";
    return false;
  }
  const auto cost = forecast_.cost(l, level);
  if (!cost) return true;
  const auto left = time_left();
  if (left && cost->seconds() > *left) {
    closed = "the next run would take about " + two_digits(cost->seconds()) + " s and " +
             two_digits(std::max(0.0, *left)) + " s of the budget are left";
    out_of_time_ = true;
    return false;
  }
  if (const double memory = available_memory(); cost->bytes() > memory) {
    closed = "the next run would take about " + two_digits(1e-9 * cost->bytes()) + " GB and " +
             two_digits(1e-9 * memory) + " GB are free";
    return false;
  }
  return true;
}

std::optional<std::size_t> Search::choose() {
  const auto& ladders = forecast_.ladders;
  // The cheap elements on the mesh as it is: what they differ by tells how far there is to go.
  const std::size_t elements = choices_.elements.size();
  for (std::size_t l = 0; l + 1 < elements; ++l) {
    if (ladders[l].levels() == 0 && closed_[l].empty() && affordable(l)) return l;
  }
  std::optional<std::size_t> best;
  double least = kNever;
  for (std::size_t l = 0; l < ladders.size(); ++l) {
    // The first run of the others is that of the same element.
    if (!of_all(l) && ladders[l].levels() == 0) continue;
    if (!closed_[l].empty() || !affordable(l)) continue;
    const auto plan = forecast_.plan(l, options_.error, most_levels(l));
    const double cost = plan ? plan->work : kNever;
    // Where none is expected to reach it, the better element comes nearer.
    if (!best || cost < least || (cost == kNever && least == kNever)) best = l;
    least = std::min(least, cost);
  }
  // An element that has not been run on the mesh of the scene and costs less than that is looked at before:
  // how good it is was a guess.
  const auto next = best ? forecast_.cost(*best, ladders[*best].levels()) : std::nullopt;
  for (std::size_t l = 0; next && l < elements; ++l) {
    if (ladders[l].levels() > 0 || !closed_[l].empty() || !affordable(l)) continue;
    const auto cost = forecast_.cost(l, 0);
    if (cost && cost->work() < next->work()) return l;
  }
  return best;
}

// --- What is run ------------------------------------------------------------------------------------------

std::string Search::trial_folder() const {
  return options_.run.folder.empty() ? "" : (fs::path(options_.run.folder) / ".trial").string();
}

Setting Search::next_setting(std::size_t l) const {
  if (!of_all(l)) return next_[l];
  Setting setting;
  setting.element = forecast_.ladders[l].element;
  setting.refine = forecast_.ladders[l].levels();
  return setting;
}

// Of runs whose mesh may be refined where it counts.
bool Search::wants_origins(std::size_t l) const {
  return !of_all(l) || (forecast_.ladders[l].levels() == 0 &&
                        std::any_of(forecast_.ladders.begin(), forecast_.ladders.end(),
                                    [&](const ErrorLadder& other) { return other.local_of == l; }));
}

// What the next mesh of a ladder refines of the one that was run.
void Search::choose_cells(std::size_t l, const RunResult& result) {
  ErrorLadder& ladder = forecast_.ladders[l];
  auto cells = cells_to_refine(result.origins, kHeld);
  double marked = 0;
  for (const auto& of_body : cells) marked += static_cast<double>(of_body.size());
  if (marked == 0) {
    closed_[l] = "no cell has an error to refine for";
    return;
  }
  next_[l].element = ladder.element;
  next_[l].rounds.push_back(std::move(cells));
  ladder.growth = std::min(8.0, 1 + kMadeByOne * marked / std::max<double>(1, result.elements));
}

RunResult Search::run_trial(const Setting& setting, bool origins) {
  Trial trial;
  trial.setting = setting;
  RunOptions options = options_.run;
  options.folder = trial_folder();
  options.log = {};
  options.on_step = {};
  options.origins = origins;
  if (const auto left = time_left()) options.budget = std::max(1e-3, *left);
  RunResult result = run_scene(with_setting(scene_, choices_, setting), options);
  trial.status = result.status;
  trial.reason = result.reason;
  trial.elements = result.elements;
  trial.unknowns = result.size.displacement_unknowns + result.size.multipliers;
  trial.seconds = result.wall_s;
  out_.trials.push_back(std::move(trial));
  return result;
}

bool Search::try_next(std::size_t l) {
  ErrorLadder& ladder = forecast_.ladders[l];
  const int level = ladder.levels();
  const bool origins = wants_origins(l);
  const auto cost = forecast_.cost(l, level);
  RunResult result = run_trial(next_setting(l), origins);
  const std::size_t number = out_.trials.size() - 1;
  if (cost) out_.trials[number].predicted_seconds = cost->seconds();
  const Trial trial = out_.trials[number];
  bool goes_on = true;
  if (result.status == RunStatus::converged) {
    ladder.answers.push_back(answers_of(result));
    ladder.costs.push_back(cost_of(result, ladder.element));
    for (std::size_t k = 0; k < forecast_.ladders.size(); ++k) {
      ErrorLadder& other = forecast_.ladders[k];
      if (other.local_of == l && level == 0) {
        other.answers = ladder.answers;
        other.costs = ladder.costs;
      }
      if (origins && (k == l ? !of_all(l) : other.local_of == l)) choose_cells(k, result);
    }
    const Evidence of_mesh = forecast_.evidence(l).value_or(Evidence{});
    const Evidence evidence = with_steps(of_mesh, 0);
    if (!of_mesh.how.empty()) {
      if (choices_.steps_matter) out_.trials[number].of_mesh = of_mesh.largest;
      out_.trials[number].indicator = evidence.largest;
      out_.trials[number].held_by = evidence.held_by;
      out_.trials[number].how = evidence.how;
    }
    const auto better = [&] {
      if (!out_.best) return true;
      const Trial &is = out_.trials[number], &was = out_.trials[*out_.best];
      if (choices_.steps_matter) return is.of_mesh.value_or(kNever) < was.of_mesh.value_or(kNever);
      return indicator(number) < indicator(*out_.best);
    };
    if (better()) {
      answers_ = answers_of(result);
      evidence_ = of_mesh;
      goes_on = adopt(number, result, evidence);
    }
  } else {
    closed_[l] = std::string(to_string(result.status)) + ": " + result.reason;
    if (!out_.best) out_.result = std::move(result);
    goes_on = trial.status != RunStatus::interrupted && trial.status != RunStatus::not_written &&
              trial.status != RunStatus::budget && trial.status != RunStatus::failed;
  }
  if (options_.on_trial) options_.on_trial(out_.trials[number]);
  return goes_on;
}

// Files of a finished trial take the place of those of the one before.
Result<void> move_up(const fs::path& from, const fs::path& to) {
  std::error_code code;
  fs::create_directories(to, code);
  std::vector<fs::directory_entry> entries;
  for (const auto& entry : fs::directory_iterator(from, code)) entries.push_back(entry);
  for (const auto& entry : entries) {
    if (entry.is_directory()) {
      if (auto r = move_up(entry.path(), to / entry.path().filename()); !r) return r;
    } else {
      fs::rename(entry.path(), to / entry.path().filename(), code);
    }
    if (code) break;
  }
  if (code)
    return Error{"outputs cannot be moved from " + from.string() + " to " + to.string() + ": " +
                 code.message()};
  fs::remove_all(from, code);
  return {};
}

// What the last trial wrote becomes what the search has written.
Result<void> Search::publish(const SceneDef& scene) const {
  if (options_.run.folder.empty()) return {};
  if (auto opened = RunOutputs::open(options_.run.folder, scene); !opened) return opened.failure();
  if (out_.best) {
    if (auto r = write_rounds(out_.trials[*out_.best].setting, options_.run.folder); !r) return r;
  }
  return move_up(trial_folder(), options_.run.folder);
}

// The best so far: its outputs are those of the search from now on.
bool Search::adopt(std::size_t trial, const RunResult& result, const Evidence& evidence) {
  out_.best = trial;
  out_.result = result;
  out_.scene = with_setting(scene_, choices_, out_.trials[trial].setting);
  out_.overrides = overrides_for(scene_, choices_, out_.trials[trial].setting, options_.run.folder);
  out_.accuracy = {};
  out_.accuracy.entries = evidence.entries;
  add_places(result.origins, out_.accuracy.entries);
  out_.accuracy.how = evidence.how;
  if (evidence.how.empty()) out_.accuracy.reason = "no indicator: there has been nothing to compare with";
  const Result<void> moved = publish(out_.scene);
  if (moved) return true;
  out_.result.status = RunStatus::not_written;
  out_.result.reason = moved.error();
  out_.trials[trial].status = RunStatus::not_written;
  out_.trials[trial].reason = moved.error();
  return false;
}

// --- Steps ------------------------------------------------------------------------------------------------

bool Search::mesh_reached() const {
  if (!choices_.steps_matter) return reached();
  // A mesh far better than its steps is paid for nothing.
  const double steps = no_shorter_.empty() ? 0 : 0.5 * of_steps_;
  const double wanted = std::max({options_.error - of_steps_, (1 - kOfSteps) * options_.error, steps});
  return out_.best && out_.trials[*out_.best].of_mesh.value_or(kNever) <= wanted;
}

Evidence Search::with_steps(const Evidence& mesh, int halved) const {
  if (steps_.runs() < 2 || mesh.how.empty()) return mesh;
  Evidence out = together(mesh, steps_.evidence(halved));
  out.how = mesh.how + "; the steps by those of half their length";
  return out;
}

// Cuts the steps on the mesh of the scene until their part of the error is small enough.
void Search::try_steps() {
  const std::size_t l = choices_.elements.size() > 1 ? 1 : 0;
  if (!try_next(l) || forecast_.ladders[l].levels() == 0) return;
  steps_.add(forecast_.ladders[l].answers[0]);
  const double wanted = kOfSteps * options_.error;
  double seconds = out_.trials.back().seconds;
  while (!steps_.within(wanted)) {
    const int halved = steps_.runs();
    const auto left = time_left();
    if (halved + (steps_.runs() > 2 ? steps_.missing(wanted) - 1 : 0) > kMostHalved)
      no_shorter_ = "they would have to be cut in more than " + std::to_string(1 << kMostHalved);
    else if (left && 2 * seconds > kTimeForSteps * *left)
      no_shorter_ = "half of them would take too much of the budget to look at";
    if (!no_shorter_.empty()) break;
    const RunResult result = run_trial({forecast_.ladders[l].element, 0, {}, halved}, false);
    Trial& trial = out_.trials.back();
    seconds = std::max(trial.seconds, seconds);
    if (result.status == RunStatus::converged) {
      steps_.add(answers_of(result));
      const Evidence evidence = steps_.evidence(halved);
      trial.of_steps = evidence.largest;
      trial.held_by = evidence.held_by;
    } else {
      no_shorter_ = std::string(to_string(result.status)) + ": " + result.reason;
    }
    if (options_.on_trial) options_.on_trial(trial);
    if (!no_shorter_.empty() || (options_.run.stop && options_.run.stop())) break;
  }
  if (steps_.runs() < 2) return;
  halved_ = steps_.within(wanted).value_or(steps_.runs() - 1);
  of_steps_ = steps_.evidence(halved_).largest;
}

// The best mesh with the steps that were found: what is left over is where mesh and steps do not add up.
void Search::try_both() {
  Setting setting = out_.trials[*out_.best].setting;
  setting.halved = halved_;
  const RunResult result = run_trial(setting, true);
  const std::size_t number = out_.trials.size() - 1;
  if (result.status == RunStatus::converged) {
    const auto answers = answers_of(result);
    const Evidence rest = from_interplay(answers_, steps_.run(0), steps_.run(halved_), answers);
    Evidence evidence = together(from_two_meshes(answers, answers), with_steps(evidence_, halved_));
    evidence = together(evidence, rest);
    evidence.how = with_steps(evidence_, halved_).how;
    for (AccuracyEntry& e : evidence.entries) {
      for (const AccuracyEntry& mesh : evidence_.entries) {
        if (mesh.name == e.name) e.other = mesh.other;
      }
    }
    Trial& trial = out_.trials[number];
    trial.indicator = evidence.largest;
    trial.held_by = evidence.held_by;
    trial.how = evidence.how;
    trial.of_mesh = evidence_.largest;
    trial.of_steps = of_steps_;
    if (*trial.indicator <= indicator(*out_.best)) adopt(number, result, evidence);
  } else {
    no_shorter_ = std::string(to_string(result.status)) + ": " + result.reason;
  }
  if (options_.on_trial) options_.on_trial(out_.trials[number]);
}

// --- How it ends ------------------------------------------------------------------------------------------

std::string Search::why_no_more() const {
  std::string text;
  for (std::size_t l = 0; l < closed_.size(); ++l) {
    if (!closed_[l].empty())
      text += (text.empty() ? "" : "; ") + element_text(forecast_.ladders[l].element) +
              (of_all(l) ? "" : " refined where it counts") + ": " + closed_[l];
  }
  if (no_shorter_.empty()) return text;
  text += (text.empty() ? "" : "; ") + ("shorter steps: " + no_shorter_);
  if (scene_.analysis.type == AnalysisType::dynamics && scene_.analysis.scheme == SchemeWord::implicit_euler)
    text +=
        " (implicit_euler is of first order; bdf2 as analysis.scheme needs fewer of them in smooth motion)";
  return text;
}

// What no comparison sees, where it may be as large as what was asked.
std::string Search::shape() const {
  const FlatFaces& faces = choices_.faces;
  // Of stiffness it is several times as much.
  if (!(faces.deficit > 0.1 * options_.error)) return {};
  return ". Not in this: the surface of \"" + choices_.faces_of +
         "\" looks round and its flat faces turn by up to " + two_digits(faces.turn * 57.29577951308232) +
         " degrees; if it is meant to be round, sizes are off by about " + percent(faces.deficit) +
         ", answers by several times that, and refinement keeps it: take a mesh that follows the shape, or "
         "curved Tet10";
}

void Search::conclude() {
  out_.seconds = elapsed();
  out_.accuracy.seconds = out_.seconds - out_.result.wall_s;
  const Trial& last = out_.trials.back();
  if (reached())
    out_.end = SearchEnd::reached;
  else if (last.status == RunStatus::interrupted || (options_.run.stop && options_.run.stop()))
    out_.end = SearchEnd::interrupted;
  else if (last.status == RunStatus::not_written)
    out_.end = SearchEnd::not_written;
  else if (last.status == RunStatus::budget || out_of_time_)
    out_.end = SearchEnd::budget;
  else if (out_.best)
    out_.end = SearchEnd::not_reached;
  else
    out_.end = last.status == RunStatus::bad_input ? SearchEnd::bad_input : SearchEnd::failed;
  if (!out_.best) {
    out_.sentence = out_.end == SearchEnd::bad_input ? last.reason : "no run converged: " + why_no_more();
    return;
  }
  const Trial& best = out_.trials[*out_.best];
  const std::string known = best.indicator ? "at most about " + percent(*best.indicator) + " by " + best.how +
                                                 ", held by \"" + best.held_by + "\""
                                           : "unknown, since nothing could be compared with it";
  if (out_.end == SearchEnd::reached) {
    out_.sentence =
        "within " + percent(options_.error) + " with " + describe(best.setting) + ": " + known + shape();
  } else {
    const std::string more = why_no_more();
    out_.sentence = percent(options_.error) + " not reached; the best is " + describe(best.setting) + ": " +
                    known + shape() + (more.empty() ? "" : ". No more: " + more);
  }
}

void Search::run() {
  if (choices_.steps_matter) try_steps();
  const auto may = [&] {
    if (options_.run.stop && options_.run.stop()) return false;
    if (out_.trials.empty()) return true;
    const RunStatus last = out_.trials.back().status;
    return last != RunStatus::interrupted && last != RunStatus::not_written && last != RunStatus::budget &&
           last != RunStatus::failed;
  };
  while (!mesh_reached() && may()) {
    if (const auto left = time_left(); left && *left <= 0) {
      out_of_time_ = true;
      break;
    }
    const auto next = choose();
    if (!next || (options_.run.stop && options_.run.stop())) break;
    if (!try_next(*next)) break;
  }
  if (halved_ > 0 && out_.best && !evidence_.how.empty() && may()) try_both();
  // Of a search that was stopped before any run had ended, what there is of the first.
  std::error_code code;
  const std::string left = trial_folder();
  if (!out_.best && fs::exists(fs::path(left) / "summary.json", code)) (void)publish(scene_);
  if (!left.empty()) fs::remove_all(left, code);
  if (!out_.trials.empty()) {
    conclude();
  } else if (out_of_time_) {
    out_.end = SearchEnd::budget;
    out_.sentence = "the budget of " + number(*options_.run.budget) + " s was used up before a run began";
  }
}

}  // namespace

ErrorSearch search_error(const SceneDef& scene, const ErrorSearchOptions& options) {
  ErrorSearch out;
  out.asked = options.error;
  Search search(scene, options, out);
  if (auto r = search.prepare(); !r) {
    out.sentence = r.error();
    return out;
  }
  search.run();
  if (out.best && !options.run.folder.empty() && out.end != SearchEnd::not_written) {
    const auto written =
        write_text((fs::path(options.run.folder) / "summary.json").string(), summary_json(out));
    if (!written) {
      out.end = SearchEnd::not_written;
      out.sentence = "outputs cannot be written: " + written.error();
    }
  }
  return out;
}

Result<double> parse_error_demand(const std::string& text) {
  std::string digits = text;
  while (!digits.empty() && digits.back() == ' ') digits.pop_back();
  const bool percentage = !digits.empty() && digits.back() == '%';
  if (percentage) digits.pop_back();
  while (!digits.empty() && digits.back() == ' ') digits.pop_back();
  double value = 0;
  const auto [stop, code] = isochor::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole = code == std::errc() && stop == digits.data() + digits.size();
  if (percentage) value *= 0.01;
  if (whole && value > 0 && value < 1) return value;
  return Error{"error = \"" + text +
               "\"; give a percentage above 0 % and below 100 %, as in 1%, or a fraction, as in 0.01"};
}

}  // namespace isochor
