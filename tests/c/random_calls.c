/* Calls of the C interface in random order with good and bad arguments: whatever comes, each call returns a
 * status, every refusal has a sentence, and a good step still works in the end.   random_calls FIRST COUNT */
#include <isochor/isochor.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t state;
static uint32_t dice(uint32_t sides) {
  state = state * 1664525u + 1013904223u;
  return (state >> 8) % sides;
}

static void fail(const char* what, uint32_t seed) {
  fprintf(stderr, "seed %u: %s\n", (unsigned)seed, what);
  exit(1);
}

/* Numbers that nobody should pass, and some that one may. */
static double number(void) {
  static const double all[] = {0, 1, -1, 0.01, 1e300, -1e300, 1e-300, 100, NAN, INFINITY};
  return all[dice(10)];
}

/* Outputs and parameters of all kinds and of none, by what may be there. */
static iso_status gradients(iso_world* world, iso_body body, iso_effect effect, const double* v) {
  static const char* texts[] = {"young", "{\"young\": 1e4, \"poisson\": 0.4}", "volume", "", "nowhere", NULL};
  static const char* measures[] = {"von_mises", "pressure", "gravity", "kinetic"};
  const int32_t nodes[] = {0, (int32_t)dice(40) - 5};
  iso_output output;
  iso_parameter parameter;
  iso_gradient_query query;
  iso_gradient_table told;
  memset(&output, 0, sizeof output);
  memset(&parameter, 0, sizeof parameter);
  memset(&query, 0, sizeof query);
  memset(&told, 0, sizeof told);
  told.size = dice(6) == 0 ? dice(64) : sizeof told;
  query.size = sizeof query;
  output.size = dice(6) == 0 ? dice(64) : sizeof output;
  parameter.size = dice(6) == 0 ? dice(64) : sizeof parameter;
  output.kind = (int32_t)dice(13) - 1;
  output.cell = (int32_t)dice(40) - 5;
  output.target = number();
  output.body = parameter.body = body;
  output.effect = parameter.effect = effect;
  output.nodes = dice(4) == 0 ? NULL : nodes;
  output.vectors = v;
  output.count = dice(2);
  output.quantity = dice(3) == 0 ? measures[dice(4)] : texts[dice(6)];
  memcpy(output.direction, v, sizeof output.direction);
  memcpy(output.force, v, sizeof output.force);
  parameter.kind = (int32_t)dice(13) - 1;
  parameter.curve = dice(4) == 0 ? NULL : v;
  parameter.curve_count = dice(2);
  parameter.number = (int32_t)dice(3) - 1;
  memcpy(parameter.vector, v, sizeof parameter.vector);
  parameter.motion = v;
  parameter.count = dice(2);
  parameter.keys = texts[dice(6)];
  parameter.key = texts[dice(6)];
  parameter.effect_kind = texts[dice(6)];
  parameter.step = dice(4) == 0 ? number() : 0;
  query.outputs = dice(6) == 0 ? NULL : &output;
  query.output_count = dice(2);
  query.parameters = dice(6) == 0 ? NULL : &parameter;
  query.parameter_count = dice(2);
  query.mode = (int32_t)dice(5) - 1;
  query.unstable = (int32_t)dice(2);
  if (dice(3) == 0) {
    const double steps[2] = {dice(4) == 0 ? number() : 0.01, 0.01};
    const int32_t at = (int32_t)dice(4) - 1, to = (int32_t)dice(3) - 1;
    iso_trajectory_query way;
    memset(&way, 0, sizeof way);
    way.size = dice(6) == 0 ? dice(64) : sizeof way;
    way.steps = dice(6) == 0 ? NULL : steps;
    way.step_count = dice(3);
    way.terms = query.outputs;
    way.term_steps = dice(6) == 0 ? NULL : &at;
    way.term_output = dice(2) == 0 ? NULL : &to;
    way.term_count = query.output_count;
    way.output_count = dice(3);
    way.parameters = query.parameters;
    way.parameter_count = query.parameter_count;
    way.mode = query.mode;
    way.kept_states = (int32_t)dice(4) - 1;
    return iso_trajectory_gradients(world, &way, &told);
  }
  return iso_gradients(world, &query, &told);
}

