/* Isochor from C: a C99 interface to worlds, batches of worlds, meshes and scenes. docs/c.md starts from
 * zero.
 *
 * Rules that hold everywhere:
 *
 * - SI units: m, kg, s, N, Pa. Vectors are three doubles x, y, z. Indices begin with 0.
 * - Every call returns an iso_status. Where it is not ISO_OK, iso_last_error() of the world (or batch) is one
 *   sentence that says what, where, the value and the remedy; calls that have no world yet take a buffer
 *   `message` of `message_size` bytes, which they end with a zero and cut where it is too small; it may be
 *   null. A call that is refused changes nothing and leaves its outputs as they were.
 * - Structs that the caller makes or receives begin with `size`, which the caller sets to sizeof of the
 *   struct. Members that are zero have their defaults. Versions add members at the end of a struct alone: one
 *   of an earlier version is taken, and one of a later version where the members that this library does not
 *   know are zero; those of a struct that is filled become zero. Structs without `size` and those inside
 * others stay as they are.
 * - Texts are UTF-8 and end with a zero. What is passed in is only read during the call, callbacks and their
 *   `user` pointers apart. What is passed out as a pointer to const belongs to the world, batch or scene and
 *   stays good as long as is said beside it.
 * - A world is used by one thread at a time, a batch together with its worlds: a call while another runs is
 *   refused with ISO_BUSY. So are calls from a callback of the same world. iso_cancel() is good from
 * everywhere, at any time.
 * - Nothing is global; worlds know nothing of each other. */
#ifndef ISOCHOR_ISOCHOR_H
#define ISOCHOR_ISOCHOR_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define ISO_API __attribute__((visibility("default")))
#else
#define ISO_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef int32_t iso_status;
enum {
  ISO_OK = 0,
  ISO_REFUSED = 1,       /* bad input */
  ISO_NOT_CONVERGED = 2, /* a step found no equilibrium; the state is as it was, or the last one in balance */
  ISO_UNFINISHED = 3,    /* the budget of a step ran out; the state is its best iterate */
  ISO_CANCELLED = 4,     /* a step was stopped; the state is as it was */
  ISO_BUSY = 5,          /* another thread, or a callback, is in a call of the same world */
  ISO_NO_MEMORY = 6,
  ISO_FAILED = 7 /* an error of the library */
};

/* What a status means, a sentence. Good forever. */
ISO_API const char* iso_status_text(iso_status status);
/* Of the library, as "0.1.0". Good forever. */
ISO_API const char* iso_version(void);

typedef struct iso_world iso_world;
typedef struct iso_batch iso_batch;
typedef struct iso_scene iso_scene;

/* Bodies and effects, by value. They carry their world; those of another one, or of what was removed, are
 * refused. One that is all zero names nothing. */
typedef struct iso_body {
  int32_t number;
  uint32_t generation;
  uint64_t world;
} iso_body;
typedef struct iso_effect {
  int32_t number;
  uint32_t generation;
  uint64_t world;
} iso_effect;

/* ---- Meshes ---- */

/* Cell types, with the node orders of VTK; ISO_TRI3 is that of thin bodies. */
enum { ISO_TET4 = 0, ISO_TET10 = 1, ISO_HEX8 = 2, ISO_TRI3 = 3 };

typedef struct iso_named_indices {
  const char* name;
  const int32_t* indices;
  size_t count; /* of indices */
} iso_named_indices;

/* Numbers at nodes, as painted weights. */
typedef struct iso_field {
  const char* name;
  int32_t components;
  const double* values; /* `components` a node */
} iso_field;

typedef struct iso_mesh {
  size_t size;
  int32_t cell_type;
  const double* points; /* rest positions [m] */
  size_t point_count;
  size_t point_stride;  /* bytes from one point to the next; 0: 3 doubles */
  const int32_t* cells; /* 4, 10 or 8 nodes a cell */
  size_t cell_count;
  size_t cell_stride;         /* bytes from one cell to the next; 0: its nodes without a gap */
  const int32_t* cell_region; /* one a cell, an index into `regions`; null: all are in the first */
  const char* const* regions; /* names */
  size_t region_count;
  const iso_named_indices* surfaces; /* 3, 6 or 4 nodes a face */
  size_t surface_count;
  const iso_named_indices* node_sets;
  size_t node_set_count;
  const iso_field* fields;
  size_t field_count;
  void* owner; /* null in meshes that the caller makes */
} iso_mesh;

