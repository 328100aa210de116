#include "isochor/schemes.h"
#include "scenes/scene.h"

namespace isochor {

namespace {

SchemePtr dynamics(const AnalysisDef& a) {
  switch (a.scheme) {
    case SchemeWord::implicit_euler:
      return implicit_euler();
    case SchemeWord::bdf2:
      return bdf2();
    case SchemeWord::generalized_alpha:
      return generalized_alpha(a.spectral_radius);
    case SchemeWord::newmark:
      return newmark();
    case SchemeWord::implicit_midpoint:
      return implicit_midpoint();
  }
  return nullptr;
}

}  // namespace

SchemePtr make_scheme(const AnalysisDef& a) {
  if (a.type == AnalysisType::statics) return a.path_step ? continuation() : statics();
  return a.static_until ? static_until(*a.static_until, dynamics(a)) : dynamics(a);
}

}  // namespace isochor
