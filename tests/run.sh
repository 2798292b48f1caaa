#!/usr/bin/env bash
# Builds the program and passes every test: unit and data tests, then outside readers of what we
# write (Khronos' glTF validator, three.js in headless Chromium), and the report's page.
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
build/dev/crosspatch transfer samples/lira.obj samples/tola.obj --output "$scratch/tola.glb" --quiet
build/dev/crosspatch transfer samples/lira.obj samples/tola.obj --mode bake --size 512 \
  --output "$scratch/baked.glb" --quiet
node tests/gltf/validate.mjs "$scratch"/*.glb
for name in everything tola baked; do
  node tests/gltf/view.mjs "$scratch/$name.glb" "$scratch/$name.png"
done
node tests/gltf/report.mjs build/dev/crosspatch samples/lira.obj samples/tola.obj "$scratch"
echo "all tests passed"
