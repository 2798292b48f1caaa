// The page of a run over a pair: both surfaces, what leads from one to the other, and landmarks.
import { LinearSRGBColorSpace, WebGLRenderer } from 'three';
import { readData } from './data.js';
import { Landmarks } from './landmarks.js';
import { Link, origin } from './link.js';
import * as draw from './overlays.js';
import { Pane } from './pane.js';
import { buildPanel } from './panel.js';
import { layers, loadTextures, surfaceMesh } from './surface.js';

const data = readData(document.getElementById('data').textContent);
const state = { layer: 0, up: 'y', beside: false, linked: true, adding: false, shown: new Set() };
const mapOf = { source: 0, target: 0, other: 1 }; // `other` shows the runner-up beside the target
const sides = data.maps.length > 1 ? ['source', 'target', 'other'] : ['source', 'target'];
const surfaceOf = (side) => (side === 'source' ? 'source' : 'target');
const shownSides = () => sides.filter((side) => side !== 'other' || state.beside);
const overlayKeys = { c: 'critical', a: 'arcs', g: 'graph', m: 'matches', s: 'seams' };

const panel = buildPanel(data, layers, draw.overlays, {
  layer: setLayer,
  overlay: toggleOverlay,
  beside: toggleBeside,
  link: toggleLink,
  up: turnUp,
  add: () => setAdding(!state.adding),
  remove: removeLandmark,
  save: saveLandmarks,
});
const renderer = new WebGLRenderer({
  canvas: panel.canvas,
  antialias: true,
  alpha: true,
  preserveDrawingBuffer: true,
});
renderer.outputColorSpace = LinearSRGBColorSpace; // colours are stored as the screen shows them
renderer.autoClear = false;
const panes = Object.fromEntries(sides.map((s) => [s, new Pane(panel.panes[s], cameraMoved)]));
const textureOf = loadTextures(data, requestDraw);
const landmarks = new Landmarks(data, data.maps[0].matches);
const links = {};
let drawing = false;

/** What leads from the source to the surface of a pane. */
function linkTo(side) {
  links[side] ??= new Link(data.maps[mapOf[side]].target);
  return links[side];
}

function requestDraw() {
  if (drawing) return;
  drawing = true;
  requestAnimationFrame(() => {
    drawing = false;
    drawNow();
  });
}

function drawNow() {
  const { width, height } = panel.stage.getBoundingClientRect();
  renderer.setPixelRatio(window.devicePixelRatio);
  renderer.setSize(width, height, false);
  renderer.setScissorTest(false);
  renderer.clear();
  renderer.setScissorTest(true);
  const stage = panel.stage.getBoundingClientRect();
  for (const side of shownSides()) {
    const box = panel.panes[side].getBoundingClientRect();
    const rectangle = [box.left - stage.left, stage.bottom - box.bottom, box.width, box.height];
    renderer.setViewport(...rectangle);
    renderer.setScissor(...rectangle);
    panes[side].resize(box.width, box.height);
    renderer.render(panes[side].scene, panes[side].camera);
  }
}

function cameraMoved(pane) {
  if (state.linked) for (const side of sides) if (panes[side] !== pane) panes[side].follow(pane);
  requestDraw();
}

function setLayer(i) {
  state.layer = i;
  for (const side of sides)
    for (const material of panes[side].surface.material) material.uniforms.layer.value = i;
  panel.showLayer(i);
  requestDraw();
}

function toggleOverlay(key) {
  const on = !state.shown.has(key);
  if (on) state.shown.add(key);
  else state.shown.delete(key);
  for (const side of sides) panes[side].on[key].visible = on;
  panel.showOverlay(key, on);
  requestDraw();
}

function toggleLink() {
  state.linked = !state.linked;
  if (state.linked) cameraMoved(panes.source);
  panel.showLink(state.linked);
  requestDraw();
}

function turnUp() {
  state.up = { y: 'z', z: 'x', x: '-y', '-y': '-z', '-z': '-x', '-x': 'y' }[state.up];
  for (const side of sides) panes[side].setUp(state.up);
  panel.showUp(state.up);
  requestDraw();
}

function setAdding(on) {
  state.adding = on;
  panel.showAdding(on);
}

function toggleBeside() {
  if (sides.length < 3) return;
  state.beside = !state.beside;
  panel.showBeside(state.beside);
  requestDraw();
}

function fill(side) {
  const map = data.maps[mapOf[side]];
  const surface = surfaceOf(side);
  const pane = panes[side];
  pane.setSurface(surfaceMesh(map[surface], map.materials, textureOf, data.places));
  const graph = data.graphs[surface];
  const size = pane.pointSize;
  const put = (key, group) => pane.setOverlay(key, group, state.shown.has(key));
  put('critical', draw.criticalPoints(graph, size));
  put('arcs', draw.arcs(graph));
  put('graph', draw.straightGraph(graph));
  put('matches', draw.matches(map.matches, surface, size));
  put('seams', draw.seams(map[surface]));
  pane.setOverlay('pointer', draw.pointer(size), true);
}

