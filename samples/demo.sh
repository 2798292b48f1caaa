#!/usr/bin/env bash
# Builds the program and runs its main job on the samples: lira's coat goes to tola.
# Another pair: samples/demo.sh SOURCE TARGET
set -euo pipefail
source_mesh=$(realpath "${1:-$(dirname "${BASH_SOURCE[0]}")/lira.obj}")
target_mesh=$(realpath "${2:-$(dirname "${BASH_SOURCE[0]}")/tola.obj}")
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/install_dependencies.sh build demo
cmake --preset release >/dev/null
cmake --build --preset release --parallel "$(nproc)" --target crosspatch

program=build/release/crosspatch
out=build/demo
mkdir -p "$out"
name="$(basename "${source_mesh%.*}")_on_$(basename "${target_mesh%.*}")"
"$program" transfer "$source_mesh" "$target_mesh" --output "$out/$name.glb" \
  --json "$out/$name.json" --report "$out/$name.html"
"$program" render "$out/$name.glb" --output "$out/$name.png" --quiet

echo
echo "textured mesh: $PWD/$out/$name.glb"
echo "picture:       $PWD/$out/$name.png"
echo "page:          $PWD/$out/$name.html"
echo "report:        $PWD/$out/$name.json"

jq -r --arg name "$name" '
  def count($i; $k): .inputs[$i].counts[$k] // "?";
  def quality($k): .quality[$k] // "?";
  def percent($x): if ($x | type) == "number" then "\($x * 1000 | round / 10) %" else $x end;
  def rounded($x): if ($x | type) == "number" then ($x * 100 | round / 100) else $x end;
  "\($name): a coat of \(count(0; "mesh_triangles")) triangles went to a surface of " +
  "\(count(1; "mesh_triangles")) in \(rounded(.seconds)) s and \(.peak_memory_mib | round) MiB, " +
  "without landmarks. \(percent(quality("coverage"))) of the target is covered; cutting it along " +
  "\(quality("seam_cuts")) sides of carried seams made \(quality("triangles")) triangles, whose UVs " +
  "are within \(rounded(quality("max_uv_error_texels"))) texel of the exact map. " +
  "Flipped triangles: \(quality("flipped_triangles")). Warnings: \(.warnings | length)."
' "$out/$name.json"
