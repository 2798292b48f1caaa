// node refine.mjs MESH OUT.obj: cuts every triangle into four at the middles of its sides. Vertices
// keep their numbers, the surface stays as it is, texture coordinates are left out.
import { writeFileSync } from 'node:fs';
import { mix } from './geometry.mjs';
import { readMesh } from './mesh_files.mjs';

const { places, triangles } = readMesh(process.argv[2]);
const middles = new Map();
function middle(a, b) {
  const side = a < b ? `${a} ${b}` : `${b} ${a}`;
  if (!middles.has(side)) middles.set(side, places.push(mix([0.5, 0.5], [places[a], places[b]])) - 1);
  return middles.get(side);
}
const finer = triangles.flatMap(([a, b, c]) => {
  const [x, y, z] = [middle(a, b), middle(b, c), middle(c, a)];
  return [[a, x, z], [b, y, x], [c, z, y], [x, y, z]];
});
writeFileSync(process.argv[3], places.map((p) => `v ${p.join(' ')}\n`).join('') +
                               finer.map((t) => `f ${t.map((v) => v + 1).join(' ')}\n`).join(''));
