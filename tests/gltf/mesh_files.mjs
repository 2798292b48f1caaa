// Mesh files as plain arrays, read with no code of the program's.
//
// A mesh is { places: [[x, y, z]], triangles: [[i, j, k]], uvs: [set][corner] = [u, v] | undefined,
// material: [name of each triangle], images: [{ name, bytes }], image: { material: index },
// vertex: [number of each place] }. Places of a glTF file that are equal are one vertex: it has one
// for each texture coordinate. Those of other files are vertices as they are.
// Corner 3 t + k belongs to triangle t. UVs are those of glTF: v grows downwards.
import { readFileSync } from 'node:fs';
import { dirname, extname, join } from 'node:path';

export function readMesh(path) {
  const kind = extname(path).toLowerCase();
  if (!['.glb', '.obj', '.off'].includes(kind)) throw new Error(`${path}: neither GLB, OBJ nor OFF`);
  if (kind !== '.glb') {
    const mesh = kind === '.obj' ? readObj(path) : readOff(path);
    return { ...mesh, vertex: mesh.places.map((_, i) => i) };
  }
  const mesh = readGlb(readFileSync(path));
  return { ...mesh, vertex: weld(mesh.places) };
}

/** Splits a GLB into its header and its binary chunk. */
function splitGlb(bytes) {
  const length = bytes.readUInt32LE(12);
  return { header: JSON.parse(bytes.subarray(20, 20 + length)), binary: bytes.subarray(20 + length + 8) };
}

const kComponents = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };
const kReaders = {
  5121: [1, (b, at) => b.readUInt8(at)],
  5123: [2, (b, at) => b.readUInt16LE(at)],
  5125: [4, (b, at) => b.readUInt32LE(at)],
  5126: [4, (b, at) => b.readFloatLE(at)],
};

/** The elements of an accessor, each an array of numbers. */
function accessor({ header, binary }, index) {
  const a = header.accessors[index], view = header.bufferViews[a.bufferView];
  const n = kComponents[a.type], [size, read] = kReaders[a.componentType];
  const start = (view.byteOffset ?? 0) + (a.byteOffset ?? 0), stride = view.byteStride ?? n * size;
  return Array.from({ length: a.count }, (_, i) =>
    Array.from({ length: n }, (_, k) => read(binary, start + i * stride + k * size)));
}

function readGlb(bytes) {
  const glb = splitGlb(bytes), { header, binary } = glb;
  const mesh = { places: [], triangles: [], uvs: [], material: [], images: [], image: {} };
  mesh.images = (header.images ?? []).map((image) => {
    const { byteOffset = 0, byteLength } = header.bufferViews[image.bufferView];
    return { name: image.name, bytes: binary.subarray(byteOffset, byteOffset + byteLength) };
  });
  for (const m of header.materials ?? []) {
    const texture = m.pbrMetallicRoughness?.baseColorTexture;
    if (texture) mesh.image[m.name] = header.textures[texture.index].source;
  }
  const primitives = header.nodes.filter((n) => n.mesh !== undefined)
    .flatMap((n) => header.meshes[n.mesh].primitives);
  for (const p of primitives) {
    const first = mesh.places.length;
    mesh.places = mesh.places.concat(accessor(glb, p.attributes.POSITION));
    const count = mesh.places.length - first;
    const corners = p.indices === undefined ? Array.from({ length: count }, (_, i) => i)
      : accessor(glb, p.indices).map(([i]) => i);
    const uvs = [0, 1].map((s) => p.attributes[`TEXCOORD_${s}`])
      .map((a) => (a === undefined ? [] : accessor(glb, a)));
    for (let c = 0; c < corners.length; c += 3) {
      mesh.triangles.push([0, 1, 2].map((k) => first + corners[c + k]));
      mesh.material.push(header.materials?.[p.material]?.name);
    }
    uvs.forEach((set, s) => { mesh.uvs[s] = (mesh.uvs[s] ?? []).concat(corners.map((i) => set[i])); });
  }
  mesh.uvs = mesh.uvs.filter((set) => set.some((uv) => uv));
  return mesh;
}

