#!/usr/bin/env bash
# Zones of exact volume on a cantilever under its weight: how stiff each choice makes it and what it costs. 16 x 4 x 4
# nodes, extended F-bar material. Prints a table; docs/effects/volume.md holds the output.
#
#   zoning.sh [ISOCHOR]      default: build/isochor
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
isochor=${1:-$root/build/isochor}
[[ -x $isochor ]] || { echo "zoning.sh: $isochor is not there; build it first" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# row LABEL POISSON VOLUMES [EXTRA]: EXTRA goes into the material.
row() {
  cat > "$work/beam.json" <<SCENE
{
  "name": "beam",
  "bodies": [{
    "name": "beam",
    "mesh": {"box": {"upper": [0.5, 0.1, 0.1], "divisions": [15, 3, 3]}},
    "element": "tet4",
    "materials": [{"law": "isochoric_extended", "young": 3e4, "poisson": $2 ${4:-}}]
  }],
  "volumes": [$3],
  "analysis": {"steps": 4},
  "dirichlet": [{"name": "wall", "where": {"surfaces": ["x0"]}}],
  "gravity": [0, 0, -9.81],
  "outputs": {"every": 0, "page": false},
  "probes": [{"name": "tip", "point": [0.5, 0.05, 0.05]}],
  "metrics": [
    {"name": "tip", "quantity": "displacement", "of": "tip", "component": "z"},
    {"name": "iterations", "quantity": "newton_iterations"},
    {"name": "smallest J", "quantity": "min_J"}
  ]
}
SCENE
  if ! "$isochor" run "$work/beam.json" --json --out "$work/run" > "$work/summary.json" 2> "$work/error.txt"; then
    echo "| $1 | not solved: $(head -c 200 "$work/error.txt" | tr '\n' ' ') | | |"
    return
  fi
  local value
  value() { tr -d ' \n' < "$work/summary.json" | sed "s/.*\"name\":\"$1\"[^}]*\"value\":\([-0-9.e+]*\).*/\1/"; }
  printf '| %s | %.4f | %d | %.3f |\n' "$1" "$(value tip)" "$(value iterations)" "$(value smallestJ)"
}

echo '| zones | tip [m] | iterations | smallest J |'
echo '|---|---|---|---|'
row 'whole body' 0.5 '{"space": "body"}'
row '4 rings' 0.4999 '{"space": "ring", "rings": 4}'
row '2 rings' 0.4999 '{"space": "ring", "rings": 2}'
row '1 ring' 0.4999 '{"space": "ring", "rings": 1}'
row 'whole body and penalty' 0.5 '{"space": "body"}' ', "compression_penalty": {"modulus": 2.5e5, "beta": 9}'
row 'every element' 0.495 '{"space": "none"}'
