// A random scene under construction, and the parts that are drawn one after the other.
#pragma once

#include "studies/chaos/random.h"
#include "studies/chaos/scene.h"

namespace isochor::studies {

// What later parts need to know of a body.
struct DraftBody {
  Vec3 lower{}, upper{};  // where it is at rest [m]
  std::vector<std::string> surfaces, regions;
  std::string chamber;  // surface around a chamber; empty: it has none
  int cells = 0;
  std::vector<Vec3> nodes;  // at rest [m]; of a lattice: none
  bool tetrahedra = true;
  bool stands_on_last = false;  // flush on the body before it
  double young = 1e5;           // the softest [Pa]
  bool incompressible = false;
  Vec3 middle() const { return 0.5 * (lower + upper); }
};

struct ChaosDraft {
  ChaosSize size;
  ChaosScene out;
  std::vector<DraftBody> bodies;
  double length = 1;   // of the first body [m]
  double young = 1e5;  // [Pa]
  double density = 1e3;
  bool dynamic = false;
  double duration = 1;  // [s], or load factor

  ChaosRandom random(std::string_view topic) const { return {out.seed, topic}; }
  SceneDef& scene() { return out.scene; }
  // From zero, from the start on, or up and down; in units of the duration.
  Curve curve(ChaosRandom& random, double value, double start = 0) const;
  // The bulk of them moderate, some next to nothing and some absurd.
  static double load_factor(ChaosRandom& random);
  // Poses that move by `way` and may turn about an axis; the name of their file.
  std::string add_motion(ChaosRandom& random, const std::string& name, const Vec3& way);
  std::string add_surface_file(ChaosRandom& random, const std::string& name, const Vec3& extent);
};

void draft_analysis(ChaosDraft& draft);
void draft_bodies(ChaosDraft& draft);
void draft_volumes(ChaosDraft& draft);
void draft_supports(ChaosDraft& draft);
void draft_loads(ChaosDraft& draft);
void draft_cavities(ChaosDraft& draft);
void draft_attachments(ChaosDraft& draft);
void draft_contacts(ChaosDraft& draft);
void draft_active(ChaosDraft& draft);
void draft_drive(ChaosDraft& draft);

}  // namespace isochor::studies
