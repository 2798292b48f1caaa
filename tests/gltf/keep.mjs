// Judges a textured mesh that `transfer --mode keep` wrote, from the files alone:
//   node keep.mjs SOURCE TARGET OVERLAY OUT.glb [--texture IMAGE] [--tolerance TEXELS]
// OVERLAY is the exact map of the same pair. Exit 1 when a triangle straddles a seam of the source,
// leaves its triangle of the target, or carries other texture coordinates than the map gives; when
// the target is not covered once; or when an image is not the source's, byte by byte.
import { readFileSync } from 'node:fs';
import { basename } from 'node:path';
import { fileURLToPath } from 'node:url';
import { area2, clip, cross, dot, Grid, mix, nearestInTriangle, norm, polygonArea, scale, sub } from './geometry.mjs';
import { imageSize, readMesh, readOverlay } from './mesh_files.mjs';

/** Who lies beyond each side of a triangle; a seam counts as nobody when `same` says so. */
function neighbours(triangles, vertex, same = () => true) {
  const sides = new Map(), beyond = triangles.map(() => [-1, -1, -1]);
  triangles.forEach((t, f) => t.forEach((v, k) => sides.set(`${vertex[v]} ${vertex[t[(k + 1) % 3]]}`, [f, k])));
  triangles.forEach((t, f) => t.forEach((v, k) => {
    const [g, l] = sides.get(`${vertex[t[(k + 1) % 3]]} ${vertex[v]}`) ?? [-1, -1];
    if (g >= 0 && same(f, k, g, l)) beyond[f][k] = g;
  }));
  return beyond;
}

/** Neighbours in the source across sides where material and texture coordinates go on. */
function acrossNoSeam(source) {
  return neighbours(source.triangles, source.vertex, (f, k, g, l) =>
    source.material[f] === source.material[g] && source.uvs.every((uv) => {
      const equal = (a, b) => a === b || (a && b && a[0] === b[0] && a[1] === b[1]);
      return equal(uv[3 * f + k], uv[3 * g + (l + 1) % 3]) && equal(uv[3 * f + (k + 1) % 3], uv[3 * g + l]);
    }));
}

/** Weights of a point of triangle `from` for the corners of triangle `to` that holds it as well. */
function inTriangle(weights, from, to, mesh) {
  if (from === to) return weights;
  const found = [0, 0, 0];
  weights.forEach((w, k) => {
    if (w === 0) return;
    const corner = mesh.triangles[to].findIndex((v) => mesh.vertex[v] === mesh.vertex[mesh.triangles[from][k]]);
    if (corner < 0) throw new Error(`overlay: a point of triangle ${from} is no point of triangle ${to}`);
    found[corner] += w;
  });
  return found;
}

/** Maps places near a triangle into its plane. */
function flatten([a, b, c]) {
  const u = sub(b, a), x = scale(u, 1 / norm(u)), n = cross(u, sub(c, a));
  const y = cross(scale(n, 1 / norm(n)), x);
  return (p) => [dot(sub(p, a), x), dot(sub(p, a), y)];
}

/** Sets of the given triangles that hang together across no seam. */
function pieces(faces, beyond) {
  const left = new Set(faces), found = [];
  while (left.size > 0) {
    const piece = [left.values().next().value];
    left.delete(piece[0]);
    for (let i = 0; i < piece.length; ++i)
      for (const g of beyond[piece[i]]) if (left.delete(g)) piece.push(g);
    found.push(new Set(piece));
  }
  return found;
}

