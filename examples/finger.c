/* Inflates a soft finger over a floor, frame by frame, in C.   finger_c scenes/meshes/finger_small.msh */
#include <inttypes.h>
#include <isochor/isochor.h>
#include <stdio.h>
#include <stdlib.h>

/* Every call returns a status; the sentence says what, where and the remedy. */
static void check(iso_world* world, iso_status status) {
  if (status == ISO_OK) return;
  fprintf(stderr, "%s\n", iso_last_error(world));
  exit(2);
}

int main(int argc, char** argv) {
  char message[500];
  iso_mesh* mesh = NULL;
  iso_world* world = NULL;
  iso_options options = {0};
  iso_body finger;
  iso_effect rows, clamp, air, floor;
  const char* clamped[] = {"clamped"};
  const char* chamber[] = {"chamber"};
  const double point[3] = {0, -0.008, 0}, up[3] = {0, 1, 0};
  const double* x = NULL;
  size_t nodes = 0, touching = 0;
  const iso_contact* contacts = NULL;
  uint64_t hash = 0;
  int frame;

  if (iso_mesh_read(argc > 1 ? argv[1] : "scenes/meshes/finger_small.msh", 1, &mesh, message,
                    sizeof message) != ISO_OK) {
    fprintf(stderr, "%s\n", message);
    return 2;
  }
  options.size = sizeof options;
  options.threads = 1;
  options.gravity[1] = -9.81;
  if (iso_world_create(&options, &world, message, sizeof message) != ISO_OK) {
    fprintf(stderr, "%s\n", message);
    return 2;
  }
  check(world, iso_add_soft_body(world, "finger", mesh, 100e3, 0.5, 1070, &finger));
  iso_mesh_free(mesh); /* the world has its own */
  check(world, iso_add_volume(world, finger, &rows));
  check(world, iso_add_support(world, "clamp", finger, clamped, 1, &clamp));
  check(world, iso_add_cavity(world, "air", finger, chamber, 1, &air));
  check(world, iso_add_floor(world, "floor", finger, NULL, 0, point, up, 0.3, &floor));

  for (frame = 1; frame <= 30; ++frame) {
    iso_report report = {0};
    report.size = sizeof report;
    check(world, iso_set_amount(world, air, 300.0 * frame)); /* Pa */
    if (iso_advance(world, 1.0 / 60, &report) != ISO_OK) {
      fprintf(stderr, "%s\n", report.reason);
      return 3;
    }
    check(world, iso_positions(world, finger, &x, &nodes)); /* a view, no copy */
    check(world, iso_contacts(world, &contacts, &touching));
    if (frame % 10 == 0)
      printf("%.2f s  the last node is at (%.1f, %.1f, %.1f) mm, %d points touch\n", report.time,
             1e3 * x[3 * nodes - 3], 1e3 * x[3 * nodes - 2], 1e3 * x[3 * nodes - 1], (int)touching);
  }
  check(world, iso_state_hash(world, &hash));
  printf("%016" PRIx64 "\n", hash);
  return iso_world_free(world) == ISO_OK ? 0 : 1;
}
