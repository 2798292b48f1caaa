// A little geometry for the readers in this folder.

export const sub = (a, b) => a.map((x, i) => x - b[i]);
export const add = (a, b) => a.map((x, i) => x + b[i]);
export const scale = (a, s) => a.map((x) => x * s);
export const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
export const cross = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const norm = (a) => Math.sqrt(dot(a, a));
export const mix = (weights, values) =>
  values[0].map((_, i) => weights.reduce((sum, w, k) => sum + w * values[k][i], 0));

/** Twice the signed area of a triangle in the plane. */
export const area2 = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);

export function polygonArea(points) {
  let sum = 0;
  for (let i = 2; i < points.length; ++i) sum += area2(points[0], points[i - 1], points[i]) / 2;
  return sum;
}

/** Barycentric weights of the point of the triangle nearest to p (Ericson 2005, section 5.1.5). */
export function nearestInTriangle(p, [a, b, c]) {
  const ab = sub(b, a), ac = sub(c, a), ap = sub(p, a);
  const d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return [1, 0, 0];
  const bp = sub(p, b), d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return [0, 1, 0];
  const vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return [1 - d1 / (d1 - d3), d1 / (d1 - d3), 0];
  const cp = sub(p, c), d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return [0, 0, 1];
  const vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return [1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)];
  const va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const w = (d4 - d3) / (d4 - d3 + d5 - d6);
    return [0, 1 - w, w];
  }
  return [va, vb, vc].map((x) => x / (va + vb + vc));
}

/** The part of a convex polygon where `side` is positive; it is linear, and so are the entries of
 *  a corner { at, ...values } between corners. */
export function clip(polygon, side) {
  const kept = [];
  polygon.forEach((p, i) => {
    const q = polygon[(i + 1) % polygon.length], s = side(p.at), t = side(q.at);
    if (s >= 0) kept.push(p);
    if ((s > 0 && t < 0) || (s < 0 && t > 0)) {
      const w = s / (s - t);
      kept.push({ at: mix([1 - w, w], [p.at, q.at]), weights: mix([1 - w, w], [p.weights, q.weights]) });
    }
  });
  return kept;
}

/** Triangles by place: `near(p, radius)` lists those whose boxes come within radius of p. */
export class Grid {
  constructor(places, triangles) {
    this.boxes = triangles.map((t) => {
      const corners = t.map((v) => places[v]);
      return [0, 1, 2].map((k) => [Math.min(...corners.map((c) => c[k])), Math.max(...corners.map((c) => c[k]))]);
    });
    const extents = this.boxes.map((box) => Math.max(...box.map(([low, high]) => high - low)));
    this.cell = 2 * extents.reduce((sum, e) => sum + e, 0) / extents.length;
    this.cells = new Map();
    this.boxes.forEach((box, t) => this.visit(box, (key) => {
      if (!this.cells.has(key)) this.cells.set(key, []);
      this.cells.get(key).push(t);
    }));
  }

  visit(box, each) {
    const [x, y, z] = box.map((range) => range.map((v) => Math.floor(v / this.cell)));
    for (let i = x[0]; i <= x[1]; ++i)
      for (let j = y[0]; j <= y[1]; ++j) for (let k = z[0]; k <= z[1]; ++k) each(`${i} ${j} ${k}`);
  }

  near(p, radius) {
    const found = new Set();
    this.visit(p.map((v) => [v - radius, v + radius]), (key) => {
      for (const t of this.cells.get(key) ?? [])
        if (this.boxes[t].every(([low, high], k) => low - radius <= p[k] && p[k] <= high + radius)) found.add(t);
    });
    return found;
  }

  /** { triangle, weights, distance } of the surface's point nearest to p. */
  nearest(p, places, triangles) {
    for (let radius = this.cell / 2; ; radius *= 2) {
      let best = { distance: Infinity };
      for (const triangle of this.near(p, radius)) {
        const corners = triangles[triangle].map((v) => places[v]);
        const weights = nearestInTriangle(p, corners), distance = norm(sub(mix(weights, corners), p));
        if (distance < best.distance) best = { triangle, weights, distance };
      }
      if (best.distance <= radius) return best;
    }
  }
}