function readObj(path) {
  const mesh = { places: [], triangles: [], uvs: [[]], material: [], images: [], image: {} };
  const texture = [];
  let material;
  for (const line of readFileSync(path, 'utf8').split('\n')) {
    const [word, ...rest] = line.trim().split(/\s+/);
    if (word === 'v') mesh.places.push(rest.slice(0, 3).map(Number));
    if (word === 'vt') texture.push([Number(rest[0]), 1 - Number(rest[1])]);
    if (word === 'usemtl') material = rest[0];
    if (word === 'mtllib') readMtl(join(dirname(path), rest[0]), mesh);
    if (word !== 'f') continue;
    const corners = rest.map((corner) => corner.split('/').map((n) => parseInt(n, 10) - 1));
    for (let k = 2; k < corners.length; ++k) {
      const fan = [corners[0], corners[k - 1], corners[k]];
      mesh.triangles.push(fan.map(([v]) => v));
      mesh.uvs[0].push(...fan.map(([, vt]) => texture[vt]));
      mesh.material.push(material);
    }
  }
  mesh.uvs = mesh.uvs.filter((set) => set.some((uv) => uv));
  return mesh;
}

function readMtl(path, mesh) {
  let material;
  for (const line of readFileSync(path, 'utf8').split('\n')) {
    const [word, name] = line.trim().split(/\s+/);
    if (word === 'newmtl') material = name;
    if (word !== 'map_Kd') continue;
    mesh.image[material] = mesh.images.length;
    mesh.images.push({ name, bytes: readFileSync(join(dirname(path), name)) });
  }
}

function readOff(path) {
  const words = readFileSync(path, 'utf8').replace(/#.*/g, '').split(/\s+/).filter((w) => w);
  let at = 1;
  const number = () => Number(words[at++]);
  const [vertices, faces] = [number(), number(), number()];
  const mesh = { places: [], triangles: [], uvs: [], material: [], images: [], image: {} };
  for (let v = 0; v < vertices; ++v) mesh.places.push([number(), number(), number()]);
  for (let f = 0; f < faces; ++f) {
    const polygon = Array.from({ length: number() }, number);
    for (let k = 2; k < polygon.length; ++k) {
      mesh.triangles.push([polygon[0], polygon[k - 1], polygon[k]]);
      mesh.material.push(undefined);
    }
  }
  return mesh;
}

/** The exact map: { points: [{ fa, a, fb, b }], polygons: [{ points, fa, fb }] }. */
export function readOverlay(path) {
  const lines = readFileSync(path, 'utf8').split('\n');
  if (lines[0] !== 'crosspatch-overlay 1') throw new Error(`${path}: no overlay`);
  const [points, polygons] = lines[1].split(' ').map(Number);
  const numbers = (i) => lines[2 + i].split(' ').map(Number);
  return {
    points: Array.from({ length: points }, (_, i) => {
      const n = numbers(i);
      return { fa: n[0], a: n.slice(1, 4), fb: n[4], b: n.slice(5, 8) };
    }),
    polygons: Array.from({ length: polygons }, (_, i) => {
      const n = numbers(points + i);
      return { points: n.slice(1, 1 + n[0]), fa: n[1 + n[0]], fb: n[2 + n[0]] };
    }),
  };
}

/** Texels of an image's longer side, of a PNG or a JPEG. */
export function imageSize(bytes) {
  if (bytes.toString('latin1', 1, 4) === 'PNG') return Math.max(bytes.readUInt32BE(16), bytes.readUInt32BE(20));
  for (let at = 2; at < bytes.length; at += 2 + bytes.readUInt16BE(at + 2))
    if ([0xc0, 0xc1, 0xc2].includes(bytes[at + 1]))
      return Math.max(bytes.readUInt16BE(at + 5), bytes.readUInt16BE(at + 7));
  throw new Error('an image is neither PNG nor JPEG');
}

/** The number of the first vertex at the same place, for every vertex. */
function weld(places) {
  const first = new Map();
  return places.map((p, i) => {
    const key = p.join(' ');
    if (!first.has(key)) first.set(key, i);
    return first.get(key);
  });
}