/** Returns { figures, faults }: faults are sentences, none when all is well. */
export function judge({ source, target, overlay, out, textures, tolerance = 0.5 }) {
  const faults = [];
  const fault = (text) => faults.push(text);
  const extent = target.places.flat().reduce((most, x) => Math.max(most, Math.abs(x)), 0);
  const slack = 2 ** -22 * extent;  // places are stored in single precision: 2^-24, twice, twice over
  const beyond = acrossNoSeam(source);
  const corners = (mesh, f) => mesh.triangles[f].map((v) => mesh.places[v]);
  const polygons = target.triangles.map(() => []);
  overlay.polygons.forEach((p) => polygons[p.fb].push({
    fa: p.fa,
    corners: p.points.map((i) => {
      const { fa, a, fb, b } = overlay.points[i];
      return {
        place: mix(inTriangle(b, fb, p.fb, target), corners(target, p.fb)),
        weights: inTriangle(a, fa, p.fa, source),
      };
    }),
  }));
  const texels = source.triangles.map((_, f) => {
    const image = out.image[source.material[f] ?? out.material.find((m) => m in out.image)];
    return image === undefined ? 1024 : imageSize(out.images[image].bytes);
  });
  const sourceUv = (set, f, weights) => mix(weights, [0, 1, 2].map((k) => source.uvs[set][3 * f + k]));
  const hasUvs = source.triangles.map((_, f) =>
    source.uvs.length > 0 && source.uvs.every((uv) => uv[3 * f] && uv[3 * f + 1] && uv[3 * f + 2]));

  const grid = new Grid(target.places, target.triangles);
  const covered = target.triangles.map(() => 0);
  let straddling = 0, strayed = 0, wrong = 0, mirrored = 0, unmapped = 0, worst = 0;
  out.triangles.forEach((t, i) => {
    const places = t.map((v) => out.places[v]);
    let face = -1, least = Infinity;
    for (const f of grid.near(scale(mix([1, 1, 1], places), 1 / 3), slack)) {
      const triangle = corners(target, f);
      const away = Math.max(...places.map((p) => norm(sub(mix(nearestInTriangle(p, triangle), triangle), p))));
      if (away < least) [face, least] = [f, away];
    }
    if (!(least <= slack)) return void ++strayed;
    const flat = flatten(corners(target, face)), at = places.map(flat);
    const whole = area2(...at);
    covered[face] += whole / 2;
    // What lies within rounding of its rim has no area that can be told from none.
    const rounding = (rim) => 2 * slack * rim.reduce((sum, p, k) => sum + norm(sub(rim[(k + 1) % rim.length], p)), 0);
    const nothing = rounding(at);
    const cells = polygons[face].map((polygon) => {
      let part = polygon.corners.map((c) => ({ at: flat(c.place), weights: c.weights }));
      for (let k = 0; k < 3 && part.length > 2; ++k) part = clip(part, (p) => area2(at[k], at[(k + 1) % 3], p));
      return { fa: polygon.fa, part, area: polygonArea(part.map((c) => c.at)), polygon };
    }).filter((cell) => cell.area > 0);
    const reached = cells.reduce((sum, cell) => sum + (hasUvs[cell.fa] ? cell.area : 0), 0);
    if (out.material[i] === 'unmapped') {
      if (reached > nothing) ++unmapped;
      return;
    }
    const parts = pieces(cells.map((c) => c.fa), beyond).map((faces) => {
      const own = cells.filter((c) => faces.has(c.fa));
      return { own, area: own.reduce((sum, c) => sum + c.area, 0) };
    });
    if (parts.filter((p) => p.area > nothing).length > 1) ++straddling;
    if (parts.length === 0) return;
    const { own } = parts.reduce((a, b) => (b.area > a.area ? b : a));
    const { fa } = own[0];
    if (textures === undefined && source.material[fa] !== undefined && source.material[fa] !== out.material[i])
      return void ++wrong;
    if (!hasUvs[fa]) return;
    const uvOf = (set) => [0, 1, 2].map((k) => out.uvs[set][3 * i + k]);
    const strays = (set, carried, f, weights) =>
      norm(sub(carried, sourceUv(set, f, weights))) * texels[f];
    // The corners are points of the exact map and have its values, up to single precision.
    // One that rounding moved off the cells it belongs to may belong to those close by on its side
    // of the seams.
    const close = 100 * slack;
    const closeBy = polygons[face].filter((q) => own.some((c) => c.polygon === q) ||
      q.corners.some((c) => places.some((p) => norm(sub(c.place, p)) <= close)));
    const side = pieces(closeBy.map((q) => q.fa), beyond).find((faces) => faces.has(fa));
    const exact = places.every((p, k) => closeBy.some((q) => side.has(q.fa) && q.corners.some((c) =>
      norm(sub(c.place, p)) <= slack &&
      source.uvs.every((_, set) => strays(set, uvOf(set)[k], q.fa, c.weights) <= 0.01))));
    if (!exact) ++wrong;
    if (whole / 2 <= nothing) return;
    // The error is linear in a cell: its corners tell the largest.
    for (const { fa: f, part, area } of own) {
      if (area <= rounding(part.map((c) => c.at))) continue;
      for (const { at: p, weights } of part) {
        const inside = [0, 1, 2].map((k) => Math.max(0, area2(at[(k + 1) % 3], at[(k + 2) % 3], p) / whole));
        const sum = inside.reduce((a, b) => a + b);
        source.uvs.forEach((_, set) => {
          worst = Math.max(worst, strays(set, mix(scale(inside, 1 / sum), uvOf(set)), f, weights));
        });
      }
    }
    source.uvs.forEach((uv, set) => {
      const there = uvOf(set), size = area2(...there);
      const longest = Math.max(...there.map((p, k) => norm(sub(there[(k + 1) % 3], p))));
      // Thinner ones than the tolerance may turn over within it.
      if (Math.abs(size) / longest * texels[fa] < 2 * tolerance) return;
      // The source's own layout may turn over from one triangle to the next.
      if (own.every(({ fa: f }) => size * area2(uv[3 * f], uv[3 * f + 1], uv[3 * f + 2]) < 0)) ++mirrored;
    });
  });

  const sides = new Set();
  let twice = 0;
  for (const t of out.triangles)
    t.forEach((v, k) => {
      const side = `${out.vertex[v]} ${out.vertex[t[(k + 1) % 3]]}`;
      if (sides.has(side)) ++twice;
      sides.add(side);
    });
  const around = neighbours(target.triangles, target.vertex);
  let uncovered = 0, leftOut = 0;
  covered.forEach((area, f) => {
    const triangle = corners(target, f);
    const whole = norm(cross(sub(triangle[1], triangle[0]), sub(triangle[2], triangle[0]))) / 2;
    const rim = triangle.reduce((sum, p, k) => sum + norm(sub(triangle[(k + 1) % 3], p)), 0);
    if (Math.abs(area - whole) <= 4 * slack * rim) return;
    // Other components of the file are left out altogether.
    if (area === 0 && around[f].every((g) => g < 0 || covered[g] === 0)) ++leftOut;
    else ++uncovered;
  });

  if (out.triangles.length === 0) fault('there is no triangle');
  if (straddling) fault(`${straddling} triangles straddle a seam of the source`);
  if (strayed) fault(`${strayed} triangles do not lie in a triangle of the target`);
  if (uncovered) fault(`${uncovered} triangles of the target are not covered exactly once`);
  if (twice) fault(`${twice} sides belong to two triangles on the same side`);
  if (wrong) fault(`${wrong} triangles have corners whose material or texture coordinates are not the map's`);
  if (unmapped) fault(`${unmapped} triangles are unmapped where the map has a texture for them`);
  if (mirrored) fault(`${mirrored} triangles have their texture mirrored`);
  // Single precision takes a little more.
  if (worst > tolerance + 0.01) fault(`the texture is ${worst.toFixed(3)} texels off, ${tolerance} are allowed`);
  const originals = textures ?? source.images;
  for (const image of out.images)
    if (!originals.some((o) => o.bytes.equals(image.bytes))) fault(`image ${image.name} is not the source's`);
  if (originals.length > 0 && out.images.length === 0) fault('the images are missing');
  return {
    faults,
    figures: { triangles: out.triangles.length, worstTexels: worst, leftOut },
  };
}

export function readCase([source, target, overlay, out], options = {}) {
  return {
    source: readMesh(source), target: readMesh(target), overlay: readOverlay(overlay), out: readMesh(out),
    ...(options.texture && { textures: [{ bytes: readFileSync(options.texture) }] }),
    ...(options.tolerance && { tolerance: Number(options.tolerance) }),
  };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const files = process.argv.slice(2, 6), options = {};
  for (let i = 6; i < process.argv.length; i += 2) options[process.argv[i].slice(2)] = process.argv[i + 1];
  if (files.length < 4) {
    console.error('usage: node keep.mjs SOURCE TARGET OVERLAY OUT.glb [--texture IMAGE] [--tolerance TEXELS]');
    process.exit(2);
  }
  const { faults, figures } = judge(readCase(files, options));
  console.log(`${basename(files[3])}: ${figures.triangles} triangles, texture at most ${figures.worstTexels.toFixed(4)} texels off` +
              (figures.leftOut ? `, ${figures.leftOut} triangles of the target in components left out` : ''));
  for (const text of faults) console.log(`  ${text}`);
  console.log(`keep: ${faults.length ? 'FAILED' : 'passed'}`);
  process.exit(faults.length ? 1 : 0);
}
