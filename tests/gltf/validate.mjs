// Runs Khronos' glTF validator: node validate.mjs [--copied IMAGE]... FILE.glb...
// One line a file; exit 1 when one of them has an error or a warning. A warning of the features of
// an image that is one of the given ones, byte for byte, is its author's: printed, not counted.
import { readFile } from 'node:fs/promises';
import { parseArgs } from 'node:util';
import { validateBytes } from 'gltf-validator';

const { values, positionals: files } = parseArgs({
  allowPositionals: true, options: { copied: { type: 'string', multiple: true, default: [] } }
});
if (files.length === 0) {
  console.error('usage: node validate.mjs [--copied IMAGE]... FILE.glb...');
  process.exit(2);
}
const copied = await Promise.all(values.copied.map((image) => readFile(image)));

// The bytes of image i of a GLB.
function imageBytes(glb, i) {
  const jsonBytes = glb.readUInt32LE(12);
  const gltf = JSON.parse(glb.toString('utf8', 20, 20 + jsonBytes));
  const view = gltf.bufferViews[gltf.images[i].bufferView];
  const start = 20 + jsonBytes + 8 + (view.byteOffset ?? 0);
  return glb.subarray(start, start + view.byteLength);
}

function isOurs(message, glb) {
  const image = /^\/images\/(\d+)$/.exec(message.pointer);
  if (message.code !== 'IMAGE_FEATURES_UNSUPPORTED' || !image) return true;
  return !copied.some((bytes) => bytes.equals(imageBytes(glb, Number(image[1]))));
}

let failed = 0;
for (const file of files) {
  const glb = await readFile(file);
  const report = await validateBytes(new Uint8Array(glb), { maxIssues: 1000 });
  const { numErrors, numWarnings, numInfos, messages } = report.issues;
  const { totalVertexCount, totalTriangleCount } = report.info;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos; ` +
              `${totalVertexCount} vertices, ${totalTriangleCount} triangles`);
  const bad = messages.filter((m) => m.severity <= 1);
  for (const m of bad)
    console.log(`  ${m.code} at ${m.pointer}: ${m.message}${isOurs(m, glb) ? '' : ' (as in the copied image)'}`);
  if (bad.some((m) => isOurs(m, glb))) ++failed;
}
console.log(`gltf-validator: ${files.length - failed} passed, ${failed} failed`);
process.exit(failed > 0 ? 1 : 0);