/* Reads a mesh file of any format of docs/meshes.md; `scale` multiplies coordinates (1e-3: a file in mm).
 * `*out` belongs to the caller, who frees it with iso_mesh_free(). */
ISO_API iso_status iso_mesh_read(const char* path, double scale, iso_mesh** out, char* message,
                                 size_t message_size);
/* A box of cells (tets: six a cell) with surfaces x0, x1, y0, y1, z0, z1; `cell_type` ISO_TET4 or ISO_HEX8,
 * or ISO_TRI3 for a sheet that is flat along one axis. */
ISO_API iso_status iso_mesh_box(const double lower[3], const double upper[3], const int32_t divisions[3],
                                int32_t cell_type, iso_mesh** out, char* message, size_t message_size);
/* Of the two calls above, once. Null, and meshes that the caller made, are left alone. */
ISO_API void iso_mesh_free(iso_mesh* mesh);

/* ---- Worlds ---- */

enum {
  ISO_SCHEME_BY_KEYS = 0, /* as `keys` say; without keys implicit Euler */
  ISO_STATICS = 1,
  ISO_CONTINUATION = 2, /* statics, with iso_follow() */
  ISO_IMPLICIT_EULER = 3,
  ISO_BDF2 = 4,
  ISO_GENERALIZED_ALPHA = 5,
  ISO_NEWMARK = 6,
  ISO_IMPLICIT_MIDPOINT = 7
};

/* `line` is good during the call. Called by the thread that is in a call of the world. */
typedef void (*iso_log_fn)(void* user, const char* line);

typedef struct iso_options {
  size_t size;
  int32_t scheme;
  int32_t threads;    /* 0: all that the machine has; results do not depend on it */
  double gravity[3];  /* [m/s^2] */
  const char* folder; /* where relative paths in keys start; null: the working folder */
  /* One object of JSON with the keys of "analysis" in docs/scenes.md (method, solver, tolerances, ...), and
   * "gravity", "gravity_amount", "threads", "follow"; null: none. A member above that is given and a key that
   * says the same thing are refused. */
  const char* keys;
  iso_log_fn log; /* warnings; null: none. `log_user` must live as long as the world and its clones. */
  void* log_user;
} iso_options;

/* `options` null: all defaults. The world belongs to the caller, who frees it with iso_world_free(). */
ISO_API iso_status iso_world_create(const iso_options* options, iso_world** out, char* message,
                                    size_t message_size);
/* Null is left alone; so are worlds of a batch, and a world that is in a call (ISO_BUSY). */
ISO_API iso_status iso_world_free(iso_world* world);
/* Why the last call of this world that was not ISO_OK was refused, or how its step ended; empty when all were
 * fine. Good until the next call of the world. */
ISO_API const char* iso_last_error(const iso_world* world);

/* Another world with the same scene, state and settings, which goes on with the same bits and belongs to the
 * caller. Ids of this one are good there as well. Callbacks stay behind. `threads` 0: as many as this has. */
ISO_API iso_status iso_world_clone(iso_world* world, int32_t threads, iso_world** out);
/* Back to the state at rest at time 0; bodies, effects and materials stay as they are now. */
ISO_API iso_status iso_reset(iso_world* world);

/* Everything that survives a step. `*bytes` is good until the next call of iso_save(). */
ISO_API iso_status iso_save(iso_world* world, const void** bytes, size_t* count);
/* Into a world of the same scene, which goes on with the same bits. */
ISO_API iso_status iso_load(iso_world* world, const void* bytes, size_t count);
ISO_API iso_status iso_state_hash(iso_world* world, uint64_t* out);

/* ---- Bodies and effects ---- */

/* `keys`: one object of JSON with the keys of a body of a scene file: name, materials, element, ... `mesh`:
 * its mesh, copied; null: that of the key "mesh". */
ISO_API iso_status iso_add_body(iso_world* world, const char* keys, const iso_mesh* mesh, iso_body* out);
/* The commonest: neo-Hookean, with Young's modulus [Pa], Poisson's ratio (0.5 is fine) and density [kg/m^3].
 */
ISO_API iso_status iso_add_soft_body(iso_world* world, const char* name, const iso_mesh* mesh, double young,
                                     double poisson, double density, iso_body* out);

/* `kind`: volume, dirichlet, cavity, traction, pressure, force, damping, ... and `keys` one object of JSON
 * with its keys, as docs/scenes.md lists them. Effects name bodies by name, by default the first. Names are
 * looked up by iso_compile(). */
ISO_API iso_status iso_add(iso_world* world, const char* kind, const char* keys, iso_effect* out);

