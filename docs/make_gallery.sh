#!/usr/bin/env bash
# Makes a page of pictures from the data set in $CROSSPATCH_DATA, else ../shared/data:
#   docs/make_gallery.sh FOLDER [EVERY]    maps: every EVERY-th pair (default 10) of its list
#   docs/make_gallery.sh FOLDER textures   textures carried and baked, samples among them; the
#                                          figures are in results.csv too
# Bad results are shown like good ones. The meshes may not be redistributed, nor may the pictures.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

folder=${1:?the folder to write to}
what=${2:-10}
data=${CROSSPATCH_DATA:-../shared/data}
program=${PROGRAM:-build/release/crosspatch}
mkdir -p "$folder"
page=$folder/index.html
echo '<!doctype html><meta charset="utf-8"><title>crosspatch: gallery</title><h1>Gallery</h1>' >"$page"

escape() { sed 's/&/\&amp;/g; s/</\&lt;/g'; }

map_pictures() {
  [ -e "$data/pairs.csv" ] || { echo "no pairs in $data" >&2; exit 1; }
  tail -n +2 "$data/pairs.csv" | awk -F, -v every="$what" '(NR - 1) % every == 0 { print $1, $2, $3 }' |
    while read -r name source target; do
      code=0
      said=$("$program" map "$data/$source" "$data/$target" --output "$folder/$name.txt" \
        --report "$folder/$name.html" 2>&1 </dev/null | grep -aE '^map |warning|error' | escape) || code=$?
      echo "<h2>$name</h2><pre>$said</pre>" >>"$page"
      [ "$code" -eq 0 ] && [ -e "$folder/$name.txt" ] || continue
      "$program" render "$data/$source" "$data/$target" --map "$folder/$name.txt" --texture checker \
        --views front,side,quarter --size 900x600 --output "$folder/$name.png" --quiet
      echo "<a href='$name.html'><img src='$name.png' alt='$name'></a>" >>"$page"
    done
}

# carry NAME MODE COMMAND...: runs the command, which writes NAME_MODE.glb, and draws what came out.
carry() {
  local name=$1 mode=$2 glb=$folder/$1_$2.glb code=0 begun
  shift 2
  begun=$(date +%s.%N)
  "$@" --output "$glb" 2>"$folder/said.txt" || code=$?
  local seconds
  seconds=$(awk -v a="$begun" -v b="$(date +%s.%N)" 'BEGIN { printf "%.1f", b - a }')
  echo "$name,$mode,$code,$seconds,\"$(grep -aE 'warning|error|^transfer ' "$folder/said.txt" | tr '\n"' ' _')\"" |
    tee -a "$folder/results.csv"
  { echo "<h2>$name, $mode: exit code $code, $seconds s</h2><pre>"; escape <"$folder/said.txt"; echo "</pre>"; } >>"$page"
  [ -e "$glb" ] || return 0
  "$program" render "$glb" --views quarter,left,back,front --size 1100x800 --output "${glb%.glb}.png" --quiet
  echo "<img src='${name}_$mode.png' alt='$name $mode'>" >>"$page"
}

# textured NAME SOURCE TARGET [IMAGE [LANDMARKS]]: both modes over one map.
textured() {
  local name=$1 source=$2 target=$3 options=()
  if [ ! -e "$source" ] || [ ! -e "$target" ]; then
    echo "$name: skipped, not in $data"
    return
  fi
  [ -z "${4:-}" ] || options+=(--texture "$4")
  local steer=()
  [ -z "${5:-}" ] || steer+=(--landmarks "$5")
  "$program" map "$source" "$target" "${steer[@]}" --output "$folder/$name.txt" \
    --overlay "$folder/$name.overlay" --quiet || true
  carry "$name" keep "$program" transfer "$source" "$target" "${options[@]}" "${steer[@]}"
  [ -e "$folder/$name.overlay" ] || return 0
  carry "$name" bake "$program" transfer "$source" "$target" "${options[@]}" --map "$folder/$name.overlay" \
    --mode bake --size 1024
}

texture_pictures() {
  echo 'pair,mode,exit_code,seconds,said' >"$folder/results.csv"
  local own=$data/textured target
  for target in bodo tola lira; do
    [ $target = lira ] || textured lira_$target samples/lira.obj samples/$target.obj
    [ $target = bodo ] || textured bodo_$target samples/bodo.obj samples/$target.obj
  done
  for target in 381 383 385 387 393 399; do
    textured spot_$target "$own/spot.obj" "$data/shrec07/$target.off"
  done
  textured fox_383 "$own/Fox.glb" "$data/shrec07/383.off"
  textured hand_vulcan "$own/hand_plain.obj" "$own/hand_vulcan.obj" "$own/hand_plain_texture.png"
  textured blub_remeshed "$own/blub.obj" "$own/blub_remeshed_noUV.obj" "$own/blub_texture.png"
  textured blub_223 "$own/blub.obj" "$data/shrec07/223.off" "$own/blub_texture.png"
  textured spot_remeshed "$own/spot.obj" "$own/spot_remeshed_noUV.obj"
  rm -f "$folder/said.txt"
}

if [ "$what" = textures ]; then texture_pictures; else map_pictures; fi
echo "$page"
