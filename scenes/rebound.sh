#!/usr/bin/env bash
# Drops the ball of the scene ball_drop (10 cm, from 10 cm) on meshes, elements and time steps and prints how high its
# middle of mass comes back and how exactly volume is kept, as a table. Sheen, Larionov & Pai 2021, figures 10 and 11, drop
# balls of 64,000 and 4,700 tets.
#
#   rebound.sh [ISOCHOR] [quick]      default: build/isochor, all rows
#
# The fine ball (out/meshes/ball_fine.msh, from make_meshes.sh ball_fine) is taken where it is; with `quick` it is left
# out, and so are steps of 1 ms. rebound.md holds the output.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
isochor=$root/build/isochor
quick=
for argument in "$@"; do
  if [[ $argument == quick ]]; then quick=1; else isochor=$argument; fi
done
[[ -x $isochor ]] || { echo "rebound.sh: $isochor is not there; build it first" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# row MESH ELEMENT SCHEME STEP
row() {
  local code=0
  # It starts some steps above the floor, as fast as the fall so far has made it.
  local above speed duration
  read -r above speed duration <<< "$(awk -v h="$4" 'BEGIN { print 3 * h, sqrt(2 * 9.81 * (0.1 - 3 * h)), 0.05 + 5 * h }')"
  "$isochor" run ball_drop --quiet --out "$work/run" --budget 100000 --set "bodies[0].mesh.file=$1" \
    --set "bodies[0].element=$2" --set "bodies[0].velocity=[0,0,-$speed]" --set "contacts[0].obstacle.position=[0,0,$(awk -v a="$above" 'BEGIN { print -0.05 - a }')]" \
    --set "analysis.scheme=$3" --set "analysis.step=$4" --set analysis.duration=$duration --set outputs.every=0 \
    --set "metrics=[]" > "$work/log" 2>&1 || code=$?
  [[ $code == 0 ]] || { cat "$work/log" >&2; exit "$code"; }
  local elements
  elements=$(awk '/"elements":/ { gsub(/[^0-9]/, ""); print; exit }' "$work/run/summary.json")
  # The middle of mass moves by the scheme itself under gravity and the push of the floor; its mass is in the kinetic
  # energy before the impact.
  awk -F, -v above="$above" -v speed="$speed" -v element="$2" -v scheme="$3" -v h="$4" -v elements="$elements" '
    BEGIN { g = 9.81; v = -speed }
    NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
    $column["step"] == 0 { next }
    {
      steps++
      if (steps == 1) mass = 2 * $column["kinetic_energy_J"] / (v - h * g) ^ 2
      a = $column["floor.force_z_N"] / mass - g
      if (scheme == "bdf2" && steps > 1) {
        v_new = (4 * v - v_old + 2 * h * a) / 3
        z_new = (4 * z - z_old + 2 * h * v_new) / 3
      } else {
        v_new = v + h * a
        z_new = z + h * v_new
      }
      v_old = v; v = v_new; z_old = z; z = z_new
      if (z < lowest) lowest = z
      touching = $column["floor.normal_force_N"] > 1e-3 * mass * g
      if (touching) last = steps
      volume = $column["volume_row_residual"]
      if (volume < 0) volume = -volume
      if (volume > worst) worst = volume
      if (steps == 1 || $column["min_J"] < least) least = $column["min_J"]
      iterations += $column["iterations"]
      seconds += $column["seconds"]
    }
    END {
      rebound = touching ? "still touches" : sprintf("%.1f", 1000 * (z + v * v / (2 * g) + above))
      printf "| %s | %s | %s | %g | %.1f | %.0f | %s | %.0e | %.2f | %.1f | %.0f |\n", elements, element, scheme, 1000 * h,
             -1000 * (lowest + above), 1000 * h * last, rebound, worst, least, iterations / steps, seconds
    }' "$work/run/steps.csv"
}

printf '| tets | element | scheme | step [ms] | middle of mass sinks by [mm] | leaves after [ms] | rebound [mm] | left by volume rows | least J | iterations a step | wall time [s] |\n'
printf '|---|---|---|---|---|---|---|---|---|---|---|\n'
coarse=$root/scenes/meshes/ball.msh
fine=$root/out/meshes/ball_fine.msh
for step in 0.01 0.001; do
  [[ -z $quick || $step == 0.01 ]] || continue
  row "$coarse" tet4 bdf2 "$step"
  row "$coarse" tet4_edge_smoothed bdf2 "$step"
  [[ -n $quick || ! -e $fine ]] || row "$fine" tet4 bdf2 "$step"
  row "$coarse" tet4 implicit_euler "$step"
done