/* The commonest effects. Surfaces are `count` names of surfaces of the body's mesh. */
/* Rows that keep volume, a pressure at every node. */
ISO_API iso_status iso_add_volume(iso_world* world, iso_body body, iso_effect* out);
/* Holds the nodes of surfaces. */
ISO_API iso_status iso_add_support(iso_world* world, const char* name, iso_body body,
                                   const char* const* surfaces, size_t count, iso_effect* out);
/* A chamber under a pressure, its amount [Pa], 0 at first. */
ISO_API iso_status iso_add_cavity(iso_world* world, const char* name, iso_body body,
                                  const char* const* surfaces, size_t count, iso_effect* out);
/* Contact with the half space behind a plane, with Coulomb friction. No surfaces: the whole boundary. */
ISO_API iso_status iso_add_floor(iso_world* world, const char* name, iso_body body,
                                 const char* const* surfaces, size_t count, const double point[3],
                                 const double normal[3], double friction, iso_effect* out);

/* All keys that there are, as one text of JSON {"effects": {...}, "parts": {...}} with types, units, bounds,
 * defaults and meanings. Copied to `out` with its final zero where it fits in `size` bytes; `*needed` is what
 * it takes. `out` may be null where `size` is 0. */
ISO_API iso_status iso_keys(char* out, size_t size, size_t* needed);

enum { ISO_WORK_NOTHING = 0, ISO_WORK_NUMBERS = 1, ISO_WORK_STRUCTURE = 2 };
typedef struct iso_compile_report {
  size_t size;
  int32_t work; /* ISO_WORK_... */
  double seconds;
} iso_compile_report;

/* Builds the scene, or what has changed of it, which the next step would do too. `out` may be null. */
ISO_API iso_status iso_compile(iso_world* world, iso_compile_report* out);

/* Changes of a world that lives; what is untouched keeps its state bit for bit. */
ISO_API iso_status iso_remove_body(iso_world* world, iso_body body); /* that no effect names */
ISO_API iso_status iso_remove_effect(iso_world* world, iso_effect effect);
/* Another definition in the place of an effect, whose id stays. */
ISO_API iso_status iso_replace(iso_world* world, iso_effect effect, const char* kind, const char* keys);
/* Of one region; of all where `region` is null or empty. `keys`: those of a material of a scene file, without
 * region and density. */
ISO_API iso_status iso_set_material(iso_world* world, iso_body body, const char* region, const char* keys);
ISO_API iso_status iso_set_density(iso_world* world, iso_body body, const char* region, double density);

/* ---- Driving ---- */

typedef struct iso_pose {
  size_t size;
  double position[3]; /* [m] */
  double rotation[4]; /* unit quaternion w, x, y, z; all zero: no turn */
} iso_pose;

/* A pressure [Pa], a volume [m^3], a scale, ..., instead of the curve of the effect. */
ISO_API iso_status iso_set_amount(iso_world* world, iso_effect effect, double amount);
ISO_API iso_status iso_set_gravity(iso_world* world, const double gravity[3]);
/* Where a support or an obstacle is from the end of the next increment on. */
ISO_API iso_status iso_set_pose(iso_world* world, iso_effect effect, const iso_pose* pose);
/* Dead forces [N], `count` vectors, one a node; `stride` in bytes, 0: 3 doubles. They stay until they are set
 * anew or cleared. */
ISO_API iso_status iso_set_forces(iso_world* world, iso_body body, const double* forces, size_t count,
                                  size_t stride);
ISO_API iso_status iso_add_force(iso_world* world, iso_body body, int32_t node, const double force[3]);
/* At a point of the body, where it is at rest [m]. */
ISO_API iso_status iso_add_force_at(iso_world* world, iso_body body, const double point[3],
                                    const double force[3]);
ISO_API iso_status iso_clear_forces(iso_world* world);
/* One position [m] or velocity [m/s] a node, as in iso_set_forces(). */
ISO_API iso_status iso_set_positions(iso_world* world, iso_body body, const double* positions, size_t count,
                                     size_t stride);
ISO_API iso_status iso_set_velocities(iso_world* world, iso_body body, const double* velocities, size_t count,
                                      size_t stride);

/* ---- Stepping ---- */

typedef struct iso_report {
  size_t size;
  iso_status status;
  const char* reason;  /* empty when converged. Both are good until the next step of the world or batch. */
  const char* warning; /* about an end that is not to be taken as it is; empty: none */
  double time;         /* of the state now [s]; statics: load factor */
  int32_t iterations, corrections, factorizations;
  int32_t substeps, rejected_substeps, rescues;
  int32_t unstable_directions; /* iso_follow(); -1: unknown */
  double min_J;                /* smallest ratio of volumes of a cell */
  int32_t inverted_cells;
  double force_residual, row_residual, time_error;
  double seconds, factor_seconds, solve_seconds;
  iso_compile_report compiled; /* of changes that waited for this step */
} iso_report;

