#!/usr/bin/env bash
# Errors that are estimated, asked for and priced, held against references and clocks. Prints the tables of
# docs/studies.md, "What an answer is worth" and after.
#
#   errors.sh [ISOCHOR]      default: build/isochor; minutes
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
isochor=${1:-$root/build/isochor}
[[ -x $isochor ]] || { echo "errors.sh: $isochor is not there; build it first" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# summary NAME ARGUMENTS: a run into $work/NAME, without frames; what it prints goes nowhere.
summary() {
  local name=$1
  shift
  "$isochor" run "$@" --quiet --out "$work/$name" --set outputs.every=0 > /dev/null 2> "$work/error.txt" || true
}

# show NAME FILTER: what a summary says.
show() { python3 -c "
import json, sys
j = json.load(open('$work/$1/summary.json'))
$2"; }

mesh() { echo "bodies[0].mesh.file=\"$root/scenes/meshes/$1.msh\""; }

echo '| scene | element, mesh | indicator | true error | over it |'
echo '|---|---|---|---|---|'
# effectivity SCENE ELEMENT MESH METRIC
effectivity() {
  summary run "$1" --accuracy --set "bodies[0].element=$2" --set "$(mesh "$3")"
  show run "
m = [m for m in j['metrics'] if m['name'] == '$4'][0]
i = [i for i in j['accuracy']['indicators'] if i['name'] == '$4']
if i:
  e, t = 100 * i[0]['relative'], 100 * abs(m['value'] / m['reference'] - 1)
  print(f'| {j[\"scene\"]} | $2, $3 | {e:.2g} % | {t:.2g} % | {e / t:.2g} |')
else:
  print(f'| {j[\"scene\"]} | $2, $3 | none | | {j[\"accuracy\"][\"reason\"]} |')"
}
effectivity cook tet4 cook3d_1 'corner up'
effectivity cook tet4_edge_smoothed cook3d_1 'corner up'
effectivity cook tet4_edge_smoothed cook3d_2 'corner up'
effectivity cook tet10 cook3d_coarse_tet10 'corner up'
effectivity cook tet10 cook3d_1_tet10 'corner up'
effectivity cook hex8 cook3d_1_hex 'corner up'
effectivity cook_plane hex8 cook_plane_1_hex 'corner up'
effectivity thick_tube hex8 thick_tube_coarse_hex 'inner radius grows by'
effectivity thick_tube tet10 thick_tube_coarse_tet10 'inner radius grows by'
effectivity thick_sphere tet4_edge_smoothed thick_sphere_coarse 'inner radius grows by'
effectivity thick_sphere tet10 thick_sphere_coarse_tet10 'inner radius grows by'
effectivity thick_sphere hex8 thick_sphere_coarse_hex 'inner radius grows by'
effectivity torsion tet4_edge_smoothed torsion_cylinder_1 'torque'
effectivity torsion tet10 torsion_cylinder_coarse_tet10 'torque'
effectivity torsion hex8 torsion_cylinder_1_hex 'torque'

echo
echo '| scene, mesh | asked | ended | found | runs | seconds | indicator | true error |'
echo '|---|---|---|---|---|---|---|---|'
# asked SCENE MESH ERROR
asked() {
  summary run "$1" --error "$3" --budget 120 --set bodies[0].element=tet4_edge_smoothed ${2:+--set "$(mesh "$2")"}
  show run "
a = j['accuracy']
t = max(abs(m['value'] / m['reference'] - 1) for m in j['metrics'] if m.get('reference'))
best = [t for t in a['trials'] if t.get('indicator') is not None and t['unknowns'] == j['unknowns']['displacement'] + j['unknowns']['multipliers']]
i = min((t['indicator'] for t in best), default=float('nan'))
found = [t['setting'] for t in best if t['indicator'] == i]
print(f'| {j[\"scene\"]} $2 | $3 | {a[\"search\"].replace(\"_\", \" \")} | {found[0] if found else \"\"} | {len(a[\"trials\"])} | {a[\"search_wall_s\"]:.2g} | {100*i:.2g} % | {100*t:.2g} % |')"
}
for error in 3% 1%; do
  asked cantilever_tenth '' $error
  asked cantilever '' $error
  asked cook cook3d_1 $error
  asked cook_plane cook_plane_grid_1 $error
  asked thick_tube thick_tube_coarse $error
  asked thick_sphere thick_sphere_coarse $error
  asked torsion torsion_cylinder_1 $error
done

echo
echo '| scene | largest step of its search | unknowns | seconds predicted | measured | ratio |'
echo '|---|---|---|---|---|---|'
# predicted SCENE: the most expensive run of a search that had something to be predicted from
predicted() {
  summary run "$1" --error 1% --budget 40
  [[ -f $work/run/summary.json ]] || return 0
  show run "
t = [t for t in j['accuracy'].get('trials', []) if t['predicted_s'] > 0 and t['status'] == 'converged']
if t:
  t = max(t, key=lambda t: t['wall_s'])
  print(f'| $1 | {t[\"setting\"]} | {t[\"unknowns\"]} | {t[\"predicted_s\"]:.2g} | {t[\"wall_s\"]:.2g} | {t[\"predicted_s\"] / t[\"wall_s\"]:.2g} |')"
}
for scene in cantilever cook_plane thick_tube thick_sphere torsion tube spine finger bellows cushion bubble puck ball_drop \
  squeezed_block gas_tube cable_finger indented_puck; do
  rm -rf "$work/run"
  predicted $scene
done
