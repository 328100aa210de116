#include "engine/step/allowance.h"

namespace isochor {

SaddleOptions saddle_options(const WorldOptions& options, const Allowance& allowance) {
  SaddleOptions saddle;
  saddle.max_iterations = allowance.iterations;
  if (allowance.keep_unfinished) saddle.budget = allowance.iterations;
  saddle.max_factorizations = allowance.factorizations;
  saddle.patient_iterations =
      allowance.patient_iterations > 0 ? allowance.patient_iterations : allowance.iterations;
  saddle.patient_factorizations =
      allowance.patient_factorizations > 0 ? allowance.patient_factorizations : allowance.factorizations;
  saddle.definiteness = options.definiteness;
  saddle.force_tolerance = options.force_tolerance;
  saddle.row_tolerance = options.row_tolerance;
  return saddle;
}

}  // namespace isochor
