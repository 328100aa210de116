/* Memory that runs out: a limit of the process on its own address space, drawn in step by step. Calls end
   with ISO_NO_MEMORY and change nothing; once there is memory again they do what they were asked. */
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "isochor/isochor.h"

static void must(int holds, const char* what) {
  if (holds) return;
  fprintf(stderr, "%s\n", what);
  exit(1);
}

/* Bytes of address space that the process has now. */
static unsigned long in_use(void) {
  unsigned long pages = 0;
  FILE* f = fopen("/proc/self/statm", "r");
  must(f != NULL && fscanf(f, "%lu", &pages) == 1, "the size of the process is known");
  fclose(f);
  return pages * 4096;
}
static void allow(unsigned long more) {
  struct rlimit limit;
  malloc_trim(0); /* what was freed before would serve in place of new memory */
  must(getrlimit(RLIMIT_AS, &limit) == 0, "getrlimit");
  limit.rlim_cur = more > 0 ? in_use() + more : limit.rlim_max;
  must(setrlimit(RLIMIT_AS, &limit) == 0, "setrlimit");
}

static iso_world* world = NULL;
static iso_mesh* mesh = NULL;

/* A change that memory does not let compile is taken back. */
static iso_status add_body(void) {
  iso_body body;
  const iso_status status = iso_add_soft_body(world, "second", mesh, 1e5, 0.4, 1000, &body);
  return status == ISO_OK ? iso_compile(world, NULL) : status;
}
static iso_status save(void) {
  const void* bytes = NULL;
  size_t count = 0;
  return iso_save(world, &bytes, &count);
}
static iso_status clone(void) {
  iso_world* other = NULL;
  const iso_status status = iso_world_clone(world, 1, &other);
  if (status == ISO_OK) must(iso_world_free(other) == ISO_OK, "a clone is freed");
  return status;
}

/* `call` under limits that grow from nothing until it does not fail any more. */
static void starve(const char* name, iso_status (*call)(void)) {
  unsigned long more = 4096;
  int failed = 0;
  uint64_t before = 0, after = 0;
  must(iso_state_hash(world, &before) == ISO_OK, "the state has a hash");
  for (;; more += more / 2) {
    iso_status status;
    allow(more);
    status = call();
    allow(0);
    if (status == ISO_OK) break;
    if (status != ISO_NO_MEMORY || strstr(iso_last_error(world), "memory") == NULL) {
      fprintf(stderr, "%s under %lu more bytes: status %d, \"%s\"\n", name, more, (int)status,
              iso_last_error(world));
      exit(1);
    }
    ++failed;
    must(iso_state_hash(world, &after) == ISO_OK && before == after, "a failed call changes nothing");
  }
  printf("%s: failed %d times, done with %lu more bytes\n", name, failed, more);
  must(failed > 0, "a limit that small is felt");
}

int main(void) {
  const double lower[3] = {0, 0, 0}, upper[3] = {1, 1, 1};
  const int32_t divisions[3] = {20, 20, 20};
  const char* side = "z0";
  char message[300];
  iso_options options;
  iso_body body;
  iso_effect clamp, rows;
  memset(&options, 0, sizeof options);
  options.size = sizeof options;
  options.threads = 1;
  must(iso_world_create(&options, &world, message, sizeof message) == ISO_OK, message);
  must(iso_mesh_box(lower, upper, divisions, ISO_TET4, &mesh, message, sizeof message) == ISO_OK, message);
  must(iso_add_soft_body(world, "block", mesh, 1e5, 0.5, 1000, &body) == ISO_OK, "a body");
  must(iso_add_volume(world, body, &rows) == ISO_OK, "its volume");
  must(iso_add_support(world, "held", body, &side, 1, &clamp) == ISO_OK, "a support");
  must(iso_compile(world, NULL) == ISO_OK, "the scene is compiled");

  starve("iso_save", save);
  starve("iso_world_clone", clone);
  starve("iso_add_soft_body and iso_compile", add_body);
  iso_mesh_free(mesh);
  must(iso_world_free(world) == ISO_OK, "the world is freed");
  return 0;
}
