#!/usr/bin/env bash
# Tip of the cantilever under a tenth of gravity against Poisson's ratio: mixed forms beside the one-field element, which
# locks. kappa = K as in the references. Prints a table; locking.md holds the output.
#
#   locking.sh [ISOCHOR]      default: build/isochor
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
isochor=${1:-$root/build/isochor}
[[ -x $isochor ]] || { echo "locking.sh: $isochor is not there; build it first" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# tip NU ELEMENT SPACE: vertical displacement of the tip [m]
tip() {
  "$isochor" run cantilever_tenth --json --out "$work/run" --set outputs.every=0 --set "bodies[0].element=$2" \
    --set "bodies[0].materials[0].poisson=$1" --set 'bodies[0].materials[0].bulk_choice="bulk_modulus"' \
    --set "volumes=[{\"space\":\"$3\"}]" > "$work/summary.json" 2> "$work/error.txt" || { echo refused; return; }
  awk '/"probes":/ { inside = 1 } inside' "$work/summary.json" | tr -d ' \n' |
    sed 's/.*"tip":\[\([^]]*\)\].*/\1/' | awk -F, '{ printf "%.4f", $2 }'
}

echo '| Poisson ratio | edge-smoothed, nodal pressure | Tet4, nodal pressure | Tet4, one field | reference |'
echo '|---|---|---|---|---|'
for nu in 0.3 0.45 0.49 0.499 0.4999 0.5; do
  case $nu in 0.3) reference=-0.4707 ;; 0.49) reference=-0.4767 ;; 0.5) reference=-0.4763 ;; *) reference= ;; esac
  echo "| $nu | $(tip $nu tet4_edge_smoothed node) | $(tip $nu tet4 node) | $(tip $nu tet4 none) | $reference |"
done
