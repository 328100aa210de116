#!/usr/bin/env bash
# Makes the scenes' meshes from scenes/geometry with Gmsh (4.8, any later 4.x).
#
#   make_meshes.sh                       remake the committed meshes in place
#   make_meshes.sh [-o DIR] committed    the same, elsewhere
#   make_meshes.sh [-o DIR] fine         finer meshes, for convergence studies
#   make_meshes.sh [-o DIR] NAME...      only these, of either set
#
# Fine meshes go to out/meshes unless -o says otherwise. The same Gmsh on one
# kind of machine writes the same bytes again; another version may place nodes
# differently, so committed meshes are remade on purpose, not as part of a build.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
geometry=$here/geometry

# name | geometry | order | options (h is the target edge length in meters)
committed='
tube                        tube              1  h=0.00567
cushion                     cushion           1  h=0.0094
bubble                      bubble            1  h=0.0072
finger                      finger            1  h=0.0048
finger_small                finger            1  h=0.0059 chambers=4
finger_large                finger            1  h=0.0025
spine                       spine             1  h=0.0180
cantilever_1                cantilever        1  h=0.0525
cantilever_2                cantilever        1  h=0.0263
cantilever_3                cantilever        1  h=0.0135
cantilever_1_tet10          cantilever        2  h=0.0525
cantilever_2_tet10          cantilever        2  h=0.0357
cook3d_1                    cook3d            1  h=0.01306
cook3d_2                    cook3d            1  h=0.0049
cook3d_3                    cook3d            1  h=0.00272
cook3d_1_tet10              cook3d            2  h=0.01306
cook3d_2_tet10              cook3d            2  h=0.00689
cook_plane_1                cook_plane        1  h=0.0030
cook_plane_2                cook_plane        1  h=0.0022
cook_plane_tet10            cook_plane        2  h=0.0040
thick_tube                  thick_tube        1  h=0.0600
thick_tube_tet10            thick_tube        2  h=0.1100
thick_sphere                thick_sphere      1  h=0.1352
thick_sphere_tet10          thick_sphere      2  h=0.2500
torsion_cylinder            torsion_cylinder  1  h=0.1500
torsion_cylinder_tet10      torsion_cylinder  2  h=0.2772
puck                        puck              1  h=0.0072
arm                         arm               1  h=0.0125
ball                        ball              1  h=0.0080
ball_small                  ball              1  h=0.0190
indented_puck               indented_puck     1  h=0.0080
bellows                     bellows           1  h=0.0045
cushion_1                   cushion           1  h=0.0140
cushion_3                   cushion           1  h=0.0066
cushion_2_tet10             cushion           2  h=0.0085
cushion_3_tet10             cushion           2  h=0.0066
thick_tube_1                thick_tube        1  h=0.1200
thick_tube_1_tet10          thick_tube        2  h=0.2200
thick_sphere_1              thick_sphere      1  h=0.2500
thick_sphere_1_tet10        thick_sphere      2  h=0.4500
torsion_cylinder_1          torsion_cylinder  1  h=0.2800
torsion_cylinder_1_tet10    torsion_cylinder  2  h=0.5000
spine_1                     spine             1  h=0.0260
spine_3                     spine             1  h=0.0120
cook3d_1_hex                cook3d_hex        1  n=2
cook3d_2_hex                cook3d_hex        1  n=4
cook3d_3_hex                cook3d_hex        1  n=6
cook_plane_1_hex            cook3d_hex        1  n=4 thickness=0.001 layers=1
cook_plane_2_hex            cook3d_hex        1  n=8 thickness=0.001 layers=1
thick_tube_1_hex            thick_tube_hex    1  n=6
thick_tube_2_hex            thick_tube_hex    1  n=12
thick_sphere_1_hex          thick_sphere_hex  1  n=4
thick_sphere_2_hex          thick_sphere_hex  1  n=8
torsion_cylinder_1_hex      torsion_cylinder_hex 1  n=2
torsion_cylinder_2_hex      torsion_cylinder_hex 1  n=4
tube_hex                    tube_hex          1  n=3
cook3d_coarse_tet10         cook3d            2  h=0.020
cook_plane_grid_1           cook_plane_grid   1  nx=5 ny=5
cook_plane_grid_2           cook_plane_grid   1  nx=8 ny=8
thick_tube_coarse           thick_tube        1  h=0.4500
thick_tube_coarse_tet10     thick_tube        2  h=0.8000
thick_tube_coarse_hex       thick_tube_hex    1  n=3
thick_sphere_coarse         thick_sphere      1  h=0.5000
thick_sphere_coarse_tet10   thick_sphere      2  h=1.0000
thick_sphere_coarse_hex     thick_sphere_hex  1  n=3
torsion_cylinder_coarse     torsion_cylinder  1  h=0.4000
torsion_cylinder_coarse_tet10 torsion_cylinder 2 h=1.0000
'
fine='
tube_fine                   tube              1  h=0.0034
cushion_fine                cushion           1  h=0.00594
bubble_fine                 bubble            1  h=0.00436
finger_fine                 finger            1  h=0.00179
spine_fine                  spine             1  h=0.0090
cantilever_3_tet10          cantilever        2  h=0.0200
cantilever_4                cantilever        1  h=0.0095
cook3d_3_tet10              cook3d            2  h=0.0035
cook3d_4                    cook3d            1  h=0.0018
cook_plane_3                cook_plane        1  h=0.0010
thick_tube_fine             thick_tube        1  h=0.0300
thick_tube_tet10_fine       thick_tube        2  h=0.0550
thick_sphere_fine           thick_sphere      1  h=0.0800
thick_sphere_tet10_fine     thick_sphere      2  h=0.1300
torsion_cylinder_fine       torsion_cylinder  1  h=0.0900
torsion_cylinder_tet10_fine torsion_cylinder  2  h=0.1400
ball_middle                 ball              1  h=0.0054
ball_fine                   ball              1  h=0.0033
'

