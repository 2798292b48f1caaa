// keep.mjs has to refuse what is wrong: node keep_test.mjs SOURCE TARGET OVERLAY OUT.glb
// OUT.glb has seams and passes; a copy of it is spoilt in one way after the other. Exit 1 when one
// of them passes, or fails for another reason.
import { norm, sub } from './geometry.mjs';
import { judge, readCase } from './keep.mjs';

const files = readCase(process.argv.slice(2, 6));
const { vertex } = files.out;
const uvs = files.out.uvs[0];
const place = (v) => files.out.places[v];
const equal = (a, b) => a[0] === b[0] && a[1] === b[1];

/** Two triangles [t, k] and [u, l] of one plane whose side k and l is a seam, convex together. */
function acrossASeam() {
  const sides = new Map();
  const { triangles } = files.out;
  const end = (t, k) => vertex[triangles[t][k % 3]];
  triangles.forEach((_, t) => [0, 1, 2].forEach((k) => sides.set(`${end(t, k)} ${end(t, k + 1)}`, [t, k])));
  for (const [, [t, k]] of sides) {
    const [u, l] = sides.get(`${end(t, k + 1)} ${end(t, k)}`) ?? [];
    if (u === undefined || equal(uvs[3 * t + k], uvs[3 * u + (l + 1) % 3])) continue;
    const [a, b, c, d] = [end(t, k), end(t, k + 1), end(t, k + 2), end(u, l + 2)].map(place);
    const normal = (p, q, r) => {
      const [x, y] = [sub(q, p), sub(r, p)];
      return [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
    };
    const normals = [normal(a, b, c), normal(b, a, d), normal(a, d, c), normal(d, b, c)];
    const size = normals.map(norm);
    const along = (i) => normals[0].reduce((sum, x, j) => sum + x * normals[i][j], 0) / size[0] / size[i];
    if (Math.min(...size) < 0.1 * Math.max(...size)) continue;
    if (along(1) > 1 - 1e-9 && along(2) > 0.999 && along(3) > 0.999) return { t, k, u, l };
  }
  throw new Error('no seam runs through a triangle of the target');
}

const { t, k, u, l } = acrossASeam();
const spoilt = {
  'as it was': { how: () => {}, says: null },
  'one corner of the texture moved by two texels': {
    how: ({ uvs: [uv] }) => { uv[3 * t] = [uv[3 * t][0] + 2 / 512, uv[3 * t][1]]; },
    says: 'texture coordinates are not the map',
  },
  'a seam merged: a corner has the coordinates of the other side': {
    how: ({ uvs: [uv] }) => { uv[3 * t + k] = uv[3 * u + (l + 1) % 3]; },
    says: 'texture coordinates are not the map',
  },
  'two triangles cut across a seam and not along it': {
    how: ({ triangles, uvs: [uv] }) => {
      const corners = [[t, k], [t, k + 1], [t, k + 2], [u, l + 2]].map(([f, i]) => [triangles[f][i % 3], uv[3 * f + i % 3]]);
      const [a, b, c, d] = corners;
      [[t, [a, d, c]], [u, [d, b, c]]].forEach(([f, new_]) => new_.forEach(([v, w], i) => {
        triangles[f][i] = v;
        uv[3 * f + i] = w;
      }));
    },
    says: 'straddle a seam',
  },
  'the texture turned over': {
    how: (out) => { out.uvs[0] = out.uvs[0].map(([x, y]) => [1 - x, y]); },
    says: 'mirrored',
  },
  'a vertex off the surface': {
    how: ({ places, triangles }) => { places[triangles[t][0]] = place(triangles[t][0]).map((x) => 1.0005 * x); },
    says: 'do not lie in a triangle of the target',
  },
  'a triangle left out': {
    how: (out) => {
      out.triangles.splice(t, 1);
      out.material.splice(t, 1);
      out.uvs[0].splice(3 * t, 3);
    },
    says: 'not covered exactly once',
  },
  'a triangle there twice': {
    how: (out) => {
      out.triangles.push(out.triangles[t]);
      out.material.push(out.material[t]);
      out.uvs[0].push(...out.uvs[0].slice(3 * t, 3 * t + 3));
    },
    says: 'two triangles on the same side',
  },
  'an image with one bit changed': {
    how: ({ images }) => { images[0].bytes[images[0].bytes.length >> 1] ^= 1; },
    says: 'is not the source',
  },
};

let failed = 0;
for (const [name, { how, says }] of Object.entries(spoilt)) {
  const out = structuredClone(files.out);
  out.images.forEach((image) => { image.bytes = Buffer.from(image.bytes); });
  how(out);
  const { faults } = judge({ ...files, out });
  const good = says === null ? faults.length === 0 : faults.some((f) => f.includes(says));
  console.log(`${good ? 'ok    ' : 'FAILED'} ${name}: ${faults.join('; ') || 'passes'}`);
  failed += good ? 0 : 1;
}
process.exit(failed ? 1 : 0);
