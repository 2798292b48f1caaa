#!/usr/bin/env bash
# Makes the pictures of these pages again, from the samples. Needs what tests/run.sh installs.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

program=$(realpath "${1:-build/release/crosspatch}")
lira=samples/lira.obj tola=samples/tola.obj
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

(cd tests/gltf && npm ci --no-audit --no-fund --loglevel=error)
"$program" transfer $lira $tola --output "$scratch/tola.glb" --report "$scratch/report.html" --quiet
node tests/gltf/shoot.mjs "$scratch/report.html" "$scratch/page" 4ca6 1100x600
cp "$scratch/page_a.png" docs/features.png
node tests/gltf/shoot.mjs "$scratch/report.html" "$scratch/page" 6m 1100x600
cp "$scratch/page_m.png" docs/patches.png
"$program" map $lira $tola --output "$scratch/map.txt" --quiet
"$program" render $lira $tola --map "$scratch/map.txt" --texture checker --views side,quarter \
  --size 900x640 --output docs/checker.png --quiet
"$program" transfer $lira $tola --texture distortion --output "$scratch/distortion.glb" --quiet
"$program" render "$scratch/distortion.glb" --views side,quarter --size 900x320 \
  --output docs/distortion.png --quiet
"$(dirname "$program")/tools/benchmarks/benchmark_paper" --figure 10 --data "" --output "$scratch" >/dev/null
cp "$scratch/figure_10.png" docs/paper_constraints.png
"$(dirname "$program")/tools/benchmarks/benchmark_paper" --figure 11 --data "" --output "$scratch" >/dev/null
cp "$scratch/figure_11_connectivity.png" docs/paper_matrices_connectivity.png
cp "$scratch/figure_11_geodesic.png" docs/paper_matrices_geodesic.png
