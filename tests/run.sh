#!/usr/bin/env bash
# Builds the program and passes every test: unit and data tests, then outside readers of what we
# write (a judge of seams, Khronos' glTF validator, three.js and model-viewer in headless Chromium,
# Blender), and the report's page.
# Data tests use $CROSSPATCH_DATA, else ../shared/data where that exists, and are skipped otherwise.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/install_dependencies.sh build test
if command -v ccache >/dev/null && [ -z "${CMAKE_CXX_COMPILER_LAUNCHER:-}" ]; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi
cmake --preset dev
cmake --build --preset dev --parallel "$(nproc)"
ctest --preset dev

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
(cd tests/gltf && npm ci --no-audit --no-fund --loglevel=error)
build/dev/tests/write_gltf_examples "$scratch"
program=build/dev/crosspatch
tests/gltf/keep.sh "$program" "$scratch"
"$program" transfer samples/lira.obj samples/tola.obj --map "$scratch/lira_tola.overlay" \
  --mode bake --size 512 --output "$scratch/baked.glb" --quiet
# A box of letters onto itself, and onto itself without texture coordinates.
sed '/^vt/d; /^mtllib/d; /^usemtl/d; s#/[0-9]*##g' samples/letters.obj >"$scratch/plain.obj"
seq 0 "$(($(grep -c '^v ' samples/letters.obj) - 1))" >"$scratch/identity.txt"
letters() {
  "$program" transfer samples/letters.obj "$1" --map "$scratch/identity.txt" --quiet \
    --output "$scratch/letters_$2.glb" "${@:3}"
}
letters samples/letters.obj keep
letters samples/letters.obj baked --mode bake --size 512
letters "$scratch/plain.obj" atlas --mode bake --size 512
copied=()
spot_image=${CROSSPATCH_DATA:-../shared/data}/textured/spot_texture.png
[ ! -e "$spot_image" ] || copied=(--copied "$spot_image")
node tests/gltf/validate.mjs "${copied[@]}" "$scratch"/*.glb
node tests/gltf/view.mjs "$scratch" "$scratch"/*.glb
node tests/gltf/view.mjs --letters samples/letters.png "$scratch" "$scratch"/letters_*.glb
blender -b --factory-startup --python-exit-code 1 --python tests/gltf/blender.py -- \
  samples/letters.png "$scratch" "$scratch"/*.glb >"$scratch/blender.log" || { cat "$scratch/blender.log"; exit 1; }
grep -a '^blender: ' "$scratch/blender.log"
node tests/gltf/report.mjs "$program" samples/lira.obj samples/tola.obj "$scratch"
echo "all tests passed"
