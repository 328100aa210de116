#!/usr/bin/env bash
# A sample of the tests under the address, undefined-behavior and thread sanitizers:
#   asan   all of isochor_sample_tests (tests/CMakeLists.txt says what is in it), at -O0: at -O1 the checks take two to
#          three times as long to compile, which is most of it
#   tsan   those of its tests that step worlds on threads of their own: oneTBB is not compiled with the sanitizer, so
#          what it synchronizes would look like races
#   calls  the C library, all of it instrumented for addresses and undefined behavior, under 10,000 sequences of random
#          calls (tests/c/random_calls.c); not in CI
# Arguments choose: cmake/sanitizers.sh [asan] [tsan] [calls]
set -euo pipefail
cd "$(dirname "$0")/.."

which=("$@")
[[ ${#which[@]} -eq 0 ]] && which=(asan tsan)
for preset in "${which[@]}"; do
  if [[ $preset == calls ]]; then
    cmake --preset asan -DISOCHOR_TESTS=ON -DISOCHOR_APPS=ON >/dev/null
    ASAN_OPTIONS=detect_leaks=1 UBSAN_OPTIONS=print_stacktrace=1 cmake --build build-asan --target c_calls
    continue
  fi
  optimization=-O1
  [[ $preset == asan ]] && optimization=-O0
  cmake --preset "$preset" -B "build-$preset-sample" -DISOCHOR_TESTS=ON -DISOCHOR_APPS=OFF \
    -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="$optimization -g1" >/dev/null
  cmake --build "build-$preset-sample" --target isochor_sample_tests
  echo "$preset"
  if [[ $preset == tsan ]]; then
    TSAN_OPTIONS=halt_on_error=1 "build-$preset-sample/tests/isochor_sample_tests" --filenames-as-tags "[#host_services]"
  else
    ASAN_OPTIONS=detect_leaks=1 UBSAN_OPTIONS=print_stacktrace=1 "build-$preset-sample/tests/isochor_sample_tests"
  fi
done
