// Runs Khronos' glTF validator: node validate.mjs FILE...
// One line a file; exit 1 when one of them has an error or a warning.
import { readFile } from 'node:fs/promises';
import { validateBytes } from 'gltf-validator';

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error('usage: node validate.mjs FILE...');
  process.exit(2);
}
let failed = 0;
for (const file of files) {
  const report = await validateBytes(new Uint8Array(await readFile(file)), { maxIssues: 1000 });
  const { numErrors, numWarnings, numInfos, messages } = report.issues;
  const { totalVertexCount, totalTriangleCount } = report.info;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos; ` +
              `${totalVertexCount} vertices, ${totalTriangleCount} triangles`);
  for (const m of messages)
    if (m.severity <= 1) console.log(`  ${m.code} at ${m.pointer}: ${m.message}`);
  if (numErrors + numWarnings > 0) ++failed;
}
console.log(`gltf-validator: ${files.length - failed} passed, ${failed} failed`);
process.exit(failed > 0 ? 1 : 0);