/* ISO_OK: converged. `report` may be null. `h` [s]; statics: of load factor. */
ISO_API iso_status iso_step(iso_world* world, double h, iso_report* report);
/* Within a budget of iterations and of seconds, 0: none. */
ISO_API iso_status iso_step_within(iso_world* world, double h, int32_t iterations, double seconds,
                                   iso_report* report);
/* As many increments as it takes. */
ISO_API iso_status iso_advance(iso_world* world, double h, iso_report* report);
/* Statics, ISO_CONTINUATION: a step of this length [m] along the path of equilibria. */
ISO_API iso_status iso_follow(iso_world* world, double length, iso_report* report);
/* Stops the step that runs, or else the next one. From any thread and from callbacks. */
ISO_API iso_status iso_cancel(iso_world* world);

typedef struct iso_progress {
  size_t size;
  double time, target;
  int32_t iteration;
  double force_residual, row_residual;
} iso_progress;
/* `progress` is good during the call, which is made by the thread that steps. */
typedef void (*iso_progress_fn)(void* user, const iso_progress* progress);
/* Not 0: stop. Called often, from any of the world's threads. */
typedef int (*iso_stop_fn)(void* user);

/* `user` must live until another one is set or the world is freed. Null: none. */
ISO_API iso_status iso_on_progress(iso_world* world, iso_progress_fn callback, void* user);
ISO_API iso_status iso_stop_when(iso_world* world, iso_stop_fn callback, void* user);

/* ---- Reading ---- */

ISO_API iso_status iso_time(iso_world* world, double* out);
/* Views of the state's own numbers, `*count` vectors without gaps. Steps, iso_load() and iso_reset() put new
 * ones in; they end where bodies or effects come or go, and with the world. */
ISO_API iso_status iso_positions(iso_world* world, iso_body body, const double** out, size_t* count);
ISO_API iso_status iso_velocities(iso_world* world, iso_body body, const double** out, size_t* count);
ISO_API iso_status iso_rest_positions(iso_world* world, iso_body body, const double** out, size_t* count);
/* The mesh that is in use (ISO_TET10 where the element asked for it). Good until the next call of
 * iso_body_mesh(), and as long as views are. */
ISO_API iso_status iso_body_mesh(iso_world* world, iso_body body, const iso_mesh** out);

/* All that are there. Good until the next call of the same function. */
ISO_API iso_status iso_bodies(iso_world* world, const iso_body** out, size_t* count);
ISO_API iso_status iso_effects(iso_world* world, const iso_effect** out, size_t* count);
ISO_API iso_status iso_find_body(iso_world* world, const char* name, iso_body* out);
ISO_API iso_status iso_find_effect(iso_world* world, const char* name, iso_effect* out);
/* Good until the next call of one of these two. */
ISO_API iso_status iso_body_name(iso_world* world, iso_body body, const char** out);
ISO_API iso_status iso_effect_name(iso_world* world, iso_effect effect, const char** out);
/* ISO_OK: it is there. */
ISO_API iso_status iso_check_body(iso_world* world, iso_body body);
ISO_API iso_status iso_check_effect(iso_world* world, iso_effect effect);

/* A number that an effect reports. Texts are good as long as the struct. */
typedef struct iso_gauge {
  const char *effect, *kind, *quantity, *unit;
  double value;
} iso_gauge;
/* Good until the next call of iso_gauges(). */
ISO_API iso_status iso_gauges(iso_world* world, const iso_gauge** out, size_t* count);
/* One of them, as in ("chamber", "volume"). */
ISO_API iso_status iso_gauge_value(iso_world* world, const char* effect, const char* quantity, double* out);

/* Force [N] of a support, and moment about the origin [N m]; either may be null. */
ISO_API iso_status iso_reaction(iso_world* world, iso_effect effect, double force[3], double moment[3]);

typedef struct iso_measures {
  size_t size;
  double volume, rest_volume; /* [m^3] */
  double min_J, max_J;        /* of cells */
  /* Of bodies, zero for regions: */
  double volume_row_residual;
  double mass;              /* [kg] */
  double center_of_mass[3]; /* [m] */
  double linear_momentum[3], angular_momentum[3];
} iso_measures;
/* Of a region of the body by its name; null: of the body. */
ISO_API iso_status iso_measure(iso_world* world, iso_body body, const char* region, iso_measures* out);

