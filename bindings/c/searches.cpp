// Element and mesh for an error that is asked for.
#include "handles.h"
#include "scenes/run/error_search.h"
#include "scenes/scene_file.h"

using namespace isochor;
using namespace isochor::c;

namespace {

int32_t end_of(SearchEnd end) {
  switch (end) {
    case SearchEnd::reached:
      return ISO_SEARCH_REACHED;
    case SearchEnd::not_reached:
      return ISO_SEARCH_NOT_REACHED;
    case SearchEnd::budget:
      return ISO_SEARCH_BUDGET;
    case SearchEnd::interrupted:
      return ISO_SEARCH_STOPPED;
    case SearchEnd::not_written:
      return ISO_SEARCH_NOT_WRITTEN;
    case SearchEnd::bad_input:
    case SearchEnd::failed:
      break;
  }
  return ISO_SEARCH_FAILED;
}

ErrorSearchOptions options_from(const iso_search_options& given) {
  if (given.threads < 0)
    refuse("options->threads = " + std::to_string(given.threads) + "; it must be positive, or 0 for all");
  if (given.most_levels < 0)
    refuse("options->most_levels = " + std::to_string(given.most_levels) +
           "; it must be positive, or 0 for 4");
  ErrorSearchOptions out;
  out.error = given.error;
  if (given.most_levels > 0) out.most_levels = given.most_levels;
  out.run.folder = text_or_none(given.folder);
  out.run.threads = given.threads;
  if (given.budget != 0) out.run.budget = given.budget;
  return out;
}

iso_trial shown(const Trial& t, const std::string& setting) {
  iso_trial out{};
  out.size = sizeof out;
  out.setting = setting.c_str();
  out.status = to_string(t.status);
  out.elements = t.elements;
  out.unknowns = t.unknowns;
  out.seconds = t.seconds;
  out.indicator = t.indicator.value_or(-1);
  return out;
}

}  // namespace

extern "C" iso_status iso_scene_solve_to(const iso_scene* scene, const iso_search_options* options,
                                         iso_search_result* out, char* message, size_t message_size) {
  Buffer said(message, message_size);
  return caught("iso_scene_solve_to", said, [&] {
    Filled<iso_search_result> told(out, "out");
    const iso_search_options given = taken(options, "options");
    if (!good(scene)) refuse("the scene is none that iso_scene_open() made");
    ErrorSearchOptions asked = options_from(given);
    bool stopped = false;
    asked.run.stop = [&] { return stopped; };
    asked.on_trial = [&](const Trial& t) {
      if (given.on_trial == nullptr) return;
      const std::string setting = describe(t.setting);
      const iso_trial trial = shown(t, setting);
      stopped = given.on_trial(given.user, &trial) != 0 || stopped;
    };
    ErrorSearch search = search_error(scene->scene, asked);
    if (search.end == SearchEnd::bad_input && !search.best) refuse(search.sentence);
    told->end = end_of(search.end);
    told->indicator = -1;
    told->trials = static_cast<int32_t>(search.trials.size());
    if (search.best) {
      auto best = std::make_unique<iso_scene>();
      best->scene = std::move(search.scene);
      best->json = to_json(best->scene);
      told->indicator = search.trials[*search.best].indicator.value_or(-1);
      told->state_hash = search.result.state_hash;
      told->best = best.release();
    }
    told.give();
    said.say(search.sentence);
  });
}
