// Figures and tables of the three papers as scenes of our own: what each states, and what is different here.
//
//   Locking-Proof Tetrahedra: Francu, Asgeirsson, Erleben & Ronnow, ACM Trans. Graph. 40(2), 2021.
//   Volume-preserving skin: Sheen, Larionov & Pai, Proc. ACM Comput. Graph. Interact. Tech. 4(3), 2021.
//   Stable Neo-Hookean: Smith, De Goes & Kim, ACM Trans. Graph. 37(2), 2018.
#pragma once

#include <string>
#include <vector>

#include "studies/study.h"

namespace isochor::studies {

// A number of a case beside the one that the paper states.
struct ShownNumber {
  std::string what, metric;  // of Measured::values
  double scale = 1;          // multiplies it
  std::string unit;
  std::string stated;  // by the paper; empty: it does not say
};

struct PaperCase {
  std::string figure, what, setting;
  std::vector<ShownNumber> shown;
  Cell cell;
};

// Cases of one paper, and what is different from it here.
struct PaperPart {
  std::string title, differs;
  std::vector<PaperCase> cases;
};

// In the order of the page. `quick`: coarser meshes, fewer steps; the cells keep their ids.
std::vector<PaperPart> paper_parts(bool quick);

// One a file.
PaperPart locking_proof_tetrahedra(bool quick);
PaperPart volume_preserving_skin(bool quick);
PaperPart stable_neo_hookean_flesh(bool quick);
// What they leave open.
PaperPart open_questions(bool quick);

// Parts of scenes that several papers need.
SceneDef paper_block(const char* name, const Vec3& size, std::array<int, 3> divisions, double young,
                     double poisson, double density = 1000);
DirichletDef paper_hold(const char* name, const char* surface, std::vector<Vec3> directions = {});
// Change of volume, smallest J and Newton iterations, by these names, added to the metrics.
void watch_volume(SceneDef& scene);
// A cell that runs the scene of a case in a formulation.
PaperCase paper_case(std::string id, std::string figure, std::string what, std::string_view formulation,
                     SceneDef scene, std::vector<ShownNumber> shown);
// The same without rows: the complete energy of the law on elements of this kind.
PaperCase one_field_case(std::string id, std::string figure, std::string what, std::string setting,
                         SceneDef scene, std::vector<ShownNumber> shown);

// Runs a motion step by step: "largest rise" of the total energy in a step over its whole change, "volume
// least" and "volume most" over the one at rest, "deflection most" of the first probe and "deflection" where
// the potential energy is least [m], "total energy" at the end over the one at the start.
Result<Numbers> motion(const SceneDef& scene, int threads);

}  // namespace isochor::studies
