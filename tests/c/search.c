/* iso_scene_solve_to(): an error that is delivered, one that is not, searches that are stopped, and what is
 * refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "isochor/isochor.h"

static void must(int holds, const char* what) {
  if (holds) return;
  fprintf(stderr, "%s\n", what);
  exit(1);
}

static char message[2000];

static iso_scene* opened(const char* const* overrides, size_t count) {
  iso_scene* scene = NULL;
  must(iso_scene_open("cook_plane", overrides, count, &scene, message, sizeof message) == ISO_OK, message);
  return scene;
}

static int seen = 0;
static int watch(void* user, const iso_trial* trial) {
  must(trial->size == sizeof *trial && strcmp(trial->status, "converged") == 0 && trial->setting[0] != 0 &&
           trial->elements > 0 && trial->unknowns > 0,
       "a trial is told");
  ++seen;
  return user != NULL;
}

static void refused(const iso_scene* scene, const iso_search_options* options, iso_search_result* result,
                    const char* words) {
  if (iso_scene_solve_to(scene, options, result, message, sizeof message) != ISO_REFUSED ||
      strstr(message, words) == NULL) {
    fprintf(stderr, "\"%s\" does not say \"%s\"\n", message, words);
    exit(1);
  }
}

int main(void) {
  static const char* no_answers[] = {"probes=[]", "metrics=[]"};
  iso_scene *scene = opened(NULL, 0), *empty = NULL;
  iso_search_options options;
  iso_search_result result;
  iso_world* world = NULL;
  int stop = 1;
  memset(&options, 0, sizeof options);
  memset(&result, 0, sizeof result);
  options.size = sizeof options;
  result.size = sizeof result;
  options.error = 0.03;
  options.threads = 1;
  options.on_trial = watch;
  must(iso_scene_solve_to(scene, &options, &result, message, sizeof message) == ISO_OK, message);
  must(result.end == ISO_SEARCH_REACHED && strstr(message, "within 3 %") != NULL, message);
  must(result.best != NULL && result.indicator >= 0 && result.indicator <= 0.03 && result.trials == seen,
       "the best run is known to be good enough");
  must(iso_scene_world(result.best, 1, &world, message, sizeof message) == ISO_OK, message);
  must(iso_world_free(world) == ISO_OK, "a world is freed");
  iso_scene_free(result.best);

  options.error = 1e-7;
  options.most_levels = 1;
  must(iso_scene_solve_to(scene, &options, &result, message, sizeof message) == ISO_OK, message);
  must(result.end == ISO_SEARCH_NOT_REACHED && strstr(message, "not reached") != NULL, message);
  must(result.best != NULL, "the best there is is kept");
  iso_scene_free(result.best);

  options.user = &stop;
  seen = 0;
  must(iso_scene_solve_to(scene, &options, &result, message, sizeof message) == ISO_OK, message);
  must(result.end == ISO_SEARCH_STOPPED && seen == 1 && result.trials == 1, "the first trial stops it");
  iso_scene_free(result.best);
  options.user = NULL;

  options.budget = 1e-9;
  must(iso_scene_solve_to(scene, &options, &result, message, sizeof message) == ISO_OK, message);
  must(result.end == ISO_SEARCH_BUDGET && result.best == NULL && result.indicator < 0, "no time, no run");
  options.budget = 0;

  options.error = 0;
  refused(scene, &options, &result, "error = 0; ask for a relative error above 0");
  options.error = NAN;
  refused(scene, &options, &result, "error = nan");
  options.error = 0.1;
  options.threads = -1;
  refused(scene, &options, &result, "options->threads = -1");
  options.threads = 1;
  options.budget = -2;
  refused(scene, &options, &result, "budget = -2");
  options.budget = 0;
  options.most_levels = -1;
  refused(scene, &options, &result, "options->most_levels = -1");
  options.most_levels = 0;
  refused(NULL, &options, &result, "the scene is none");
  refused(scene, NULL, &result, "options is a null pointer");
  refused(scene, &options, NULL, "out is a null pointer");
  empty = opened(no_answers, 2);
  refused(empty, &options, &result, "no probe and no metric");
  iso_scene_free(empty);
  iso_scene_free(scene);
  return 0;
}
