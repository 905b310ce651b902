// Numbers from the texts of the document: base64, gzip, byte planes, differences in time. This is the inverse
// of io/page/src/pack.rs and quantise.rs.

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Puts the bytes of each item together again: first all first bytes, then all second bytes, ... */
function joinPlanes(planes, size) {
  const count = planes.length / size;
  const items = new Uint8Array(planes.length);
  for (let byte = 0; byte < size; byte++) {
    for (let k = 0; k < count; k++) items[k * size + byte] = planes[byte * count + k];
  }
  return items.buffer;
}

export async function doubles(text) {
  return new Float64Array(joinPlanes(await inflate(text), 8));
}

export async function indices(text) {
  return new Uint32Array(joinPlanes(await inflate(text), 4));
}

/** Integers, `rows` rows one after the other. Typed arrays wrap around as the encoder does. */
export async function rows(packed, rows) {
  const planes = await inflate(packed.data);
  const values = packed.bytes === 1 ? planes : new Uint16Array(joinPlanes(planes, 2));
  const width = values.length / rows;
  if (packed.order === 0) return values;
  for (let k = 0; k < values.length; k++) {
    const z = values[k];
    const difference = (z >> 1) ^ -(z & 1);
    const before = k >= width ? values[k - width] : 0;
    const earlier = k >= 2 * width ? values[k - 2 * width] : 0;
    values[k] = packed.order === 1 ? difference + before : difference + 2 * before - earlier;
  }
  return values;
}

/** FNV-1a of the integers, 32 bits, low byte first: what the tests compare with their own decoder. */
export function checksum(values) {
  let hash = 0x811c9dc5;
  for (const value of values) {
    hash = Math.imul(hash ^ (value & 255), 0x01000193);
    hash = Math.imul(hash ^ (value >> 8), 0x01000193);
  }
  return hash >>> 0;
}

/** The replay with typed arrays instead of texts. */
export async function decode(data) {
  const frames = data.frames;
  const [times, faces, rest, positions] = await Promise.all([
    doubles(data.times),
    indices(data.faces),
    doubles(data.rest),
    rows(data.positions, frames),
  ]);
  const bodies = await Promise.all(
    data.bodies.map(async (body) => {
      const shape = { ...body.shape };
      if (shape.kind === "mesh") {
        [shape.vertices, shape.faces] = await Promise.all([doubles(shape.vertices), indices(shape.faces)]);
      }
      return { name: body.name, shape, poses: await doubles(body.poses) };
    }),
  );
  const fields = await Promise.all(
    data.fields.map(async (field) => ({ ...field, values: await rows(field.values, frames) })),
  );
  const series = await Promise.all(
    data.series.map(async (s) => ({ ...s, times: await doubles(s.times), values: await doubles(s.values) })),
  );
  return { ...data, times, faces, rest, positions, bodies, fields, series };
}
