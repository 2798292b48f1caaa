// Landmarks that the reader places, and the file they are saved in.
import { Vector3 } from 'three';
import { nearestVertex } from './link.js';

export class Landmarks {
  /** Begins with the matches that were given to the run. */
  constructor(data, matches) {
    this.vertices = data.vertices;
    this.list = matches
      .filter((m) => m.given)
      .map((m) => ({
        source: { point: new Vector3(...m.source), number: m.source_vertex },
        target: { point: new Vector3(...m.target), number: m.target_vertex },
      }));
    this.chosen = -1;
  }

  /** The vertex next to a point, as an end of a landmark. */
  snap(side, point) {
    const { position, number } = this.vertices[side];
    const v = nearestVertex(this.vertices[side], point);
    return { point: new Vector3().fromArray(position, 3 * v), number: number[v] };
  }

  add(source, target) {
    this.list.push({ source: this.snap('source', source), target: this.snap('target', target) });
    this.chosen = this.list.length - 1;
  }

  move(i, side, point) {
    this.list[i][side] = this.snap(side, point);
  }

  remove(i) {
    this.list.splice(i, 1);
    this.chosen = -1;
  }

  /** The text that --landmarks reads. */
  text(title) {
    const lines = this.list.map((l) => `${l.source.number} ${l.target.number}`);
    return [`# landmarks of ${title}: source vertex, target vertex`, ...lines, ''].join('\n');
  }
}
