#!/usr/bin/env bash
# tests/gltf/keep.sh PROGRAM FOLDER: textures kept over pairs of samples, and over some pairs of
# $CROSSPATCH_DATA, else ../shared/data, where that exists; each GLB is judged by keep.mjs.
# Leaves FOLDER/NAME.overlay and FOLDER/NAME.glb.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

program=$1 folder=$2
data=${CROSSPATCH_DATA:-../shared/data}

# keep NAME SOURCE TARGET [IMAGE]
keep() {
  local out=$folder/$1 image=${4:-}
  if [ ! -e "$2" ] || [ ! -e "$3" ]; then
    echo "keep: $1 skipped, not in $data"
    return
  fi
  "$program" map "$2" "$3" --output "$out.txt" --overlay "$out.overlay" --quiet
  "$program" transfer "$2" "$3" --map "$out.overlay" ${image:+--texture "$image"} --output "$out.glb" --quiet
  node tests/gltf/keep.mjs "$2" "$3" "$out.overlay" "$out.glb" ${image:+--texture "$image"}
}

keep letters samples/letters.obj samples/letters.obj
rm "$folder/letters.glb"  # turned: its letters stand on other sides
keep lira_tola samples/lira.obj samples/tola.obj
node tests/gltf/keep_test.mjs samples/lira.obj samples/tola.obj "$folder/lira_tola.overlay" "$folder/lira_tola.glb"
keep bodo_lira samples/bodo.obj samples/lira.obj

# The same surface, finer, by the map that leaves every point where it is.
node tests/gltf/refine.mjs samples/lira.obj "$folder/finer.obj"
seq 0 "$(($(grep -c '^v ' samples/lira.obj) - 1))" >"$folder/in_place.txt"
"$program" transfer samples/lira.obj "$folder/finer.obj" --map "$folder/in_place.txt" --output "$folder/finer.glb" --quiet
node tests/gltf/same_surface.mjs samples/lira.obj "$folder/finer.glb" 20000

keep spot_remeshed "$data/textured/spot.obj" "$data/textured/spot_remeshed_noUV.obj"
keep spot_399 "$data/textured/spot.obj" "$data/shrec07/399.off"
keep fox_383 "$data/textured/Fox.glb" "$data/shrec07/383.off"
keep blub_223 "$data/textured/blub.obj" "$data/shrec07/223.off" "$data/textured/blub_texture.png"
keep hand_vulcan "$data/textured/hand_plain.obj" "$data/textured/hand_vulcan.obj" "$data/textured/hand_plain_texture.png"
