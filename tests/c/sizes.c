/* Structs of a program that was compiled with a later header, whose structs have grown at their ends. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "isochor/isochor.h"

typedef struct later_options {
  iso_options now;
  double more;
} later_options;
typedef struct later_report {
  iso_report now;
  double more[3];
} later_report;
typedef struct later_energies {
  iso_energies now;
  double more;
} later_energies;
typedef struct later_input {
  iso_input now;
  double more;
} later_input;

static void must(int holds, const char* what) {
  if (holds) return;
  fprintf(stderr, "%s\n", what);
  exit(1);
}
static void says(const char* message, const char* part) {
  if (strstr(message, part) != NULL) return;
  fprintf(stderr, "\"%s\" does not say \"%s\"\n", message, part);
  exit(1);
}

static iso_world* make(void) {
  later_options options;
  iso_world* world = NULL;
  char message[300];
  memset(&options, 0, sizeof options);
  options.now.size = sizeof options;
  options.now.gravity[2] = -9.81;
  options.more = 1;
  must(iso_world_create(&options.now, &world, message, sizeof message) == ISO_REFUSED && world == NULL,
       "a member that nobody knows is refused");
  says(message, "does not know");
  options.more = 0;
  must(iso_world_create(&options.now, &world, message, sizeof message) == ISO_OK, message);
  return world;
}

int main(void) {
  const double lower[3] = {0, 0, 0}, upper[3] = {1, 1, 1};
  const int32_t divisions[3] = {1, 1, 1};
  const char* side = "z0";
  char message[300];
  iso_world* world = make();
  iso_mesh* mesh = NULL;
  iso_body body;
  iso_effect clamp, rows;
  later_report report, reports[2];
  later_energies energies;
  later_input inputs[2];
  const iso_response* responses = NULL;
  iso_batch* batch = NULL;
  iso_energies one;

  must(iso_mesh_box(lower, upper, divisions, ISO_TET4, &mesh, message, sizeof message) == ISO_OK, message);
  must(iso_add_soft_body(world, "block", mesh, 1e5, 0.3, 1000, &body) == ISO_OK, iso_last_error(world));
  must(iso_add_support(world, "clamp", body, &side, 1, &clamp) == ISO_OK, iso_last_error(world));
  must(iso_add_volume(world, body, &rows) == ISO_OK, iso_last_error(world));

  memset(&report, 1, sizeof report);
  report.now.size = sizeof report;
  must(iso_advance(world, 0.01, &report.now) == ISO_OK, iso_last_error(world));
  must(report.now.size == sizeof report && report.now.time == 0.01 && report.now.iterations > 0,
       "the report is filled");
  must(report.more[0] == 0 && report.more[2] == 0, "what this version does not know is zero");
  report.now.size = 8;
  must(iso_advance(world, 0.01, &report.now) == ISO_REFUSED, "a size that is too small is refused");
  says(iso_last_error(world), "report->size = 8");
  report.now.size = (size_t)-1;
  must(iso_advance(world, 0.01, &report.now) == ISO_REFUSED, "a size that cannot be is refused");

  memset(&energies, 1, sizeof energies);
  energies.now.size = sizeof energies;
  one.size = sizeof one;
  must(iso_energy(world, &energies.now) == ISO_OK && iso_energy(world, &one) == ISO_OK,
       iso_last_error(world));
  must(energies.now.size == sizeof energies && energies.more == 0, "the tail is zero and the size stays");
  must(energies.now.elastic == one.elastic && one.elastic > 0 && one.size == sizeof one,
       "the numbers are the same");

  /* Arrays go by the size that is said. */
  memset(inputs, 0, sizeof inputs);
  inputs[0].now.size = inputs[1].now.size = sizeof inputs[0];
  inputs[0].now.body = inputs[1].now.body = body;
  inputs[0].now.point[2] = inputs[1].now.point[2] = 1;
  inputs[0].now.force[0] = 1;
  inputs[1].now.force[0] = 2;
  must(iso_derivatives(world, &inputs[0].now, 2, &responses) == ISO_OK, iso_last_error(world));
  {
    const iso_vectors first = responses[0].positions[0], second = responses[1].positions[0];
    const double a = first.data[3 * (first.count - 1)], b = second.data[3 * (second.count - 1)];
    must(a > 0 && b > 1.999999 * a && b < 2.000001 * a, "the second input is twice the first");
  }

  must(iso_batch_create(world, 2, 1, &batch) == ISO_OK, iso_last_error(world));
  memset(reports, 1, sizeof reports);
  reports[0].now.size = reports[1].now.size = sizeof reports[0];
  must(iso_batch_advance(batch, 0.01, &reports[0].now, 2) == ISO_OK, iso_batch_last_error(batch));
  must(reports[1].now.time == 0.02 && reports[1].more[2] == 0 && reports[0].more[0] == 0,
       "both reports are filled");
  reports[1].now.size = sizeof(iso_report);
  must(iso_batch_advance(batch, 0.01, &reports[0].now, 2) == ISO_REFUSED, "sizes that differ are refused");
  says(iso_batch_last_error(batch), "reports[1].size");

  iso_batch_free(batch);
  iso_mesh_free(mesh);
  iso_world_free(world);
  return 0;
}