static iso_status one_call(iso_world* world, iso_world* other, iso_body* bodies, iso_effect* effects) {
  static const char* kinds[] = {"volume", "cavity", "dirichlet", "nonsense", "damping", "", NULL};
  static const char* keys[] = {
      "{}",    "{\"surfaces\": \"x1\"}", "{\"name\": \"d\", \"where\": {\"surfaces\": \"x1\"}}",
      "[1, 2", "{\"amount\": 1e999}",    "",
      NULL};
  double v[3], three[3] = {0, 0, 0};
  const double* view = NULL;
  const void* bytes = NULL;
  const iso_gauge* gauges = NULL;
  const iso_contact* contacts = NULL;
  size_t count = 0;
  int64_t hash = 0;
  iso_report report;
  iso_measures measures;
  iso_body body = bodies[dice(4)];
  iso_effect effect = effects[dice(4)];
  int k;
  (void)other;
  for (k = 0; k < 3; ++k) v[k] = number();
  memset(&report, 0, sizeof report);
  memset(&measures, 0, sizeof measures);
  report.size = dice(4) == 0 ? dice(64) : sizeof report;
  measures.size = dice(4) == 0 ? dice(16) : sizeof measures;
  switch (dice(25)) {
    case 0:
      return iso_add(world, kinds[dice(7)], keys[dice(7)], dice(5) == 0 ? NULL : &effects[dice(3)]);
    case 1:
      return iso_step(world, number(), &report);
    case 2:
      return iso_advance(world, dice(2) == 0 ? 0.01 : number(), &report);
    case 3:
      return iso_step_within(world, 0.01, (int32_t)dice(4) - 1, number(), &report);
    case 4:
      return iso_set_amount(world, effect, number());
    case 5:
      return iso_set_gravity(world, dice(4) == 0 ? NULL : v);
    case 6:
      return iso_add_force(world, body, (int32_t)dice(40) - 5, v);
    case 7:
      return iso_add_force_at(world, body, three, v);
    case 8:
      return iso_set_forces(world, body, v, dice(3), dice(3) * 8);
    case 9:
      return iso_remove_effect(world, effect);
    case 10:
      return iso_remove_body(world, body);
    case 11:
      return iso_set_density(world, body, dice(2) == 0 ? NULL : "nowhere", number());
    case 12:
      return iso_set_material(world, body, NULL,
                              dice(2) == 0 ? "{\"young\": 2e4, \"poisson\": 0.4}" : keys[dice(7)]);
    case 13:
      return iso_positions(world, body, dice(6) == 0 ? NULL : &view, &count);
    case 14:
      return iso_gauges(world, &gauges, dice(6) == 0 ? NULL : &count);
    case 15:
      return iso_contacts(world, &contacts, &count);
    case 16:
      return iso_measure(world, body, dice(3) == 0 ? "x" : NULL, &measures);
    case 17:
      return iso_save(world, &bytes, &count);
    case 18:
      return iso_load(world, v, sizeof v);
    case 19:
      return iso_reset(world);
    case 20:
      return iso_clear_forces(world);
    case 21:
      return iso_compile(world, NULL);
    case 22:
      return iso_follow(world, number(), NULL);
    case 23:
      return gradients(world, body, effect, v);
    default:
      return iso_state_hash(world, dice(6) == 0 ? NULL : (uint64_t*)&hash);
  }
}

static void sequence(uint32_t seed) {
  const double lower[3] = {0, 0, 0}, upper[3] = {1, 1, 1};
  const int32_t divisions[3] = {1, 1, 1};
  const char* held[] = {"x0"};
  iso_mesh* mesh = NULL;
  iso_world *world = NULL, *other = NULL;
  iso_options options;
  iso_report report;
  iso_body bodies[4];
  iso_effect effects[4];
  iso_body fresh;
  iso_effect hold;
  char message[400];
  int k;
  state = seed * 2654435761u + 12345u;
  memset(&options, 0, sizeof options);
  memset(&report, 0, sizeof report);
  memset(bodies, 0, sizeof bodies);
  memset(effects, 0, sizeof effects);
  options.size = sizeof options;
  options.threads = 1;
  if (seed % 3 == 0) options.scheme = ISO_STATICS; /* which gradients ask for */
  report.size = sizeof report;
  if (iso_mesh_box(lower, upper, divisions, ISO_TET4, &mesh, message, sizeof message) != ISO_OK)
    fail(message, seed);
  if (iso_world_create(&options, &world, message, sizeof message) != ISO_OK) fail(message, seed);
  if (iso_world_create(&options, &other, message, sizeof message) != ISO_OK) fail(message, seed);
  if (iso_add_soft_body(other, "a", mesh, 1e4, 0.4, 1000, &bodies[3]) != ISO_OK)
    fail(iso_last_error(other), seed);
  if (iso_add_soft_body(world, "a", mesh, 1e4, 0.4, 1000, &bodies[0]) != ISO_OK)
    fail(iso_last_error(world), seed);
  if (iso_add_support(world, "hold", bodies[0], held, 1, &effects[0]) != ISO_OK)
    fail(iso_last_error(world), seed);
  bodies[1] = bodies[0];
  bodies[1].generation += 7; /* one that was never given */
  effects[3].number = 99;
  for (k = 0; k < 30; ++k) {
    const iso_status status = one_call(world, other, bodies, effects);
    if (status != ISO_OK && iso_last_error(world)[0] == 0) fail("a refusal without a sentence", seed);
    if (status < ISO_OK || status > ISO_FAILED) fail("no status", seed);
    if (status == ISO_FAILED) fail(iso_last_error(world), seed);
  }
  /* Whatever there was, a new world works, and this one ends. */
  if (iso_world_free(other) != ISO_OK || iso_world_free(world) != ISO_OK) fail("not freed", seed);
  if (iso_world_create(&options, &world, message, sizeof message) != ISO_OK) fail(message, seed);
  if (iso_add_soft_body(world, "a", mesh, 1e4, 0.4, 1000, &fresh) != ISO_OK)
    fail(iso_last_error(world), seed);
  if (iso_add_support(world, "hold", fresh, held, 1, &hold) != ISO_OK) fail(iso_last_error(world), seed);
  if (iso_advance(world, 0.01, &report) != ISO_OK) fail(report.reason, seed);
  if (iso_world_free(world) != ISO_OK) fail("not freed", seed);
  iso_mesh_free(mesh);
}

int main(int argc, char** argv) {
  const uint32_t first = argc > 1 ? (uint32_t)atoi(argv[1]) : 1,
                 count = argc > 2 ? (uint32_t)atoi(argv[2]) : 300;
  uint32_t k;
  if (iso_world_create(NULL, NULL, NULL, 0) == ISO_OK) fail("a world without a place for it", 0);
  if (iso_last_error(NULL) == NULL) fail("no sentence for no world", 0);
  for (k = first; k < first + count; ++k) sequence(k);
  printf("%u sequences\n", (unsigned)count);
  return 0;
}
