/* iso_gradients(): every kind of output by every kind of parameter against differences of worlds that are
 * made anew, the adjoint against tangents, what is refused, and structs of later versions. */
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

enum { YOUNG, DENSITY, GRAVITY, TRACTION, SPRING, PUSH, STRETCH, RATIO, KNOBS };
/* Of an equilibrium; a way through time has a parameter more. */
enum { OUTPUTS = 11, PARAMETERS = 10, ALL_PARAMETERS = 11, NODES = 36, CURVE = 9, VELOCITY = 10 };

typedef struct scene {
  iso_world* world;
  iso_body body;
  iso_effect clamp, rows, pull, spring;
  double knob[KNOBS], curve[2];
  double motion[3 * NODES], vectors[3 * NODES];
  char material[100], spring_keys[200];
} scene;

static void ok(const scene* s, iso_status status) {
  must(status == ISO_OK, iso_last_error(s->world));
}

/* What the shape parameter moves: x by y, different everywhere. */
static void moved(const double* x, double* by) {
  by[0] = 0.2 * x[0] + 0.1 * x[1] * x[2];
  by[1] = 0.1 * x[0] * x[0];
  by[2] = -0.1 * x[0] * x[1];
}

static const double tip[3] = {2, 1, 1}, push[3] = {1, 4, 2};

/* Where the corner is at rest. */
static void corner(const double* knob, double* x) {
  double by[3];
  size_t c;
  moved(tip, by);
  for (c = 0; c < 3; ++c) x[c] = tip[c] + knob[STRETCH] * by[c];
}

/* A bar that is held, heavy, pulled at its end, pushed at a corner, and held by a spring. */
static void make_in(scene* s, const double* knob, int32_t scheme) {
  const double lower[3] = {0, 0, 0}, upper[3] = {2, 1, 1};
  const int32_t divisions[3] = {3, 2, 2};
  const char* wall = "x0";
  char message[500];
  double* points;
  size_t n, c;
  iso_options options;
  iso_mesh* mesh = NULL;
  double force[3], pushed[3];
  memset(s, 0, sizeof *s);
  memcpy(s->knob, knob, sizeof s->knob);
  memset(&options, 0, sizeof options);
  options.size = sizeof options;
  options.scheme = scheme;
  options.threads = 1;
  options.gravity[2] = knob[GRAVITY];
  options.keys = "{\"force_tolerance\": 1e-13, \"row_tolerance\": 1e-13}";
  must(iso_world_create(&options, &s->world, message, sizeof message) == ISO_OK, message);
  must(iso_mesh_box(lower, upper, divisions, ISO_TET4, &mesh, message, sizeof message) == ISO_OK, message);
  must(mesh->point_count == NODES, "the bar has as many nodes as are said");
  points = (double*)mesh->points;
  for (n = 0; n < NODES; ++n) {
    double* by = s->motion + 3 * n;
    moved(points + 3 * n, by);
    for (c = 0; c < 3; ++c) points[3 * n + c] += knob[STRETCH] * by[c];
  }
  snprintf(s->material, sizeof s->material, "{\"young\": %.17g, \"poisson\": 0.45}", knob[YOUNG]);
  snprintf(s->spring_keys, sizeof s->spring_keys,
           "{\"name\": \"spring\", \"from\": [2, 0, 2], \"points\": [[1.5, 0.4, 0.6]], \"control\": "
           "\"length_ratio\", \"amount\": %.17g, \"stiffness\": %.17g}",
           knob[RATIO], knob[SPRING]);
  ok(s, iso_add_soft_body(s->world, "bar", mesh, knob[YOUNG], 0.45, knob[DENSITY], &s->body));
  iso_mesh_free(mesh);
  ok(s, iso_add_volume(s->world, s->body, &s->rows));
  ok(s, iso_add_support(s->world, "clamp", s->body, &wall, 1, &s->clamp));
  ok(s, iso_add(s->world, "traction",
                "{\"name\": \"pull\", \"surface\": \"x1\", \"traction\": [1, 0.3, 0.2], \"amount\": 1}",
                &s->pull));
  ok(s, iso_add(s->world, "cable", s->spring_keys, &s->spring));
  ok(s, iso_set_amount(s->world, s->pull, knob[TRACTION]));
  for (c = 0; c < 3; ++c) force[c] = knob[PUSH] * push[c];
  corner(knob, pushed);
  ok(s, iso_add_force_at(s->world, s->body, pushed, force));
}