typedef struct iso_energies {
  size_t size;
  double kinetic, elastic, gravity, loads, pressures; /* [J] */
} iso_energies;
ISO_API iso_status iso_energy(iso_world* world, iso_energies* out);
/* Of everything that has mass; either may be null. */
ISO_API iso_status iso_momentum(iso_world* world, double linear[3], double angular[3]);

/* Stresses and pressures of a body, recovered for output. Arrays may be null where a body has none; they are
 * good until the next call of iso_fields(). */
typedef struct iso_body_fields {
  size_t size;
  size_t nodes, cells;
  const double* node_pressure;         /* tr(sigma)/3 [Pa] */
  const double* node_stress;           /* xx yy zz xy yz zx [Pa], 6 a node */
  const double* cell_J;                /* ratio of volumes */
  const double* cell_pressure;         /* [Pa] */
  const double* cell_von_mises;        /* [Pa] */
  const double* cell_stress;           /* as of nodes, 6 a cell */
  const double* cell_max_stretch;      /* */
  const double* node_contact_pressure; /* [Pa] */
  const double* node_friction;         /* [Pa], 3 a node */
} iso_body_fields;
ISO_API iso_status iso_fields(iso_world* world, iso_body body, iso_body_fields* out);

/* A point of a contact that presses; forces are on `body`, the partner has the opposite. */
typedef struct iso_contact {
  iso_effect effect;
  const char *body, *partner;
  int32_t node;                        /* of the body's mesh; -1: the point is none of its nodes */
  double position[3];                  /* [m] */
  double gap;                          /* [m] */
  double normal[3];                    /* away from the partner */
  double normal_force[3], friction[3]; /* [N] */
  double area;                         /* at rest [m^2]; 0: edges */
} iso_contact;
typedef struct iso_contact_pair {
  const char *body, *partner;
  double force[3]; /* on the body, friction included [N] */
  double normal;   /* sum of the magnitudes of normal forces [N] */
  int32_t points;
} iso_contact_pair;
/* Good until the next call of the same function. */
ISO_API iso_status iso_contacts(iso_world* world, const iso_contact** out, size_t* count);
ISO_API iso_status iso_contact_pairs(iso_world* world, const iso_contact_pair** out, size_t* count);

typedef struct iso_orientation {
  size_t size;
  double angle;           /* [rad] */
  double axis[3];         /* of the turn since rest */
  double displacement[3]; /* [m] */
  double normal[3];
  double misfit; /* [m] */
} iso_orientation;
/* How nodes have turned and moved; `where`: one object of JSON with the keys of a selection. */
ISO_API iso_status iso_turn(iso_world* world, const char* where, iso_orientation* out);

/* What is changed: the amount of an effect, or a force on a point of a body at rest. */
typedef struct iso_input {
  size_t size;
  iso_effect effect; /* whose amount, where `force` is zero */
  iso_body body;
  double point[3]; /* [m] */
  double force[3]; /* [N]; the derivative is per this force */
} iso_input;
typedef struct iso_vectors {
  const double* data;
  size_t count; /* of vectors */
} iso_vectors;
typedef struct iso_wrench {
  double force[3], moment[3];
} iso_wrench;
/* Derivatives of the equilibrium by one input. */
typedef struct iso_response {
  const iso_vectors* positions; /* of the nodes, by body as in iso_bodies() */
  size_t body_count;
  const iso_gauge* gauges; /* as in iso_gauges() */
  size_t gauge_count;
  const iso_wrench* reactions; /* by effect as in iso_effects() */
  size_t effect_count;
  int32_t regular;  /* 0: `note` says what is about to touch, let go or slide */
  const char* note; /* */
  int32_t unstable_directions;
} iso_response;
/* One response an input, in `*out`, good until the next call of iso_derivatives(). */
ISO_API iso_status iso_derivatives(iso_world* world, const iso_input* inputs, size_t count,
                                   const iso_response** out);

/* A number that an equilibrium shows; docs/derivatives.md tells of all of them. Members that are not said to
 * be of a kind are not looked at. */