function showLandmarks() {
  for (const side of ['source', 'target'])
    panes[side].setOverlay(
      'landmarks',
      draw.landmarks(landmarks.list, side, landmarks.chosen, panes[side].pointSize),
      true,
    );
  panel.showLandmarks(landmarks.list.length, landmarks.chosen);
  requestDraw();
}

function removeLandmark() {
  if (landmarks.chosen < 0) return;
  landmarks.remove(landmarks.chosen);
  showLandmarks();
}

function saveLandmarks() {
  if (landmarks.list.length === 0) return;
  const file = new Blob([landmarks.text(data.title)], { type: 'text/plain' });
  const anchor = document.createElement('a');
  anchor.href = URL.createObjectURL(file);
  anchor.download = 'landmarks.txt';
  anchor.click();
  URL.revokeObjectURL(anchor.href);
}

/** Where a point that was picked comes from on the source, or null. */
function sourceOf(side, hit) {
  if (side === 'source') return hit.point;
  return origin(data.maps[mapOf[side]].target, hit.face, hit.weights);
}

/** Where a point that was picked is on the surface of another pane, or null. */
function imageOf(side, hit, other) {
  if (side === other) return hit.point;
  const source = sourceOf(side, hit);
  if (!source || other === 'source') return source;
  return linkTo(other).image(source, side === 'source' ? hit.normal : null);
}

function setPointer(side, point) {
  const ball = panes[side].on.pointer.children[0];
  ball.visible = point !== null;
  if (point) ball.position.copy(point);
}

const written = (p) => (p ? `(${p.toArray().map((x) => x.toPrecision(5)).join(', ')})` : 'nothing');

function pointAt(side, x, y) {
  const hit = panes[side].pick(x, y);
  for (const other of shownSides()) setPointer(other, hit ? imageOf(side, hit, other) : null);
  const facing = side === 'source' ? 'target' : 'source';
  panel.setStatus(
    hit
      ? `${surfaceOf(side)} ${written(hit.point)} ↔ ${facing} ${written(imageOf(side, hit, facing))}`
      : '',
  );
  requestDraw();
}

function addLandmark(side, x, y) {
  const hit = side === 'other' ? null : panes[side].pick(x, y);
  const facing = side === 'source' ? 'target' : 'source';
  const there = hit ? imageOf(side, hit, facing) : null;
  if (!there) return;
  if (side === 'source') landmarks.add(hit.point, there);
  else landmarks.add(there, hit.point);
  setAdding(false);
  showLandmarks();
}

for (const side of sides) {
  const element = panel.panes[side];
  let dragged = -1;
  let waiting = false;
  element.addEventListener(
    'pointerdown',
    (event) => {
      const { clientX: x, clientY: y } = event;
      if (state.adding) {
        event.stopImmediatePropagation();
        addLandmark(side, x, y);
        return;
      }
      dragged = panes[side].pickLandmark(x, y);
      if (dragged < 0) return;
      event.stopImmediatePropagation(); // the camera stays
      element.setPointerCapture(event.pointerId);
      landmarks.chosen = dragged;
      showLandmarks();
    },
    { capture: true },
  );
  element.addEventListener(
    'pointermove',
    (event) => {
      if (dragged >= 0) event.stopImmediatePropagation();
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        if (dragged >= 0) {
          const hit = panes[side].pick(event.clientX, event.clientY);
          if (hit) landmarks.move(dragged, side, hit.point);
          showLandmarks();
        } else if (event.buttons === 0 || event.pointerType === 'touch') {
          pointAt(side, event.clientX, event.clientY);
        }
      });
    },
    { capture: true },
  );
  const end = () => (dragged = -1);
  element.addEventListener('pointerup', end, { capture: true });
  element.addEventListener('pointercancel', end, { capture: true });
  element.addEventListener('pointerleave', () => {
    if (dragged < 0) for (const s of sides) setPointer(s, null);
    requestDraw();
  });
}

window.addEventListener('resize', requestDraw);
window.addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const key = event.key.toLowerCase();
  if (key >= '1' && key <= String(layers.length)) setLayer(Number(key) - 1);
  else if (overlayKeys[key]) toggleOverlay(overlayKeys[key]);
  else if (key === 'r') toggleBeside();
  else if (key === 'l') toggleLink();
  else if (key === 'u') turnUp();
  else if (key === 'n') setAdding(!state.adding);
  else if (key === 'delete' || key === 'backspace') removeLandmark();
  else if (key === 'w') saveLandmarks();
  else if (key === 'escape') setAdding(false);
});

sides.forEach(fill);
showLandmarks();
// A surface without a texture is shown by its places.
const plain = !data.images.some((image) => image) && !data.maps[0].source.color;
setLayer(plain ? 1 : 0);
drawNow();
// For scripts that look at the page: where a point of a surface is drawn.
window.crosspatch = { data, screen: (side, point) => panes[side].screen(point), draw: drawNow };
