// How far the texture has slipped where source and target are one surface in two tessellations:
//   node same_surface.mjs SOURCE OUT.glb [POINTS]
// Takes points at random on the written mesh, evenly by area, and compares their texture
// coordinates with those of the nearest point of the source, in texels of an image of 2048. Exit 1
// when less than 99.9 % of them are within half a texel.
import { Grid, cross, mix, norm, sub } from './geometry.mjs';
import { readMesh } from './mesh_files.mjs';

const [sourcePath, outPath, count = '200000'] = process.argv.slice(2);
const source = readMesh(sourcePath), out = readMesh(outPath);
const kTexels = 2048;

/** Mulberry32: the same points on every run. */
let state = 1;
function random() {
  state = (state + 0x6d2b79f5) | 0;
  let t = Math.imul(state ^ (state >>> 15), 1 | state);
  t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
  return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
}

const areas = out.triangles.map((t) => {
  const [a, b, c] = t.map((v) => out.places[v]);
  return norm(cross(sub(b, a), sub(c, a))) / 2;
});
const sums = [];
areas.reduce((sum, area, i) => (sums[i] = sum + area), 0);
const grid = new Grid(source.places, source.triangles);
const slips = [], distances = [];
for (let i = 0; i < Number(count); ++i) {
  const wanted = random() * sums.at(-1);
  let low = 0, high = sums.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sums[middle] > wanted) high = middle;
    else low = middle + 1;
  }
  const r = Math.sqrt(random()), s = random(), weights = [1 - r, r * (1 - s), r * s];
  const corners = (mesh, t) => mesh.triangles[t].map((v) => mesh.places[v]);
  const uv = (mesh, t, w) => mix(w, [0, 1, 2].map((k) => mesh.uvs[0][3 * t + k]));
  const near = grid.nearest(mix(weights, corners(out, low)), source.places, source.triangles);
  slips.push(kTexels * norm(sub(uv(out, low, weights), uv(source, near.triangle, near.weights))));
  distances.push(near.distance);
}
slips.sort((a, b) => a - b);
distances.sort((a, b) => a - b);
const at = (values, share) => values[Math.min(values.length - 1, Math.floor(share * values.length))];
const within = slips.filter((s) => s <= 0.5).length / slips.length;
const extent = Math.max(...[0, 1, 2].map((k) => {
  const [low, high] = source.places.reduce(([l, h], p) => [Math.min(l, p[k]), Math.max(h, p[k])], [Infinity, -Infinity]);
  return high - low;
}));
console.log(`${(100 * within).toFixed(3)} % of ${slips.length} points within 0.5 texel of ${kTexels}; ` +
            `slip at 50, 90, 99, 99.9 %: ${[0.5, 0.9, 0.99, 0.999].map((q) => at(slips, q).toFixed(3)).join(', ')}; ` +
            `the surfaces are ${(at(distances, 0.5) / extent).toExponential(1)} apart (median), ` +
            `${(at(distances, 0.999) / extent).toExponential(1)} (99.9 %), of their size`);
process.exit(within >= 0.999 ? 0 : 1);
