// At which frame the page opens, and from which side the camera looks. Nothing here needs a browser.

/** Frames, faces and vertices that are looked at: more change nothing that can be seen. */
const MOST_FRAMES = 12,
  MOST_FACES = 5000,
  MOST_VERTICES = 2000;
/** Where the camera looks from if no other side shows much more, in axes (right, depth, up). */
const USUAL_SIDE = [0.55, -1, 0.5];
/** Other sides: so many around the sheet, at each of these heights above the horizon, in degrees. */
const AROUND = 16,
  HEIGHTS = [15, 30, 50];
/** The share of the most that can be seen which the usual side has to show. */
export const ENOUGH = 0.85;
/** The same beside bodies, which a sheet may hide that is looked at from above. */
export const ENOUGH_BESIDE_BODIES = 0.5;
/** A half-space hides what is behind it, which is seen from this side of its surface alone (a sine). */
const ABOVE = 0.1;

/** Every so many of `count` things, so that there are at most `most`. */
const stride = (count, most) => Math.max(1, Math.ceil(count / most));

/** Up to `MOST_FRAMES` frames, the first and the last among them. */
function someFrames(frames) {
  const last = frames - 1,
    parts = Math.min(last, MOST_FRAMES - 1);
  return Array.from({ length: parts + 1 }, (_, k) => (parts === 0 ? 0 : Math.round((k * last) / parts)));
}

/**
 * The frame at which the sheet is farthest from where it was at first, in the mean of the squares: the first one of
 * them. Of a sheet that does not move it is the first frame.
 */
export function frameOfMotion(replay) {
  const { step, positions, vertices } = replay.data;
  if (replay.frames < 2) return 0;
  const width = 3 * vertices,
    every = 3 * stride(vertices, MOST_VERTICES);
  // What differs by a step of the positions has not moved.
  let frame = 0,
    most = Math.ceil(vertices / (every / 3)) * 3;
  for (let k = 1; k < replay.frames; k++) {
    let sum = 0;
    for (let v = 0; v < width; v += every) {
      for (let c = v; c < v + 3; c++) sum += (positions[k * width + c] - positions[c]) ** 2;
    }
    if (sum > most) [frame, most] = [k, sum];
  }
  return step > 0 ? frame : 0;
}

/** Unit vectors of axes (right, depth, up) as vectors of space, where `up` is the number of the axis upward. */
function inSpace([right, depth, above], up) {
  const side = [0, 0, 0],
    length = Math.hypot(right, depth, above);
  side[(up + 1) % 3] = right / length;
  side[(up + 2) % 3] = depth / length;
  side[up] = above / length;
  return side;
}

/** The sides that the camera may look from, the usual one first. */
export function sides(up) {
  const made = [inSpace(USUAL_SIDE, up)];
  for (const height of HEIGHTS) {
    const above = Math.tan((height * Math.PI) / 180);
    for (let k = 0; k < AROUND; k++) {
      const angle = (2 * Math.PI * k) / AROUND;
      made.push(inSpace([Math.cos(angle), Math.sin(angle), above], up));
    }
  }
  return made;
}

/** Twice the area of a sheet as it is seen from each side, both sides of the sheet alike. */
export function projectedAreas(x, faces, from) {
  const areas = new Float64Array(from.length),
    every = 3 * stride(faces.length / 3, MOST_FACES);
  for (let f = 0; f < faces.length; f += every) {
    const [a, b, c] = [faces[f], faces[f + 1], faces[f + 2]].map((v) => 3 * v);
    const [u, v] = [b, c].map((end) => [0, 1, 2].map((k) => x[end + k] - x[a + k]));
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    from.forEach((d, k) => (areas[k] += Math.abs(n[0] * d[0] + n[1] * d[1] + n[2] * d[2])));
  }
  return areas;
}

/**
 * The side from which most of the sheet is seen: the product over some frames of what is seen of the most that
 * can be seen, so that the sheet is seen edge-on in none. The usual side where it shows nearly as much. Normals of
 * planes, to the side of the sheet, say from where it is seen.
 */
export function bestSide(replay, normals = [], enough = ENOUGH) {
  const from = sides(replay.up).filter((d) =>
    normals.every((n) => n[0] * d[0] + n[1] * d[1] + n[2] * d[2] > ABOVE),
  );
  const usual = sides(replay.up)[0];
  if (from.length === 0) return usual;
  const x = new Float64Array(3 * replay.data.vertices),
    scores = new Float64Array(from.length),
    frames = someFrames(replay.frames);
  for (const frame of frames) {
    const areas = projectedAreas(replay.positionsOf(frame, x), replay.data.faces, from);
    const most = Math.max(...areas);
    if (most > 0) areas.forEach((area, k) => (scores[k] += Math.log(Math.max(area / most, 1e-6)) / frames.length));
  }
  const best = scores.indexOf(Math.max(...scores));
  const first = from[0].every((c, k) => c === usual[k]) ? 0 : best;
  return scores[first] >= scores[best] + Math.log(enough) ? from[first] : from[best];
}

/** The box around the sheet in all frames, with the sheet moved so that its middle stays where it is at first. */
export function boxAboutMiddle(replay, middles) {
  const x = new Float64Array(3 * replay.data.vertices);
  const low = [Infinity, Infinity, Infinity],
    high = [-Infinity, -Infinity, -Infinity];
  for (let frame = 0; frame < replay.frames; frame++) {
    replay.positionsOf(frame, x);
    for (let k = 0; k < x.length; k++) {
      const c = k % 3,
        place = x[k] - middles[frame][c] + middles[0][c];
      if (place < low[c]) low[c] = place;
      if (place > high[c]) high[c] = place;
    }
  }
  return [low, high];
}

/**
 * How far the camera has to be from the centre of a box with these half sides, so that all of it is in a view of this
 * slope (the tangent of half of the angle of view) and aspect. The directions are unit vectors.
 */
export function distanceToFit(half, { toCamera, across, upward }, slope, aspect) {
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  let distance = 0;
  for (let k = 0; k < 8; k++) {
    const corner = half.map((side, axis) => (k & (1 << axis) ? side : -side));
    const aside = Math.max(Math.abs(dot(corner, upward)), Math.abs(dot(corner, across)) / aspect);
    distance = Math.max(distance, dot(corner, toCamera) + aside / slope);
  }
  return distance;
}
