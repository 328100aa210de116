/* Finds Young's modulus of a beam from how far its end droops, by Newton's method on derivatives of the
 * equilibrium, in C.   gradients_c */
#include <isochor/isochor.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void check(iso_world* world, iso_status status) {
  if (status == ISO_OK) return;
  fprintf(stderr, "%s\n", iso_last_error(world));
  exit(2);
}

static const char* keys_of(double young) {
  static char keys[100];
  snprintf(keys, sizeof keys, "{\"young\": %.17g, \"poisson\": 0.49}", young);
  return keys;
}

/* The equilibrium with this modulus: where the end is [m], and how that changes with the modulus [m/Pa]. */
static void droop(iso_world* world, iso_body beam, double young, double* end, double* by_young) {
  iso_output output = {0};
  iso_parameter parameter = {0};
  iso_gradient_query query = {0};
  iso_gradient_table told = {0};
  const double down[3] = {0, 0, -1};
  const int32_t corner = 13; /* of the free end */

  check(world, iso_set_material(world, beam, NULL, keys_of(young)));
  check(world, iso_advance(world, 1, NULL));

  output.size = sizeof output;
  output.kind = ISO_OUTPUT_POSITIONS; /* the sum of vector . x over nodes */
  output.body = beam;
  output.nodes = &corner;
  output.vectors = down;
  output.count = 1;
  parameter.size = sizeof parameter;
  parameter.kind = ISO_PARAMETER_MATERIAL;
  parameter.body = beam;
  parameter.keys = keys_of(young); /* as the scene has them */
  parameter.key = "young";         /* the number that is meant */
  query.size = sizeof query;
  query.outputs = &output;
  query.output_count = 1;
  query.parameters = &parameter;
  query.parameter_count = 1;
  told.size = sizeof told;
  check(world, iso_gradients(world, &query, &told));
  *end = told.values[0];
  *by_young = told.jacobian[0]; /* output_count rows of column_count numbers */
}

int main(void) {
  const double lower[3] = {0, 0, 0}, upper[3] = {0.12, 0.02, 0.02}, measured = -0.012;
  const int32_t divisions[3] = {6, 1, 1};
  const char* wall = "x0";
  char message[500];
  iso_mesh* mesh = NULL;
  iso_world* world = NULL;
  iso_options options = {0};
  iso_body beam;
  iso_effect rows, clamp;
  double young = 2e5;
  int step;

  options.size = sizeof options;
  options.scheme = ISO_STATICS;
  options.threads = 1;
  options.gravity[2] = -9.81;
  if (iso_mesh_box(lower, upper, divisions, ISO_TET4, &mesh, message, sizeof message) != ISO_OK ||
      iso_world_create(&options, &world, message, sizeof message) != ISO_OK) {
    fprintf(stderr, "%s\n", message);
    return 2;
  }
  check(world, iso_add_soft_body(world, "beam", mesh, young, 0.49, 1070, &beam));
  iso_mesh_free(mesh);
  check(world, iso_add_volume(world, beam, &rows));
  check(world, iso_add_support(world, "clamp", beam, &wall, 1, &clamp));

  for (step = 1; step <= 12; ++step) {
    double end, by_young, change;
    droop(world, beam, young, &end, &by_young);
    printf("%2d  Young's modulus %.2f kPa, the end at %.4f mm\n", step, 1e-3 * young, -1e3 * end);
    if (fabs(end + measured) < 1e-9) break;
    /* In the logarithm of the modulus, which keeps it positive. */
    change = (-measured - end) / (by_young * young);
    young *= exp(change > 1 ? 1 : change < -1 ? -1 : change);
  }
  if (iso_world_free(world) != ISO_OK || step > 12) return 1;
  return 0;
}