enum {
  ISO_OUTPUT_POSITIONS = 0,      /* the sum of vector . x over `nodes`: every linear function of positions */
  ISO_OUTPUT_DISTANCE = 1,       /* half the sum of |x - vector|^2 over `nodes` [m^2] */
  ISO_OUTPUT_MATERIAL_POINT = 2, /* direction . x of the point of the body that is at `point` at rest */
  ISO_OUTPUT_GAUGE = 3,          /* `quantity` of `effect`, as iso_gauge_value() */
  ISO_OUTPUT_REACTION = 4,       /* force . F + moment . M of the reaction (F, M) of `effect` */
  ISO_OUTPUT_ELASTIC_ENERGY = 5, /* of the world [J] */
  ISO_OUTPUT_ENERGY = 6, /* `quantity` of iso_energies: "elastic", "gravity", ...; "kinetic" of ways */
  ISO_OUTPUT_SQUARE = 7, /* half the square of (the sum of vector . x over `nodes`, less `target`) */
  ISO_OUTPUT_STRESS = 8, /* `quantity` in `cell` of iso_body_mesh(): "von_mises", "pressure", "xx" ... [Pa] */
  ISO_OUTPUT_EFFECT_FORCE = 9, /* direction . F, what `effect` does to the nodes of `body` in all [N] */
  ISO_OUTPUT_OF_POSITIONS = 10 /* what `function` makes of the positions of `body` */
};
/* Of `count` positions: the number, and into `gradient` how it changes with each of them, both of 3 doubles a
 * node. What is not finite is refused. */
typedef double (*iso_positions_fn)(void* user, const double* positions, double* gradient, size_t count);
typedef struct iso_output {
  size_t size;
  int32_t kind; /* ISO_OUTPUT_... */
  iso_body body;
  const int32_t* nodes;  /* `count` of the body; null: all of them */
  const double* vectors; /* `count` vectors, one a node; `stride` in bytes, 0: 3 doubles */
  size_t count, stride;
  double point[3], direction[3]; /* [m] */
  iso_effect effect;
  const char* quantity;
  double force[3], moment[3];
  double target;
  int32_t cell;
  iso_positions_fn function;
  void* user;
} iso_output;

/* The keys of a material or an effect where a number has this value, one object of JSON; null: there is no
 * such thing. The text must stay until the next call of the function. */
typedef const char* (*iso_keys_fn)(void* user, double value);

/* A number of the scene, or a list of them. */
enum {
  ISO_PARAMETER_AMOUNT_OF = 0,        /* of `effect`, in its unit */
  ISO_PARAMETER_FORCE_AT = 1,         /* a factor on a dead force `vector` [N] at `point` of `body` */
  ISO_PARAMETER_GRAVITY = 2,          /* along `vector`, whose length is the unit [m/s^2] */
  ISO_PARAMETER_DENSITY = 3,          /* of `region` of `body` [kg/m^3] */
  ISO_PARAMETER_MATERIAL = 4,         /* a number among the keys of the material of `region` of `body` */
  ISO_PARAMETER_STIFFNESS = 5,        /* a factor on the stiffness of `region` of `body`, at 1 */
  ISO_PARAMETER_CELL_STIFFNESS = 6,   /* the same of each cell of `body`: as many numbers; not by tangents */
  ISO_PARAMETER_CONSTANT_OF = 7,      /* a number among the keys of `effect`, whose kind is `effect_kind` */
  ISO_PARAMETER_SHAPE = 8,            /* rest positions of `body` move by this times `motion` */
  ISO_PARAMETER_INITIAL_VELOCITY = 9, /* of trajectories: those at the start change by this times `motion` */
  ISO_PARAMETER_CURVE_POINT = 10      /* the value of point `number` of the curve of the amount of `effect` */
};
typedef struct iso_parameter {
  size_t size;
  int32_t kind; /* ISO_PARAMETER_... */
  iso_effect effect;
  iso_body body;
  const char* region; /* null or empty: all of the body */
  double point[3], vector[3];
  const double* motion; /* `count` vectors, one a node of iso_body_mesh(); `stride` in bytes, 0: 3 doubles */
  size_t count, stride;
  /* Of a material or an effect: its keys as they are, as in iso_set_material() and iso_replace(), and the one
   * that is meant, "young" or "terms[0].mu"; or in their place a function that makes the keys, and the value
   * that the scene was made with. */
  const char *keys, *key, *effect_kind;
  iso_keys_fn make;
  void* user;
  double value;
  double step; /* how far it is moved where a difference is taken; 0: 1e-4 of its value */
  /* The curve that the amount follows, `curve_count` pairs of time and value; points by number from 0. */
  const double* curve;
  size_t curve_count;
  int32_t number;
} iso_parameter;