/* In balance. */
static void make(scene* s, const double* knob) {
  make_in(s, knob, ISO_STATICS);
  ok(s, iso_advance(s->world, 1, NULL));
}

/* Half the square of all distances from the origin. */
static double spread(void* user, const double* x, double* gradient, size_t count) {
  double sum = 0;
  size_t k;
  ++*(int*)user;
  for (k = 0; k < 3 * count; ++k) {
    sum += 0.5 * x[k] * x[k];
    gradient[k] = x[k];
  }
  return sum;
}
static int spreads = 0;

static double no_number(void* user, const double* x, double* gradient, size_t count) {
  (void)user;
  (void)x;
  (void)count;
  gradient[0] = NAN;
  return 1;
}

static void make_outputs(scene* s, iso_output* o) {
  static const int32_t nodes[2] = {NODES - 1, 30};
  size_t k;
  memset(o, 0, OUTPUTS * sizeof *o);
  for (k = 0; k < 3 * NODES; ++k) s->vectors[k] = 0.01 * (double)(k % 7);
  for (k = 0; k < OUTPUTS; ++k) {
    o[k].size = sizeof *o;
    o[k].kind = (int32_t)k;
    o[k].body = s->body;
    o[k].vectors = s->vectors;
  }
  o[ISO_OUTPUT_POSITIONS].count = NODES; /* of all nodes */
  o[ISO_OUTPUT_DISTANCE].nodes = nodes;
  o[ISO_OUTPUT_DISTANCE].count = 2;
  o[ISO_OUTPUT_DISTANCE].stride = 6 * sizeof(double);
  corner(s->knob, o[ISO_OUTPUT_MATERIAL_POINT].point);
  o[ISO_OUTPUT_MATERIAL_POINT].direction[2] = 1;
  o[ISO_OUTPUT_GAUGE].effect = s->spring;
  o[ISO_OUTPUT_GAUGE].quantity = "length";
  o[ISO_OUTPUT_REACTION].effect = s->clamp;
  o[ISO_OUTPUT_REACTION].force[0] = 1;
  o[ISO_OUTPUT_REACTION].moment[1] = 0.5;
  o[ISO_OUTPUT_ENERGY].quantity = "gravity";
  o[ISO_OUTPUT_SQUARE].nodes = nodes;
  o[ISO_OUTPUT_SQUARE].count = 2;
  o[ISO_OUTPUT_SQUARE].target = 0.3;
  o[ISO_OUTPUT_STRESS].cell = 17;
  o[ISO_OUTPUT_STRESS].quantity = "von_mises";
  o[ISO_OUTPUT_EFFECT_FORCE].effect = s->spring;
  o[ISO_OUTPUT_EFFECT_FORCE].direction[0] = 0.4;
  o[ISO_OUTPUT_EFFECT_FORCE].direction[2] = 1;
  o[ISO_OUTPUT_OF_POSITIONS].function = spread;
  o[ISO_OUTPUT_OF_POSITIONS].user = &spreads;
}

static const char* spring_of(void* user, double value) {
  static char keys[200];
  int* calls = (int*)user;
  ++*calls;
  snprintf(
      keys, sizeof keys,
      "{\"from\": [2, 0, 2], \"points\": [[1.5, 0.4, 0.6]], \"control\": \"length_ratio\", \"amount\": 0.9, "
      "\"stiffness\": %.17g}",
      value);
  return keys;
}
static int calls = 0;

