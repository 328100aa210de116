// What pools of contact between surfaces share: their settings, and the memory of what each point is paired
// with.
#pragma once

#include <memory>

#include "constraints/contact/contact_effect.h"
#include "constraints/contact/friction/friction_law.h"
#include "isochor/effects/contact.h"

namespace isochor {

// What pools that replace each other share.
struct PairSetup {
  std::string name;
  double offset = 0;  // [m]
  FrictionLaw friction;
  std::vector<double> stick;  // by stencil: stiffness of friction that sticks [N/m]
  double open = 1;            // gap of stencils without a pair [m]
  bool coupled = false;
};

// Pairs are renewed, and remembered whether anything rubs or not.
inline StencilFacets with_pairs(StencilFacets f, const RememberingStencils& remembering,
                                const RenewedStencils& renewed) {
  f.remembering = &remembering;
  f.renewed = &renewed;
  return f;
}

// Rows of stencils that stand for the areas given [m^2], and the settings of their pools. `size`: of a face
// [m].
std::shared_ptr<ContactRows> pair_rows(const Builder& builder, const SurfaceContactDef& def, std::string name,
                                       const ContactLayer& layer, std::span<const double> area, double size,
                                       PairSetup& setup);

// By stencil the triangle or edge that it is paired with, or -1, from the first of each `per` numbers of
// memory: one more, or -1. Zeros are a memory in which no step was accepted, which is not one without pairs.
std::vector<Index> pairs_in_memory(std::span<const double> memory, int per);
void keep_pairs(std::span<const Index> pairs, int per, std::span<double> memory);
// The same for memory that comes from a file, where only numbers below `choices` make sense. `what`: triangle
// or edge.
Result<std::vector<Index>> checked_pairs(std::span<const double> memory, int per, Index choices,
                                         const std::string& name, const char* what);

// The pool with the pairs that are there at rest.
template <class Pool>
std::shared_ptr<const Pool> first_pairs(const Builder& builder, Pool unpaired) {
  const std::vector<double> nothing(static_cast<std::size_t>(unpaired.memory()), 0);
  Renewal start = unpaired.renewed({nothing, builder.rest(), builder.rest(), false, nullptr});
  if (start.pool) return std::static_pointer_cast<const Pool>(std::move(start.pool));
  return std::make_shared<const Pool>(std::move(unpaired));
}

}  // namespace isochor
