#!/usr/bin/env bash
# Maps pairs of the data set and puts their pictures on one page: docs/make_gallery.sh FOLDER [EVERY]
# Takes every EVERY-th pair (default 10) of the list in $CROSSPATCH_DATA, else ../shared/data. Bad
# results are shown like good ones. The meshes may not be redistributed, nor may the pictures.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

folder=${1:?the folder to write to}
every=${2:-10}
data=${CROSSPATCH_DATA:-../shared/data}
program=build/release/crosspatch
[ -e "$data/pairs.csv" ] || { echo "no pairs in $data" >&2; exit 1; }
mkdir -p "$folder"
page=$folder/index.html
echo '<!doctype html><meta charset="utf-8"><title>crosspatch: gallery</title><h1>Gallery</h1>' >"$page"
tail -n +2 "$data/pairs.csv" | awk -F, -v every="$every" '(NR - 1) % every == 0 { print $1, $2, $3 }' |
  while read -r name source target; do
    code=0
    said=$("$program" map "$data/$source" "$data/$target" --output "$folder/$name.txt" \
      --report "$folder/$name.html" 2>&1 </dev/null | grep -aE '^map |warning|error' |
      sed 's/&/\&amp;/g; s/</\&lt;/g') || code=$?
    echo "<h2>$name</h2><pre>$said</pre>" >>"$page"
    [ "$code" -eq 0 ] && [ -e "$folder/$name.txt" ] || continue
    "$program" render "$data/$source" "$data/$target" --map "$folder/$name.txt" --texture checker \
      --views front,side,quarter --size 900x600 --output "$folder/$name.png" --quiet
    echo "<a href='$name.html'><img src='$name.png' alt='$name'></a>" >>"$page"
  done
echo "$page"
