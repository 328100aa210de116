#!/usr/bin/env bash
# Runs the robots, which have no closed form, on several elements and meshes and prints tables of their metrics.
#
#   convergence.sh [ISOCHOR] [SCENE...]      default: build/isochor, all robots
#
# Finer meshes (out/meshes, from make_meshes.sh fine) are used where they are. convergence.md holds the output.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
isochor=${1:-$root/build/isochor}
[[ $# -gt 0 ]] && shift
[[ $# -gt 0 ]] || set -- tube cushion bubble finger spine
[[ -x $isochor ]] || { echo "convergence.sh: $isochor is not there; build it first" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# row SCENE MESH ELEMENT: elements, unknowns, iterations and metrics of a run as a line of a table
row() {
  local code=0
  "$isochor" run "$1" --json --out "$work/run" --budget 600 --set "bodies[0].mesh.file=$2" \
    --set "bodies[0].element=$3" --set outputs.every=0 > "$work/summary.json" 2> /dev/null || code=$?
  awk -v mesh="$(basename "$2" .msh)" -v element="$3" -v code="$code" '
    function number(line) { sub(/.*: /, "", line); sub(/,$/, "", line); return line }
    /"displacement":/ { unknowns = number($0) }
    /"multipliers":/ { rows = number($0) }
    /"elements":/ { elements = number($0) }
    /"newton_iterations":/ { iterations = number($0) }
    /"metrics":/ { inside = 1 }
    inside && /"value":/ { values = values sprintf(" %.5g |", number($0)) }
    END {
      if (code != 0) iterations = iterations " (exit " code ")"
      printf "| %s | %s | %s | %s + %s | %s |%s\n", mesh, element, elements, unknowns, rows, iterations, values
    }' "$work/summary.json"
}

for scene in "$@"; do
  printf '\n## %s\n\n| mesh | element | elements | unknowns | iterations |' "$scene"
  metrics=$("$isochor" show "$scene" | awk '/"metrics"/ { inside = 1 } inside' |
    grep -o '"name": "[^"]*"' | sed 's/.*: "\(.*\)"/\1/')
  rule='|---|---|---|---|---|'
  while read -r metric; do
    printf ' %s |' "$metric"
    rule+='---|'
  done <<< "$metrics"
  printf '\n%s\n' "$rule"
  committed=$root/scenes/meshes
  row "$scene" "$committed/$scene.msh" tet4
  row "$scene" "$committed/$scene.msh" tet4_edge_smoothed
  row "$scene" "$committed/$scene.msh" tet10
  for finer in "$committed/${scene}_large.msh" "$root/out/meshes/${scene}_fine.msh"; do
    if [[ -e $finer ]]; then row "$scene" "$finer" tet4_edge_smoothed; fi
  done
done
