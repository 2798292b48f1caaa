// The two surfaces as three.js draws them.
import {
  BufferAttribute,
  BufferGeometry,
  ClampToEdgeWrapping,
  DoubleSide,
  Mesh,
  MirroredRepeatWrapping,
  NoColorSpace,
  RepeatWrapping,
  ShaderMaterial,
  Texture,
  TextureLoader,
  Vector3,
} from 'three';

/** What a surface can be coloured by; the numbers are known to the shader. */
export const layers = [
  { key: 'texture', name: 'Texture', about: 'The texture of the source, and where it went.' },
  { key: 'position', name: 'Place', about: 'Places of one colour correspond.' },
  { key: 'checker', name: 'Checker', about: 'Squares of the source; bent or smeared where stretched.' },
  { key: 'adf', name: 'Diffusion', about: 'Auto diffusion function with level lines, bright at tips.' },
  { key: 'distortion', name: 'Distortion', about: 'White: as on the source. Dark red: 25 times the energy.' },
  {
    key: 'patches',
    name: 'Patches',
    about: 'Regions of the source that lead to one tip and one hollow, and where they went.',
  },
];

const vertexShader = `
  attribute vec3 place;
  attribute vec3 color8;
  attribute float adf, distortion, patchNumber, mapped;
  varying vec3 vNormal, vPlace, vColor;
  varying vec2 vUv;
  varying float vAdf, vDistortion, vPatch, vMapped;
  void main() {
    vNormal = normalMatrix * normal;
    vPlace = place;
    vColor = color8;
    vUv = uv;
    vAdf = adf;
    vDistortion = distortion;
    vPatch = patchNumber;
    vMapped = mapped;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }`;

const fragmentShader = `
  uniform int layer;
  uniform sampler2D image;
  uniform bool hasImage;
  uniform vec3 baseColor;
  uniform vec3 low;
  uniform float extent;
  varying vec3 vNormal, vPlace, vColor;
  varying vec2 vUv;
  varying float vAdf, vDistortion, vPatch, vMapped;

  vec3 fieldColor(float t) {
    vec3 c0 = vec3(0.27, 0.0, 0.33), c1 = vec3(0.23, 0.32, 0.55), c2 = vec3(0.13, 0.57, 0.55);
    vec3 c3 = vec3(0.37, 0.79, 0.38), c4 = vec3(0.99, 0.91, 0.14);
    float s = clamp(t, 0.0, 1.0) * 4.0;
    if (s < 1.0) return mix(c0, c1, s);
    if (s < 2.0) return mix(c1, c2, s - 1.0);
    if (s < 3.0) return mix(c2, c3, s - 2.0);
    return mix(c3, c4, s - 3.0);
  }
  vec3 heatColor(float t) {
    if (t < 0.5) return mix(vec3(0.97), vec3(0.96, 0.62, 0.25), t * 2.0);
    return mix(vec3(0.96, 0.62, 0.25), vec3(0.45, 0.02, 0.05), t * 2.0 - 1.0);
  }
  vec3 hueColor(float n) {
    float h = fract(n * 0.618034) * 6.0;
    vec3 c = clamp(vec3(abs(h - 3.0) - 1.0, 2.0 - abs(h - 2.0), 2.0 - abs(h - 4.0)), 0.0, 1.0);
    return mix(vec3(0.75), c, 0.55) * (0.7 + 0.3 * fract(n * 0.37));
  }
  void main() {
    vec3 unit = (vPlace - low) / extent;
    vec3 color = vec3(0.55);
    if (vMapped > 0.5 || layer == 3) {
      if (layer == 0) {
        color = baseColor * vColor;
        if (hasImage) color *= texture2D(image, vUv).rgb;
      } else if (layer == 1) {
        color = 0.1 + 0.85 * unit;
      } else if (layer == 2) {
        vec3 cell = floor(unit * 14.0);
        float odd = mod(cell.x + cell.y + cell.z, 2.0);
        color = mix(0.15 + 0.5 * unit, 0.45 + 0.55 * unit, odd);
      } else if (layer == 3) {
        float line = abs(fract(vAdf * 16.0) - 0.5);
        color = fieldColor(vAdf) * mix(0.7, 1.0, smoothstep(0.0, 0.08, line));
      } else if (layer == 4) {
        color = heatColor(vDistortion);
      } else {
        color = vPatch > 254.5 ? vec3(0.55) : hueColor(vPatch + 1.0);
      }
    }
    float light = 0.45 + 0.55 * abs(normalize(vNormal).z);
    gl_FragColor = vec4(color * light, 1.0);
  }`;

function wrapping(code) {
  if (code === 33071) return ClampToEdgeWrapping;
  return code === 33648 ? MirroredRepeatWrapping : RepeatWrapping;
}

/** Textures of the materials, by image and wrapping; `changed` is called when one has come. */
export function loadTextures(data, changed) {
  const loader = new TextureLoader();
  const made = new Map();
  return (material) => {
    if (material.image < 0 || !data.images[material.image]) return null;
    const key = `${material.image} ${material.wrap}`;
    if (!made.has(key)) {
      const texture = loader.load(data.images[material.image], changed);
      texture.colorSpace = NoColorSpace;
      texture.flipY = false;
      [texture.wrapS, texture.wrapT] = material.wrap.map(wrapping);
      texture.anisotropy = 4;
      made.set(key, texture);
    }
    return made.get(key);
  };
}

/** A mesh of the page, centred and scaled to a unit ball by its `scale` and `position`. */
export function surfaceMesh(mesh, materials, textureOf, places) {
  const geometry = new BufferGeometry();
  const count = mesh.position.length / 3;
  const add = (name, array, size, normalized = false) =>
    geometry.setAttribute(name, new BufferAttribute(array, size, normalized));
  geometry.setIndex(new BufferAttribute(mesh.index, 1));
  add('position', mesh.position, 3);
  add('normal', mesh.normal, 3, true);
  add('place', mesh.place, 3);
  add('uv', mesh.uv, 2);
  add('color8', mesh.color ?? new Uint8Array(3 * count).fill(255), 3, true);
  add('adf', mesh.adf, 1, true);
  add('distortion', mesh.distortion, 1, true);
  add('patchNumber', mesh.patch, 1);
  add('mapped', mesh.mapped, 1);
  mesh.groups.forEach(([start, size], i) => geometry.addGroup(start, size, i));
  geometry.computeBoundingSphere();
  const shaders = mesh.groups.map(([, , m]) => {
    const texture = textureOf(materials[m]);
    return new ShaderMaterial({
      vertexShader,
      fragmentShader,
      side: DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
      uniforms: {
        layer: { value: 0 },
        image: { value: texture ?? new Texture() },
        hasImage: { value: texture !== null },
        baseColor: { value: new Vector3(...materials[m].color.map((c) => Math.pow(c, 1 / 2.2))) },
        low: { value: new Vector3(...places.low) },
        extent: { value: places.size },
      },
    });
  });
  const object = new Mesh(geometry, shaders);
  const { center, radius } = geometry.boundingSphere;
  object.scale.setScalar(1 / radius);
  object.position.copy(center).multiplyScalar(-1 / radius);
  object.updateMatrixWorld();
  return object;
}
