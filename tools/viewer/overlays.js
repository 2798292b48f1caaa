// What is drawn on top of a surface: critical points, arcs, matches, seams, landmarks.
import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  Group,
  Line,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  OctahedronGeometry,
  SphereGeometry,
  Sprite,
  SpriteMaterial,
  Vector3,
} from 'three';

/** What can be shown or not; the shape of a point tells its kind without colour. */
export const overlays = [
  { key: 'critical', name: 'Critical points', about: 'Maxima: red octahedra. Minima: blue cubes. Saddles: green balls.' },
  { key: 'arcs', name: 'Arcs', about: 'Arcs of the Morse-Smale complex, and added paths in purple.' },
  { key: 'graph', name: 'Feature graph', about: 'The same as straight lines; thin ones weigh less.' },
  { key: 'matches', name: 'Matches', about: 'Points that the map was chosen by, with their confidence.' },
  { key: 'seams', name: 'Seams', about: 'Where the texture is cut.' },
];

const kinds = {
  max: { color: 0xd62728, shape: new OctahedronGeometry(1.3) },
  min: { color: 0x1f5fd6, shape: new BoxGeometry(1.7, 1.7, 1.7) },
  saddle: { color: 0x2ca02c, shape: new SphereGeometry(1, 12, 8) },
};

/** A point of the given size in the surface's own units. */
function marker(at, shape, color, size) {
  const mesh = new Mesh(shape, new MeshBasicMaterial({ color }));
  mesh.position.copy(at);
  mesh.scale.setScalar(size);
  return mesh;
}

function label(text, at, size) {
  const canvas = document.createElement('canvas');
  canvas.width = 256;
  canvas.height = 64;
  const pen = canvas.getContext('2d');
  pen.font = '600 44px system-ui, sans-serif';
  pen.lineWidth = 8;
  pen.strokeStyle = 'white';
  pen.strokeText(text, 8, 48);
  pen.fillStyle = 'black';
  pen.fillText(text, 8, 48);
  const sprite = new Sprite(
    new SpriteMaterial({ map: new CanvasTexture(canvas), depthTest: false }),
  );
  sprite.center.set(0, 0);
  sprite.position.copy(at);
  sprite.scale.set(8 * size, 2 * size, 1);
  return sprite;
}

function line(points, color, Type = Line) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(points, 3));
  return new Type(geometry, new LineBasicMaterial({ color }));
}

export function criticalPoints(graph, size) {
  const group = new Group();
  for (const node of graph.nodes) {
    const { color, shape } = kinds[node.kind];
    group.add(marker(new Vector3(...node.at), shape, color, size));
  }
  return group;
}

export function arcs(graph) {
  const group = new Group();
  for (const arc of graph.arcs) group.add(line(arc.path, arc.added ? 0x8a2be2 : 0x222222));
  return group;
}

export function straightGraph(graph) {
  const group = new Group();
  for (const arc of graph.arcs) {
    const ends = new Float32Array([...graph.nodes[arc.from].at, ...graph.nodes[arc.to].at]);
    const straight = line(ends, arc.added ? 0x8a2be2 : 0x222222);
    straight.material.transparent = true;
    straight.material.opacity = 0.3 + 0.7 * arc.weight;
    straight.material.depthTest = false;
    group.add(straight);
  }
  return group;
}

export function seams(mesh) {
  const group = new Group();
  if (mesh.seams.length > 0) group.add(line(mesh.seams, 0xff00aa, LineSegments));
  return group;
}

/** Numbered points; `side` is 'source' or 'target'. */
export function matches(list, side, size) {
  const group = new Group();
  list.forEach((match, i) => {
    const at = new Vector3(...match[side]);
    const sure = match.given || match.confidence >= 1;
    group.add(marker(at, kinds.saddle.shape, sure ? 0x111111 : 0xe08000, size));
    const percent = match.given ? 'given' : `${Math.round(100 * match.confidence)} %`;
    group.add(label(`${i + 1}: ${percent}`, at, 2.5 * size));
  });
  return group;
}

export function landmarks(list, side, chosen, size) {
  const group = new Group();
  list.forEach((landmark, i) => {
    const ball = marker(
      landmark[side].point,
      kinds.saddle.shape,
      i === chosen ? 0xffd000 : 0x00a0ff,
      1.3 * size,
    );
    ball.userData.landmark = i;
    group.add(ball);
    group.add(label(`L${i + 1}`, landmark[side].point, 2.5 * size));
  });
  return group;
}

export function pointer(size) {
  const ball = marker(new Vector3(), kinds.saddle.shape, 0xff2020, size);
  ball.visible = false;
  return ball;
}