static void make_parameters(scene* s, iso_parameter* p) {
  size_t k;
  memset(p, 0, ALL_PARAMETERS * sizeof *p);
  for (k = 0; k < ALL_PARAMETERS; ++k) {
    p[k].size = sizeof *p;
    p[k].kind = (int32_t)k;
    p[k].body = s->body;
  }
  p[ISO_PARAMETER_AMOUNT_OF].effect = s->pull;
  memcpy(p[ISO_PARAMETER_FORCE_AT].point, tip, sizeof tip);
  memcpy(p[ISO_PARAMETER_FORCE_AT].vector, push, sizeof push);
  p[ISO_PARAMETER_GRAVITY].vector[2] = 1;
  p[ISO_PARAMETER_MATERIAL].keys = s->material;
  p[ISO_PARAMETER_MATERIAL].key = "young";
  p[ISO_PARAMETER_CONSTANT_OF].effect = s->spring;
  p[ISO_PARAMETER_CONSTANT_OF].effect_kind = "cable";
  p[ISO_PARAMETER_CONSTANT_OF].make = spring_of;
  p[ISO_PARAMETER_CONSTANT_OF].user = &calls;
  p[ISO_PARAMETER_CONSTANT_OF].value = s->knob[SPRING];
  p[ISO_PARAMETER_SHAPE].motion = s->motion;
  p[ISO_PARAMETER_SHAPE].count = NODES;
  /* The one of ways through time comes last. */
  p[CURVE].kind = ISO_PARAMETER_CURVE_POINT;
  p[CURVE].effect = s->spring;
  s->curve[1] = s->knob[RATIO];
  p[CURVE].curve = s->curve;
  p[CURVE].curve_count = 1;
  p[VELOCITY].kind = ISO_PARAMETER_INITIAL_VELOCITY;
  p[VELOCITY].motion = s->motion;
  p[VELOCITY].count = NODES;
}

static iso_gradient_query query_of(const iso_output* o, size_t outputs, const iso_parameter* p,
                                   size_t parameters) {
  iso_gradient_query q;
  memset(&q, 0, sizeof q);
  q.size = sizeof q;
  q.outputs = o;
  q.output_count = outputs;
  q.parameters = p;
  q.parameter_count = parameters;
  return q;
}

static void values_at(const double* knob, double* out) {
  scene s;
  iso_output o[OUTPUTS];
  iso_gradient_query q;
  iso_gradient_table t = {0};
  make(&s, knob);
  make_outputs(&s, o);
  q = query_of(o, OUTPUTS, NULL, 0);
  t.size = sizeof t;
  ok(&s, iso_gradients(s.world, &q, &t));
  must(t.column_count == 0 && t.columns[0] == 0, "no parameters, no columns");
  memcpy(out, t.values, OUTPUTS * sizeof *out);
  must(iso_world_free(s.world) == ISO_OK, "a world is freed");
}

/* Of all outputs by a knob, to the fourth order. */
static void difference(const double* knob, int which, double* out) {
  static const double weight[4] = {1. / 12, -8. / 12, 8. / 12, -1. / 12};
  static const int at[4] = {-2, -1, 1, 2};
  const double h = 2e-3 * (knob[which] == 0 ? 0.1 : fabs(knob[which]));
  int i, j;
  memset(out, 0, OUTPUTS * sizeof *out);
  for (i = 0; i < 4; ++i) {
    double there[KNOBS], values[OUTPUTS];
    memcpy(there, knob, sizeof there);
    there[which] += at[i] * h;
    values_at(there, values);
    for (j = 0; j < OUTPUTS; ++j) out[j] += weight[i] / h * values[j];
  }
}

static const double knobs[KNOBS] = {1e4, 1000, -2, 200, 900, 1, 0, 0.9};

