// What leads from a place on one surface to its image on the other.
import { Triangle, Vector3 } from 'three';

/**
 * Finds the place of the target that shows a place of the source: the triangle of the target whose
 * places come nearest to it, with the same side of the surface up.
 */
export class Link {
  constructor(mesh) {
    this.mesh = mesh;
    const { index, place } = mesh;
    const count = index.length / 3;
    this.centre = new Float32Array(3 * count);
    this.radius = new Float32Array(count);
    for (let t = 0; t < count; ++t) {
      for (let k = 0; k < 3; ++k)
        this.centre[3 * t + k] =
          (place[3 * index[3 * t] + k] +
            place[3 * index[3 * t + 1] + k] +
            place[3 * index[3 * t + 2] + k]) /
          3;
      for (let c = 0; c < 3; ++c)
        this.radius[t] = Math.max(
          this.radius[t],
          Math.hypot(
            place[3 * index[3 * t + c]] - this.centre[3 * t],
            place[3 * index[3 * t + c] + 1] - this.centre[3 * t + 1],
            place[3 * index[3 * t + c] + 2] - this.centre[3 * t + 2],
          ),
        );
    }
    this.triangle = new Triangle();
    this.closest = new Vector3();
  }

  corners(array, t) {
    const { index } = this.mesh;
    const at = (c) => new Vector3().fromArray(array, 3 * index[3 * t + c]);
    return [at(0), at(1), at(2)];
  }

  /** The image of `point`, whose surface there has the normal `normal`; null without one. */
  image(point, normal) {
    const { index, mapped, place, position } = this.mesh;
    let best = -1;
    let least = Infinity;
    const found = new Vector3();
    for (let t = 0; t < this.radius.length; ++t) {
      const reach =
        Math.hypot(
          this.centre[3 * t] - point.x,
          this.centre[3 * t + 1] - point.y,
          this.centre[3 * t + 2] - point.z,
        ) - this.radius[t];
      if (reach > least || !mapped[index[3 * t]]) continue;
      this.triangle.set(...this.corners(place, t));
      this.triangle.closestPointToPoint(point, this.closest);
      const distance = this.closest.distanceTo(point);
      if (distance >= least) continue;
      if (normal && this.triangle.getNormal(new Vector3()).dot(normal) < -0.2) continue;
      least = distance;
      best = t;
      found.copy(this.closest);
    }
    if (best < 0) return null;
    this.triangle.set(...this.corners(place, best));
    const weights = this.triangle.getBarycoord(found, new Vector3());
    if (!weights) return null;
    const [a, b, c] = this.corners(position, best);
    return new Vector3()
      .addScaledVector(a, weights.x)
      .addScaledVector(b, weights.y)
      .addScaledVector(c, weights.z);
  }
}

/** Where a point of a triangle of the target comes from; null where nothing is mapped to it. */
export function origin(mesh, face, weights) {
  const corners = [face.a, face.b, face.c];
  if (!mesh.mapped[corners[0]]) return null;
  const point = new Vector3();
  corners.forEach((v, k) =>
    point.addScaledVector(new Vector3().fromArray(mesh.place, 3 * v), weights.getComponent(k)),
  );
  return point;
}

/** The number in the list of the vertex nearest to a point. */
export function nearestVertex(vertices, point) {
  let best = 0;
  let least = Infinity;
  for (let v = 0; v < vertices.number.length; ++v) {
    const distance = Math.hypot(
      vertices.position[3 * v] - point.x,
      vertices.position[3 * v + 1] - point.y,
      vertices.position[3 * v + 2] - point.z,
    );
    if (distance >= least) continue;
    least = distance;
    best = v;
  }
  return best;
}
