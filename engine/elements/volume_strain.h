// What volume rows measure, as functions of J.
#pragma once

#include "isochor/choices.h"

namespace isochor {

struct VolumeResponse {
  double value, first, second;  // Phi and its derivatives with respect to J
};

// `j_minus_1`: J - 1 with all its digits. Minus infinity where a logarithm has no value. `strain` is not
// by_law; a strain of the mean is the function of it.
VolumeResponse volume_response(VolumeStrain strain, double j_minus_1);

// Taken of the mean of J over a cell, not point by point.
constexpr bool is_of_mean(VolumeStrain strain) {
  return strain == VolumeStrain::mean_logarithmic || strain == VolumeStrain::mean_mixed;
}

// It has no value for J <= 0.
constexpr bool has_logarithm(VolumeStrain strain) {
  return strain != VolumeStrain::linear;
}

}  // namespace isochor