static void every_output_by_every_parameter(void) {
  static const int knob_of[PARAMETERS] = {TRACTION, PUSH, GRAVITY, DENSITY, YOUNG,
                                          YOUNG,    -1,   SPRING,  STRETCH, RATIO};
  scene s;
  iso_output o[OUTPUTS];
  iso_parameter p[ALL_PARAMETERS], numbers[PARAMETERS];
  iso_gradient_query q;
  iso_gradient_table t = {0};
  double found[OUTPUTS][PARAMETERS], wanted[KNOBS][OUTPUTS], values[OUTPUTS];
  uint64_t before = 0, after = 0;
  size_t j, k, n = 0;
  const size_t cells = 6 * 3 * 2 * 2;
  make(&s, knobs);
  make_outputs(&s, o);
  make_parameters(&s, p);
  q = query_of(o, OUTPUTS, p, PARAMETERS);
  t.size = sizeof t;
  ok(&s, iso_state_hash(s.world, &before));
  ok(&s, iso_gradients(s.world, &q, &t));
  ok(&s, iso_state_hash(s.world, &after));
  must(before == after, "the state stays as it is");
  must(calls > 4, "the function of the caller is asked");
  must(spreads > 0, "and that of positions");
  must(t.adjoint == 1 && t.regular == 1 && t.note[0] == 0 && t.undecided_count == 0,
       "an adjoint that is regular");
  must(t.output_count == OUTPUTS && t.column_count == PARAMETERS - 1 + cells &&
           t.columns[PARAMETERS] == t.column_count && t.columns[7] - t.columns[6] == cells,
       "one column a number, and one a cell");
  for (j = 0; j < OUTPUTS; ++j) {
    double sum = 0, size = 0;
    const double* row = t.jacobian + j * t.column_count;
    for (k = 0; k < PARAMETERS; ++k) found[j][k] = row[t.columns[k]];
    for (k = t.columns[6]; k < t.columns[7]; ++k) sum += row[k], size += fabs(row[k]);
    must(fabs(sum - found[j][ISO_PARAMETER_STIFFNESS]) <= 1e-11 * size, "cells add up to the body");
    values[j] = t.values[j];
  }
  for (k = 0; k < KNOBS; ++k) difference(knobs, (int)k, wanted[k]);
  /* Young's modulus and the factor on stiffness are one knob in other units. */
  for (k = 0; k < PARAMETERS; ++k) {
    if (k != ISO_PARAMETER_CELL_STIFFNESS) numbers[n++] = p[k];
  }
  q = query_of(o, OUTPUTS, numbers, n);
  q.mode = ISO_GRADIENTS_TANGENT;
  ok(&s, iso_gradients(s.world, &q, &t));
  must(t.adjoint == 0 && memcmp(values, t.values, sizeof values) == 0, "tangents of the same values");
  for (j = 0; j < OUTPUTS; ++j) {
    double scale = 0;
    for (k = 0; k < PARAMETERS; ++k) {
      const double size = k == ISO_PARAMETER_STIFFNESS ? 1 : knob_of[k] < 0 ? 0 : fabs(knobs[knob_of[k]]);
      scale = fmax(scale, fabs(found[j][k]) * size);
    }
    for (k = n = 0; k < PARAMETERS; ++k) {
      double unit, size;
      if (knob_of[k] < 0) continue;
      unit = k == ISO_PARAMETER_STIFFNESS ? knobs[YOUNG] : 1;
      size = knobs[knob_of[k]] == 0 ? 0.1 : fabs(knobs[knob_of[k]]) / unit;
      if (fabs(found[j][k] - unit * wanted[knob_of[k]][j]) > 1e-6 * scale / size) {
        fprintf(stderr, "output %d by parameter %d: %.12g, not %.12g\n", (int)j, (int)k, found[j][k],
                unit * wanted[knob_of[k]][j]);
        exit(1);
      }
      must(fabs(found[j][k] - t.jacobian[j * t.column_count + n++]) <= 1e-10 * scale / size,
           "tangents and adjoint agree");
    }
  }
  must(iso_world_free(s.world) == ISO_OK, "a world is freed");
}

static const char* no_keys(void* user, double value) {
  (void)user;
  return value > 0 ? NULL : "{}";
}
static const char* same_keys(void* user, double value) {
  (void)value;
  return (const char*)user;
}

typedef struct later_output {
  iso_output now;
  double more;
} later_output;

static void refused(const scene* s, const iso_gradient_query* q, const char* words) {
  iso_gradient_table t, before;
  uint64_t hash = 0, after = 0;
  ok(s, iso_state_hash(s->world, &hash));
  memset(&t, 0, sizeof t);
  t.size = sizeof t;
  before = t;
  if (iso_gradients(s->world, q, &t) != ISO_REFUSED || strstr(iso_last_error(s->world), words) == NULL) {
    fprintf(stderr, "\"%s\" does not say \"%s\"\n", iso_last_error(s->world), words);
    exit(1);
  }
  must(memcmp(&t, &before, sizeof t) == 0, "what is refused fills nothing");
  ok(s, iso_state_hash(s->world, &after));
  must(hash == after, "what is refused changes nothing");
}

#define ASK(change, words)                   \
  do {                                       \
    make_outputs(&s, o);                     \
    make_parameters(&s, p);                  \
    q = query_of(o, OUTPUTS, p, PARAMETERS); \
    change;                                  \
    refused(&s, &q, words);                  \
  } while (0)

