#!/usr/bin/env bash
# Runs clang-tidy (.clang-tidy) on files; without arguments on a sample: one or two files a room, those that parse fast.
# Needs the folder build/ of the preset "release". Where clang-tidy is missing it is installed in CI (CI is set), and
# left out with a word elsewhere.
set -euo pipefail
cd "$(dirname "$0")/.."

tidy=$(command -v clang-tidy-14 || command -v clang-tidy || true)
if [[ -z "$tidy" && -n "${CI:-}" ]]; then
  as_root=()
  [[ $(id -u) -eq 0 ]] || as_root=(sudo)
  "${as_root[@]}" apt-get update -qq
  DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends clang-tidy-14 >/dev/null
  tidy=clang-tidy-14
fi
if [[ -z "$tidy" ]]; then
  echo "clang-tidy: skipped, it is not installed (Debian: apt-get install clang-tidy-14)"
  exit 0
fi

files=("$@")
if [[ ${#files[@]} -eq 0 ]]; then
  files=(engine/base/parallel.cpp engine/mesh/words.cpp engine/mesh/check/check_boundary.cpp engine/mesh/read/read_tetgen.cpp
    engine/solvers/ordering.cpp engine/scene/ids.cpp engine/scene/builder.cpp engine/elements/reference_element.cpp
    integrators/schemes.cpp constraints/line/cable.cpp constraints/load/loads.cpp materials/mooney_rivlin.cpp
    examples/extension/tendon.cpp)
fi
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -I{} "$tidy" --quiet {} -- -std=c++20 -w -I. -Iinclude -Ibuild/include \
  -isystem /usr/include/eigen3 -march=native
echo "clang-tidy: ${#files[@]} files, nothing found"
