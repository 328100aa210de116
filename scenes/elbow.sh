#!/usr/bin/env bash
# The elbow against Poisson's ratio, stable neo-Hookean beside corotated: what its volume does, the least J of a point of
# its cells, cells that turned over. Prints a table; elbow.md holds the output.
#
#   elbow.sh [ISOCHOR]      default: build/isochor
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
isochor=${1:-$root/build/isochor}
[[ -x $isochor ]] || { echo "elbow.sh: $isochor is not there; build it first" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# row NU LAW: change of volume, least J, inverted cells, Newton iterations of the last step's table
row() {
  "$isochor" run elbow --quiet --out "$work/run" --set outputs.every=0 --set outputs.page=false \
    --set "bodies[0].materials[0].poisson=$1" --set "bodies[0].materials[0].law=\"$2\"" > /dev/null 2> "$work/error.txt" ||
    { echo 'stopped | | |'; return; }
  awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i }
    NR > 1 { iterations += $at["iterations"]; last = $0 }
    END { split(last, v, ","); printf "%.2g | %.3f | %d | %d |", v[at["volume_change"]], v[at["min_J"]],
      v[at["inverted_cells"]], iterations }' "$work/run/steps.csv"
}

echo '| Poisson ratio | law | change of volume | least J | inverted | iterations |'
echo '|---|---|---|---|---|---|'
for nu in 0.3 0.45 0.49 0.4999 0.5; do
  for law in stable_neo_hookean corotated; do echo "| $nu | $law | $(row $nu $law)"; done
done
