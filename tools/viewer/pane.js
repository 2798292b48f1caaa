// One surface with its camera.
import { Group, PerspectiveCamera, Raycaster, Scene, Vector2, Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const fieldOfView = 35; // degrees, across the shorter side

export class Pane {
  /** `element` lies over the part of the page that the pane is drawn in and takes its input. */
  constructor(element, changed) {
    this.element = element;
    this.scene = new Scene();
    this.world = new Group(); // turned so that the mesh's own upward axis points up
    this.scene.add(this.world);
    this.camera = new PerspectiveCamera(fieldOfView, 1, 0.01, 50);
    this.camera.position.set(1.2, 0.7, 3.2);
    this.controls = new OrbitControls(this.camera, element);
    this.controls.addEventListener('change', () => changed(this));
    this.raycaster = new Raycaster();
    this.surface = null;
    this.on = {}; // groups of overlays by key, in the surface's own coordinates
  }

  setSurface(surface) {
    this.surface = surface;
    this.world.add(surface);
  }

  /** Puts a group of overlays in place of the one with the same key. */
  setOverlay(key, group, visible) {
    if (this.on[key]) this.world.remove(this.on[key]);
    const holder = new Group();
    holder.add(group);
    holder.visible = visible;
    this.on[key] = holder;
    holder.scale.copy(this.surface.scale);
    holder.position.copy(this.surface.position);
    this.world.add(holder);
  }

  /** Size of points, in the surface's own units. */
  get pointSize() {
    return 0.012 / this.surface.scale.x;
  }

  /** Turns the mesh so that its axis 'x', 'y' or 'z' points up. */
  setUp(axis) {
    const quarters = { y: [0, 0], z: [-1, 0], x: [0, 1], '-y': [0, 2], '-z': [1, 0], '-x': [0, -1] };
    const [aboutX, aboutZ] = quarters[axis];
    this.world.rotation.set((aboutX * Math.PI) / 2, 0, (aboutZ * Math.PI) / 2);
    this.world.updateMatrixWorld(true);
  }

  follow(other) {
    this.camera.position.copy(other.camera.position);
    this.camera.quaternion.copy(other.camera.quaternion);
    this.controls.target.copy(other.controls.target);
  }

  resize(width, height) {
    this.camera.aspect = width / Math.max(height, 1);
    // The shorter side of the pane holds the unit ball.
    const half = Math.tan((fieldOfView / 2) * (Math.PI / 180)) / Math.min(1, this.camera.aspect);
    this.camera.fov = 2 * Math.atan(half) * (180 / Math.PI);
    this.camera.updateProjectionMatrix();
  }

  ray(x, y) {
    const box = this.element.getBoundingClientRect();
    const point = new Vector2(
      (2 * (x - box.left)) / box.width - 1,
      1 - (2 * (y - box.top)) / box.height,
    );
    this.camera.updateMatrixWorld();
    this.raycaster.setFromCamera(point, this.camera);
    return this.raycaster;
  }

  /** The point of the surface under a place of the page: its own coordinates, face and weights. */
  pick(x, y) {
    const hit = this.ray(x, y).intersectObject(this.surface)[0];
    if (!hit) return null;
    return {
      point: this.surface.worldToLocal(hit.point.clone()),
      normal: hit.face.normal,
      face: hit.face,
      weights: hit.barycoord,
    };
  }

  /** The landmark under a place of the page, or -1. */
  pickLandmark(x, y) {
    const group = this.on.landmarks;
    if (!group) return -1;
    const balls = group.children[0].children.filter((o) => o.userData.landmark !== undefined);
    const hit = this.ray(x, y).intersectObjects(balls)[0];
    return hit ? hit.object.userData.landmark : -1;
  }

  /** Where a point of the surface is on the page. */
  screen(point) {
    this.camera.updateMatrixWorld();
    const p = this.surface.localToWorld(new Vector3(...point)).project(this.camera);
    const box = this.element.getBoundingClientRect();
    return [box.left + ((p.x + 1) / 2) * box.width, box.top + ((1 - p.y) / 2) * box.height];
  }
}