static void outputs_that_are_refused(void) {
  scene s, other;
  iso_output o[OUTPUTS];
  iso_parameter p[ALL_PARAMETERS];
  iso_gradient_query q;
  make(&s, knobs);
  make(&other, knobs);
  ASK(o[1].kind = 11, "outputs[1]: kind = 11; give one of ISO_OUTPUT_...");
  ASK(p[2].kind = -1, "parameters[2]: kind = -1; give one of ISO_PARAMETER_...");
  ASK(q.mode = 3, "query->mode = 3");
  ASK(q.mode = ISO_GRADIENTS_TANGENT, "ask by the adjoint");
  ASK(q.outputs = NULL, "query->outputs is a null pointer");
  ASK(o[0].size = 8, "query->outputs->size = 8");
  ASK(o[0].body = other.body, "outputs[0]: ");
  ASK(o[0].body = other.body, "another world");
  ASK(o[4].effect = other.clamp, "outputs[4]: ");
  ASK(p[0].effect = other.pull, "parameters[0]: ");
  ASK(memset(&p[3].body, 0, sizeof p[3].body), "parameters[3]: the body is no id");
  ASK(o[0].count = 3, "outputs[0]: 3 vectors for the 36 nodes of body \"bar\"");
  ASK(o[0].vectors = NULL, "outputs[0]: vectors is a null pointer");
  ASK(o[1].stride = 8, "outputs[1]: vectors: a stride of 8 bytes");
  ASK(o[1].count = 0, "outputs[1]: an output names 0 nodes");
  ASK(s.vectors[1] = NAN, "outputs[0]: the vector 0 is (0, nan, 0.02)");
  ASK(o[4].force[0] = INFINITY, "outputs[4]: the force is (inf, 0, 0)");
  ASK(o[2].point[0] = 9, "outputs[2]: ");
  ASK(o[3].quantity = NULL, "outputs[3]: quantity is a null pointer");
  ASK(o[3].quantity = "color", "outputs[3]: gauge \"color\" of effect \"spring\": there is no such gauge");
  ASK(o[4].effect = s.pull, "outputs[4]: effect \"pull\" has no reaction");
  ASK(o[6].quantity = "heat", "outputs[6]: there is no energy \"heat\"");
  ASK(o[7].target = NAN, "outputs[7]: target = nan");
  ASK(o[8].cell = 999, "there is no cell 999");
  ASK(o[9].effect = s.clamp, "take the reaction of a support");
  ASK(o[9].direction[1] = INFINITY, "outputs[9]: the direction is (0.4, inf, 1)");
  ASK(o[10].function = NULL, "outputs[10]: function is a null pointer");
  ASK(o[10].function = no_number, "outputs[10]: the function of positions makes 1, or a gradient");
  must(iso_world_free(s.world) == ISO_OK && iso_world_free(other.world) == ISO_OK, "worlds are freed");
}

static void parameters_that_are_refused(void) {
  scene s;
  iso_output o[OUTPUTS];
  iso_parameter p[ALL_PARAMETERS];
  iso_gradient_query q;
  make(&s, knobs);
  ASK(p[0].effect = s.rows, "parameters[0]: effect \"volume\" has no amount");
  ASK(p[1].vector[2] = NAN, "parameters[1]: the vector is (1, 4, nan)");
  ASK(p[3].region = "steel", "parameters[3]: ");
  ASK(p[3].region = "steel", "steel");
  ASK(p[4].key = "yuong", "parameters[4]: key \"yuong\" is not among those that are given");
  ASK(p[4].keys = NULL, "parameters[4]: keys is a null pointer");
  ASK(p[4].keys = "{", "parameters[4]: ");
  ASK((p[4].keys = "{\"young\": 2e4, \"poisson\": 0.45}"),
      "parameters[4]: constant of a material: at value = 20000 it is not what the scene has");
  ASK((p[4].keys = "{\"young\": 1e4, \"poisson\": 0.45, \"density\": 1000}", p[4].key = "density"),
      "nothing depends on it");
  ASK((p[4].make = no_keys, p[4].value = 1), "keys and a function");
  ASK((p[4].make = no_keys, p[4].value = 1, p[4].keys = p[4].key = NULL),
      "parameters[4]: constant of a material: the function makes no keys");
  ASK((p[4].make = same_keys, p[4].user = s.material, p[4].value = 1, p[4].keys = p[4].key = NULL),
      "nothing depends on it");
  ASK(p[7].effect_kind = "cabel", "did you mean \"cable\"");
  ASK(p[8].count = 5, "parameters[8]: shape: motion has 5 vectors");
  ASK(p[5].step = -1, "parameters[5]: step = -1");
  ASK(p[CURVE].curve = NULL, "parameters[9]: curve is a null pointer");
  ASK(p[CURVE].number = 1, "parameters[9]: curve of effect \"spring\": there is no point 1");
  ASK(s.curve[1] = 0.8, "but the amount is 0.9");
  must(iso_gradients(s.world, &q, NULL) == ISO_REFUSED, "there must be a place for the answer");
  must(iso_world_free(s.world) == ISO_OK, "a world is freed");
}

