// Random numbers for scenes: the same sequence, and the same scene, on every machine. No function of the
// standard library whose result an implementation may choose is used; sources that include this are compiled
// without fused multiply-add.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "isochor/types.h"

namespace isochor::studies {

class ChaosRandom {
 public:
  // One sequence a seed and topic, so that a part of a scene does not depend on what another one drew.
  ChaosRandom(std::uint64_t seed, std::string_view topic) : state_(seed * 0x9e3779b97f4a7c15ull) {
    for (const char c : topic) state_ = (state_ ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
    bits();
  }

  // Splitmix64 (Steele, Lea & Flood 2014).
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  // In [0, 1), a multiple of 2^-53.
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  bool chance(double probability) { return unit() < probability; }
  // From low to high, both included.
  int whole(int low, int high) {
    return low + static_cast<int>(bits() % static_cast<std::uint64_t>(high - low + 1));
  }
  // Three digits and a power of ten from 10^low to below 10^high: loads and sizes over decades.
  double decades(int low, int high) {
    double value = 0.01 * whole(100, 999);
    const int exponent = whole(low, high - 1);
    for (int k = 0; k < exponent; ++k) value *= 10;
    for (int k = 0; k > exponent; --k) value /= 10;
    return value;
  }
  template <class T>
  T pick(std::initializer_list<T> choices) {
    return choices.begin()[static_cast<std::size_t>(whole(0, static_cast<int>(choices.size()) - 1))];
  }
  template <class T>
  const T& pick(const std::vector<T>& choices) {
    return choices[static_cast<std::size_t>(whole(0, static_cast<int>(choices.size()) - 1))];
  }
  // A direction of unit length to rounding.
  Vec3 direction();

 private:
  std::uint64_t state_;
};

}  // namespace isochor::studies
