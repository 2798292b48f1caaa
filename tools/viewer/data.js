// The data that the page carries, unpacked.

function bytes(base64) {
  const text = atob(base64);
  const result = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) result[i] = text.charCodeAt(i);
  return result;
}

export function unpack(Type, base64) {
  return new Type(bytes(base64).buffer);
}

/** Places counted in 65535ths of a box's largest extent, as coordinates. */
function places(grid, base64) {
  const steps = unpack(Uint16Array, base64);
  const result = new Float32Array(steps.length);
  for (let i = 0; i < steps.length; ++i)
    result[i] = grid.low[i % 3] + (steps[i] / 65535) * grid.size;
  return result;
}

/** A mesh of the page: `place` is where each vertex comes from on the source. */
function mesh(json, sourceGrid) {
  return {
    index: unpack(Uint32Array, json.index),
    position: places(json.grid, json.position),
    normal: unpack(Int8Array, json.normal),
    place: places(sourceGrid, json.place),
    uv: unpack(Float32Array, json.uv),
    color: json.color ? unpack(Uint8Array, json.color) : null,
    adf: unpack(Uint8Array, json.adf),
    distortion: unpack(Uint8Array, json.distortion),
    patch: unpack(Uint8Array, json.patch),
    mapped: unpack(Uint8Array, json.mapped),
    seams: unpack(Float32Array, json.seams),
    groups: json.groups,
  };
}

function graph(json) {
  return {
    nodes: json.nodes,
    arcs: json.arcs.map((arc) => ({ ...arc, path: unpack(Float32Array, arc.path) })),
  };
}

function vertices(json) {
  return {
    position: unpack(Float32Array, json.position),
    number: unpack(Int32Array, json.number),
  };
}

export function readData(text) {
  const json = JSON.parse(text);
  return {
    ...json,
    maps: json.maps.map((map) => ({
      ...map,
      source: mesh(map.source, json.places),
      target: mesh(map.target, json.places),
    })),
    graphs: { source: graph(json.graphs.source), target: graph(json.graphs.target) },
    vertices: {
      source: vertices(json.vertices.source),
      target: vertices(json.vertices.target),
    },
  };
}