static void queries_that_are_refused(void) {
  scene s;
  iso_output o[OUTPUTS];
  iso_gradient_query q;
  later_output later[2];
  iso_gradient_table t = {0};
  make(&s, knobs);
  t.size = sizeof t;
  must(iso_gradients(s.world, NULL, &t) == ISO_REFUSED, "there must be a query");
  /* Structs of a later version, of which this library knows the first members. */
  make_outputs(&s, o);
  memset(later, 0, sizeof later);
  later[0].now = o[2];
  later[1].now = o[ISO_OUTPUT_ELASTIC_ENERGY];
  later[0].now.size = later[1].now.size = sizeof later[0];
  q = query_of(&later[0].now, 2, NULL, 0);
  ok(&s, iso_gradients(s.world, &q, &t));
  must(t.values[1] > 0, "the second of them is the energy");
  later[1].more = 1;
  refused(&s, &q, "outputs[1] has members set that this version of the library does not know");

  /* No equilibrium. */
  ok(&s, iso_set_gravity(s.world, push));
  ok(&s, iso_set_positions(s.world, s.body, s.motion, NODES, 0));
  make_outputs(&s, o);
  q = query_of(o, 1, NULL, 0);
  refused(&s, &q, "the state is no equilibrium");
  must(iso_world_free(s.world) == ISO_OK, "a world is freed");
}

enum { TERMS = 3, SUMS = 2, STEPS = 3, SEEN = 3 };

/* The tip at the end, and the distances of all nodes from targets at two times; by Young's modulus, the
 * traction and the velocity at the start, which is `speed` times the motion. */
static void go_the_way(const double* knob, double speed, int32_t mode, int32_t kept, double* values,
                       double* jacobian) {
  static const double steps[STEPS] = {0.02, 0.03, 0.02};
  static const int32_t term_steps[TERMS] = {3, 1, 3}, term_output[TERMS] = {0, 1, 1};
  scene s;
  iso_output all[OUTPUTS], o[TERMS];
  iso_parameter p[ALL_PARAMETERS], asked[SEEN];
  iso_trajectory_query q;
  iso_gradient_table t = {0};
  double velocity[3 * NODES], end = 0;
  size_t k;
  make_in(&s, knob, ISO_IMPLICIT_EULER);
  for (k = 0; k < 3 * NODES; ++k) velocity[k] = speed * s.motion[k];
  ok(&s, iso_set_velocities(s.world, s.body, velocity, NODES, 0));
  make_outputs(&s, all);
  make_parameters(&s, p);
  o[0] = all[ISO_OUTPUT_MATERIAL_POINT];
  o[1] = o[2] = all[ISO_OUTPUT_DISTANCE];
  asked[0] = p[ISO_PARAMETER_MATERIAL];
  asked[1] = p[ISO_PARAMETER_AMOUNT_OF];
  asked[2] = p[VELOCITY];
  memset(&q, 0, sizeof q);
  q.size = sizeof q;
  q.steps = steps;
  q.step_count = STEPS;
  q.terms = o;
  q.term_steps = term_steps;
  q.term_output = term_output;
  q.term_count = TERMS;
  q.output_count = SUMS;
  q.parameters = asked;
  q.parameter_count = jacobian ? SEEN : 0;
  q.mode = mode;
  q.kept_states = kept;
  t.size = sizeof t;
  ok(&s, iso_trajectory_gradients(s.world, &q, &t));
  must(t.output_count == SUMS && t.column_count == q.parameter_count, "an output a sum, a column a number");
  memcpy(values, t.values, SUMS * sizeof *values);
  if (jacobian) memcpy(jacobian, t.jacobian, SUMS * SEEN * sizeof *jacobian);
  ok(&s, iso_time(s.world, &end));
  must(fabs(end - 0.07) < 1e-12, "the world is at the end of the way");
  if (jacobian && mode == ISO_GRADIENTS_ADJOINT)
    must(t.kept_states == (kept ? kept : STEPS - 1) && t.state_bytes > 48 * NODES, "what is kept is told");
  must(iso_world_free(s.world) == ISO_OK, "a world is freed");
}

