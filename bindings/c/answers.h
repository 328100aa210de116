// What a world handed out last: it stays where it is until the same question is asked again.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "isochor/gradients.h"
#include "isochor/isochor.h"
#include "isochor/world.h"

namespace isochor::c {

// A mesh as C sees it; texts and numbers stay those of the mesh that it was made of.
struct MeshView {
  iso_mesh mesh{};
  std::vector<const char*> regions;
  std::vector<iso_named_indices> surfaces, node_sets;
  std::vector<iso_field> fields;

  void show(const Mesh& from);
};

struct GaugeList {
  std::vector<Gauge> kept;
  std::vector<iso_gauge> shown;

  void show(std::vector<Gauge> gauges);
};

// A derivative with what its pointers lead to.
struct KeptResponse {
  Response response;
  std::vector<iso_vectors> positions;
  GaugeList gauges;
  std::vector<iso_wrench> reactions;
};

// What pointers of an iso_gradient_table lead to.
struct KeptGradients {
  Gradients told;
  std::vector<double> jacobian;
  std::vector<std::size_t> columns;
  std::vector<const char*> undecided;
};

struct Answers {
  StepReport report;
  std::vector<std::byte> saved;
  std::string name, method;
  MeshView mesh;
  std::vector<iso_body> bodies;
  std::vector<iso_effect> effects;
  GaugeList gauges;
  BodyFields fields;
  std::vector<ContactPoint> contact_points;
  std::vector<iso_contact> contacts;
  std::vector<ContactPair> contact_sums;
  std::vector<iso_contact_pair> contact_pairs;
  std::vector<KeptResponse> kept_responses;
  std::vector<iso_response> responses;
  KeptGradients gradients;
  std::vector<std::string> kept_warnings;
  std::vector<const char*> warnings;
};

}  // namespace isochor::c
