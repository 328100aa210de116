#!/bin/sh
# Remakes what is made from the keys of scene files: scenes/scene.schema.json and the tables of docs/scenes.md.
# Usage: scenes/make_keys.sh [path of isochor]
set -eu
cd "$(dirname "$0")/.."
isochor=${1:-build/isochor}
"$isochor" keys --schema > scenes/scene.schema.json.tmp
mv scenes/scene.schema.json.tmp scenes/scene.schema.json
{
  sed '/<!-- keys: made by/q' docs/scenes.md
  "$isochor" keys --tables
  sed -n '/<!-- end of keys -->/,$p' docs/scenes.md
} > docs/scenes.md.tmp
mv docs/scenes.md.tmp docs/scenes.md