static void a_way_through_time(void) {
  static const double weight[4] = {1. / 12, -8. / 12, 8. / 12, -1. / 12};
  static const int at[4] = {-2, -1, 1, 2};
  const double sizes[SEEN] = {knobs[YOUNG], knobs[TRACTION], 0.5};
  double values[SUMS], adjoint[SUMS * SEEN], tangent[SUMS * SEEN];
  int i, j, k;
  go_the_way(knobs, 0.5, ISO_GRADIENTS_ADJOINT, 0, values, adjoint);
  go_the_way(knobs, 0.5, ISO_GRADIENTS_TANGENT, 2, values, tangent);
  for (k = 0; k < SEEN; ++k) {
    const double h = 2e-3 * sizes[k];
    double wanted[SUMS] = {0};
    for (i = 0; i < 4; ++i) {
      double there[KNOBS], seen[SUMS];
      memcpy(there, knobs, sizeof there);
      if (k < 2) there[k == 0 ? YOUNG : TRACTION] += at[i] * h;
      go_the_way(there, 0.5 + (k == 2 ? at[i] * h : 0), ISO_GRADIENTS_AUTOMATIC, 0, seen, NULL);
      for (j = 0; j < SUMS; ++j) wanted[j] += weight[i] / h * seen[j];
    }
    for (j = 0; j < SUMS; ++j) {
      const double scale = fabs(wanted[j]) + 1e-3 * fabs(values[j]) / sizes[k];
      must(fabs(adjoint[SEEN * j + k] - wanted[j]) <= 1e-6 * scale, "the adjoint is what differences say");
      must(fabs(adjoint[SEEN * j + k] - tangent[SEEN * j + k]) <= 1e-9 * scale, "tangents say the same");
    }
  }
}

static void ways_that_are_refused(void) {
  const double steps[2] = {0.1, -1};
  const int32_t first = 1, far = 9, none = 4;
  scene s;
  iso_output o[OUTPUTS];
  iso_trajectory_query q;
  iso_gradient_table t = {0};
  make_in(&s, knobs, ISO_IMPLICIT_EULER);
  make_outputs(&s, o);
  memset(&q, 0, sizeof q);
  q.size = sizeof q;
  t.size = sizeof t;
  q.step_count = 1;
  must(iso_trajectory_gradients(s.world, &q, &t) == ISO_REFUSED, "steps must be there");
  q.steps = steps;
  q.step_count = 2;
  must(iso_trajectory_gradients(s.world, &q, &t) == ISO_REFUSED &&
           strstr(iso_last_error(s.world), "steps[1] = -1") != NULL,
       "steps are positive");
  q.step_count = 1;
  q.terms = o;
  q.term_count = 1;
  must(iso_trajectory_gradients(s.world, &q, &t) == ISO_REFUSED, "terms have steps");
  q.term_steps = &far;
  must(iso_trajectory_gradients(s.world, &q, &t) == ISO_REFUSED &&
           strstr(iso_last_error(s.world), "step = 9") != NULL,
       "steps there are");
  q.term_steps = &first;
  q.term_output = &none;
  q.output_count = 1;
  must(iso_trajectory_gradients(s.world, &q, &t) == ISO_REFUSED &&
           strstr(iso_last_error(s.world), "term_output[0] = 4") != NULL,
       "outputs there are");
  q.term_output = NULL;
  q.mode = 7;
  must(iso_trajectory_gradients(s.world, &q, &t) == ISO_REFUSED, "modes there are");
  must(iso_world_free(s.world) == ISO_OK, "a world is freed");
}

int main(void) {
  a_way_through_time();
  ways_that_are_refused();
  every_output_by_every_parameter();
  outputs_that_are_refused();
  parameters_that_are_refused();
  queries_that_are_refused();
  return 0;
}