/* Adjoint: one solve an output; tangent: one solve a parameter. */
enum { ISO_GRADIENTS_AUTOMATIC = 0, ISO_GRADIENTS_ADJOINT = 1, ISO_GRADIENTS_TANGENT = 2 };
typedef struct iso_gradient_query {
  size_t size;
  const iso_output* outputs;
  size_t output_count;
  const iso_parameter* parameters;
  size_t parameter_count;
  int32_t mode;     /* ISO_GRADIENTS_... */
  int32_t unstable; /* not 0: of equilibria that are unstable under fixed loads, too */
} iso_gradient_query;

typedef struct iso_gradient_table {
  size_t size;
  const double* values; /* of the outputs */
  size_t output_count;
  const double* jacobian; /* `column_count` derivatives an output */
  size_t column_count;
  const size_t* columns;        /* where each parameter begins, and at last `column_count` */
  int32_t regular;              /* 0: of one side only, or with friction, which `note` says in words */
  const char* note;             /* */
  const char* const* undecided; /* effects whose rows are about to touch or to let go */
  size_t undecided_count;
  int32_t adjoint; /* how it was found */
  /* Of trajectories: states that were kept at most at a time, steps that were made again, bytes of a state.
   */
  int32_t kept_states, steps_again;
  size_t state_bytes;
} iso_gradient_table;
/* Gradients of outputs of an equilibrium of statics by parameters of the scene. The state stays as it is.
 * Pointers are good until the next call of iso_gradients(). */
ISO_API iso_status iso_gradients(iso_world* world, const iso_gradient_query* query, iso_gradient_table* out);

typedef struct iso_trajectory_query {
  size_t size;
  const double* steps; /* lengths of `step_count` increments from the state that the world is at [s] */
  size_t step_count;
  const iso_output* terms;    /* `term_count` outputs, ... */
  const int32_t* term_steps;  /* ... each at the end of a step, from 1, or 0: at the start */
  const int32_t* term_output; /* the output that each adds to, 0 to `output_count` - 1; null: each its own */
  size_t term_count, output_count;
  const iso_parameter* parameters;
  size_t parameter_count;
  int32_t mode;        /* ISO_GRADIENTS_... */
  int32_t kept_states; /* of the way, at a time; others are made again. 0: all are kept */
} iso_trajectory_query;
/* Goes through the increments, as iso_step() does, and finds the gradients of what is seen on the way. The
 * world is at their end then, on an error where it was. Pointers are good until the next call of
 * iso_gradients() or this. */
ISO_API iso_status iso_trajectory_gradients(iso_world* world, const iso_trajectory_query* query,
                                            iso_gradient_table* out);

typedef struct iso_world_size {
  size_t size;
  int32_t nodes, displacement_unknowns, multipliers, matrix_size;
  int64_t matrix_nonzeros, factor_nonzeros;
  size_t engine_bytes, table_bytes;
} iso_world_size;
ISO_API iso_status iso_size(iso_world* world, iso_world_size* out);
/* Largest |phi - target - C lambda| of all rows, relative to their measure. */
ISO_API iso_status iso_constitutive_residual(iso_world* world, double* out);
/* The method at work and why. Good until the next call of iso_method(). */
ISO_API iso_status iso_method(iso_world* world, const char** out);
/* What compiling noticed. Good until the next call of iso_warnings(). */
ISO_API iso_status iso_warnings(iso_world* world, const char* const** out, size_t* count);

/* ---- Batches: worlds of one scene, side by side ---- */

/* `count` clones of a world, at its present state; each steps on one thread with the bits that it has alone.
 * `threads` 0: all the machine has. The batch belongs to the caller; the sentence of a refusal is that of
 * iso_last_error(world). */
ISO_API iso_status iso_batch_create(iso_world* world, int32_t count, int32_t threads, iso_batch** out);
/* Null is left alone. The batch's worlds end with it. */
ISO_API iso_status iso_batch_free(iso_batch* batch);
/* As iso_last_error(), of calls that take the batch. */
ISO_API const char* iso_batch_last_error(const iso_batch* batch);
ISO_API iso_status iso_batch_size(iso_batch* batch, int32_t* out);
ISO_API iso_status iso_batch_threads(iso_batch* batch, int32_t* out);
/* The i-th world, for all that is set or asked of one alone. It belongs to the batch and ends with it. */
ISO_API iso_status iso_batch_world(iso_batch* batch, int32_t number, iso_world** out);
/* All worlds; `reports`: null, or one a world, whose `size` is set in each; `count` is their number. The
 * status is that of the first world that is not ISO_OK; it does not keep the others from going on. */