fail() {
  echo "make_meshes.sh: $*" >&2
  exit 1
}

target=
if [[ ${1:-} == -o ]]; then
  [[ $# -ge 2 ]] || fail "-o needs a folder"
  target=$2
  shift 2
fi
[[ $# -gt 0 ]] || set -- committed
command -v gmsh > /dev/null || fail "gmsh not found (Debian: apt-get install gmsh)"
version=$(gmsh --version 2>&1 | tail -n 1)
[[ $version == 4.8.* ]] ||
  echo "note: committed meshes were made with Gmsh 4.8.4, this is $version" >&2

# Paints two fields on the nodes of the arm, "upper" and "lower": 1 on one half of the skin between the ends, fading
# over 15 mm from one into the other and toward the ends, which stay without paint.
paint_arm() {
  awk '
    BEGIN { total = 0 }
    function ramp(v) { return v < 0 ? 0 : (v > 1 ? 1 : v) }
    $1 == "$Nodes" { inside = 1; getline; blocks = $1; next }
    $1 == "$EndNodes" { inside = 0 }
    inside {
      count = $4
      for (i = 0; i < count; i++) { getline; tag[i] = $1 }
      for (i = 0; i < count; i++) {
        getline
        middle = ramp(($1 - 0.03) / 0.015) * ramp((0.17 - $1) / 0.015)
        labels[total] = tag[i]
        upper[total] = middle * ramp(0.5 + ($2 + 0.0025) / 0.015)
        lower[total++] = middle * ramp(0.5 - ($2 - 0.0025) / 0.015)
      }
    }
    function field(name, values,   i) {
      printf "$NodeData\n1\n\"%s\"\n1\n0\n3\n0\n1\n%d\n", name, total
      for (i = 0; i < total; i++) printf "%d %.6g\n", labels[i], values[i]
      print "$EndNodeData"
    }
    END { field("upper", upper); field("lower", lower) }
  ' "$1" > "$1.paint"
  cat "$1.paint" >> "$1"
  rm "$1.paint"
}

# make FOLDER NAME GEOMETRY ORDER OPTION...
make() {
  local folder=$1 name=$2 geo=$3 order=$4 option log
  shift 4
  local arguments=()
  for option in "$@"; do
    arguments+=(-setnumber "${option%%=*}" "${option#*=}")
  done
  mkdir -p "$folder"
  log=$folder/$name.log
  if ! gmsh -3 -nt 1 -order "$order" "${arguments[@]}" -o "$folder/$name.msh" \
    "$geometry/$geo.geo" > "$log" 2>&1 || grep -q '^Error' "$log"; then
    fail "$name failed, see $log"
  fi
  rm "$log"
  [[ $geo != arm ]] || paint_arm "$folder/$name.msh"
  awk -v name="$name" '
    $1 == "$Nodes" { getline; nodes = $2 }
    $1 == "$Elements" { inside = 1; getline; next }
    inside && NF == 4 && ($3 == 4 || $3 == 5 || $3 == 11) && $1 == 3 { cells += $4; for (i = $4; i > 0; i--) getline; next }
    END { printf "%-28s %6d nodes %6d cells\n", name, nodes, cells }
  ' "$folder/$name.msh"
}

# Reads lines of a list and makes those asked for.
run() {
  local list=$1 folder=$2 only=${3:-} name rest
  local found=1
  while read -r name rest; do
    [[ -n $name ]] || continue
    [[ -z $only || $only == "$name" ]] || continue
    # Word splitting of the options is wanted.
    # shellcheck disable=SC2086
    make "$folder" "$name" $rest
    found=0
  done <<< "$list"
  return $found
}

for what in "$@"; do
  case $what in
    committed) run "$committed" "${target:-$here/meshes}" ;;
    fine) run "$fine" "${target:-$here/../out/meshes}" ;;
    *)
      run "$committed" "${target:-$here/meshes}" "$what" ||
        run "$fine" "${target:-$here/../out/meshes}" "$what" ||
        fail "no mesh is called '$what'"
      ;;
  esac
done