ISO_API iso_status iso_batch_advance(iso_batch* batch, double h, iso_report* reports, size_t count);
ISO_API iso_status iso_batch_step(iso_batch* batch, double h, int32_t iterations, double seconds,
                                  iso_report* reports, size_t count);
/* Worlds whose mark is not 0 go back to the beginning; null: all. */
ISO_API iso_status iso_batch_reset(iso_batch* batch, const uint8_t* marks, size_t count);
/* One amount a world. */
ISO_API iso_status iso_batch_set_amounts(iso_batch* batch, iso_effect effect, const double* amounts,
                                         size_t count);
/* Of a body in all worlds, copied to `out`: `count` vectors (worlds x nodes). */
ISO_API iso_status iso_batch_positions(iso_batch* batch, iso_body body, double* out, size_t count);
ISO_API iso_status iso_batch_velocities(iso_batch* batch, iso_body body, double* out, size_t count);
/* What each world takes, on average, and what all share [bytes]. */
ISO_API iso_status iso_batch_memory(iso_batch* batch, size_t* each, size_t* shared);

/* ---- Scenes ---- */

/* A scene file, or where there is no such file a scene of the library by its name ("finger"). `overrides`:
 * `count` texts "path=value" as of the command line's --set. The scene belongs to the caller. */
ISO_API iso_status iso_scene_open(const char* path_or_name, const char* const* overrides, size_t count,
                                  iso_scene** out, char* message, size_t message_size);
/* Null is left alone. */
ISO_API void iso_scene_free(iso_scene* scene);
/* Good as long as the scene, as are the texts of the two below. */
ISO_API iso_status iso_scene_name(const iso_scene* scene, const char** out);
/* The scene as the text of a scene file. */
ISO_API iso_status iso_scene_json(const iso_scene* scene, const char** out);
/* How the scene is advanced: `steps` steps of `h` [s]; `*path_step` [m] is not 0 where it is followed
 * instead. Each may be null. */
ISO_API iso_status iso_scene_plan(const iso_scene* scene, int32_t* steps, double* h, double* path_step);
/* A compiled world of the scene, as often as asked, which belongs to the caller. Its bodies and effects are
 * found by iso_find_body() and iso_find_effect(). A scene is used by one thread at a time. */
ISO_API iso_status iso_scene_world(const iso_scene* scene, int32_t threads, iso_world** out, char* message,
                                   size_t message_size);

/* One run of a search for an error. */
typedef struct iso_trial {
  size_t size;
  const char* setting; /* element and mesh in words */
  const char* status;  /* "converged", ... */
  int32_t elements, unknowns;
  double seconds;
  double indicator; /* of the error, relative, the largest of all metrics and probes; below 0: unknown */
} iso_trial;
/* Not 0: stop. Texts are good during the call. */
typedef int (*iso_trial_fn)(void* user, const iso_trial* trial);
typedef struct iso_search_options {
  size_t size;
  double error;          /* relative: 0.01 */
  const char* folder;    /* where outputs of the best run go; null: none are kept */
  int32_t threads;       /* 0: all the machine has */
  int32_t most_levels;   /* of refinement of the whole mesh; 0: 4. Three times as many where it counts */
  double budget;         /* of all runs together [s]; 0: none */
  iso_trial_fn on_trial; /* after each run; null: nobody is told */
  void* user;
} iso_search_options;
enum {
  ISO_SEARCH_REACHED = 0,
  ISO_SEARCH_NOT_REACHED = 1, /* within the levels and the memory there are */
  ISO_SEARCH_BUDGET = 2,
  ISO_SEARCH_STOPPED = 3,     /* by the function */
  ISO_SEARCH_NOT_WRITTEN = 4, /* outputs could not be */
  ISO_SEARCH_FAILED = 5       /* no run converged */
};
typedef struct iso_search_result {
  size_t size;
  int32_t end;         /* ISO_SEARCH_... */
  iso_scene* best;     /* as the best run has it, which belongs to the caller; null: no run converged */
  double indicator;    /* of the best run; below 0: unknown */
  int32_t trials;      /* how many runs there were */
  uint64_t state_hash; /* of the best run at its end */
} iso_search_result;
/* Finds element and mesh so that every metric and probe of a scene is within an error. An error that is not
 * reached is ISO_OK and told in `end`; `message` holds how the answer is known, or why there is none. Bad
 * input is refused. */
ISO_API iso_status iso_scene_solve_to(const iso_scene* scene, const iso_search_options* options,
                                      iso_search_result* out, char* message, size_t message_size);

#ifdef __cplusplus
}
#endif
#endif
