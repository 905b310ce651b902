// The frame and the side that the page opens with, and that all of a motion is in view.

import assert from "node:assert/strict";
import test from "node:test";
import { bestSide, boxAboutMiddle, distanceToFit, frameOfMotion, projectedAreas, sides } from "../src/framing.js";

/** A motion of two triangles between frames of positions, as a decoded replay has it. */
function motion(frames, up = 2) {
  const step = 1e-4,
    low = [-10, -10, -10];
  const positions = Uint32Array.from(frames.flat(), (c, k) => Math.round((c - low[k % 3]) / step));
  return {
    data: { vertices: 4, faces: [0, 1, 2, 0, 2, 3], low, step, positions },
    frames: frames.length,
    up,
    positionsOf(frame, out) {
      for (let k = 0; k < 12; k++) out[k] = low[k % 3] + step * positions[12 * frame + k];
      return out;
    },
  };
}

const flat = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0];
const moved = (x, by) => x.map((c, k) => c + by[k % 3]);

test("the page opens where the sheet is farthest from where it was", () => {
  const at = (z) => moved(flat, [0, 0, z]);
  assert.equal(frameOfMotion(motion([0, 1, 3, 2].map(at))), 2);
  assert.equal(frameOfMotion(motion([0, -1, -1].map(at))), 1);
  assert.equal(frameOfMotion(motion([0, 0, 0].map(at))), 0);
  assert.equal(frameOfMotion(motion([at(0)])), 0);
});

test("the area that is seen of a plane sheet is its area times a cosine", () => {
  const from = sides(2);
  const areas = projectedAreas(flat, [0, 1, 2, 0, 2, 3], from);
  from.forEach((d, k) => assert.ok(Math.abs(areas[k] - 2 * Math.abs(d[2])) < 1e-12));
});

test("no plane sheet is looked at edge-on, whichever axis is up", () => {
  for (const up of [0, 1, 2]) {
    for (let k = 0; k < 24; k++) {
      // A plane that holds the direction upward, turned about it.
      const [s, c] = [Math.sin((k * Math.PI) / 12), Math.cos((k * Math.PI) / 12)];
      const [a, b] = [(up + 1) % 3, (up + 2) % 3];
      const x = [[0, 0], [1, 0], [1, 1], [0, 1]].flatMap(([p, q]) => {
        const corner = [0, 0, 0];
        [corner[a], corner[b], corner[up]] = [c * p, s * p, q];
        return corner;
      });
      const side = bestSide(motion([x, x], up));
      const normal = [0, 0, 0];
      [normal[a], normal[b]] = [-s, c];
      const seen = Math.abs(normal.reduce((sum, n, axis) => sum + n * side[axis], 0));
      // Sides are 22.5 degrees apart and up to 15 degrees above the plane of the normal; the usual side has 0.85 of
      // what the best one has.
      const best = Math.cos(Math.PI / 16) * Math.cos(Math.PI / 12);
      assert.ok(seen >= 0.85 * best, `${seen} of plane ${k} with axis ${up} upward`);
    }
  }
});

test("a flat sheet beside bodies is looked at from the usual side, which shows more of them", () => {
  // The usual side shows the sine of 23.7 degrees of a flat sheet, the highest one that of 50 degrees.
  const usual = sides(2)[0];
  assert.deepEqual(bestSide(motion([flat]), [], 0.5), usual);
  assert.ok(bestSide(motion([flat]))[2] > usual[2]);
});

test("nothing is looked at from behind a wall", () => {
  for (const normal of [[0, -1, 0], [0, 1, 0], [1, 0, 0]]) {
    const side = bestSide(motion([flat]), [normal]);
    assert.ok(side.reduce((sum, c, k) => sum + c * normal[k], 0) > 0);
  }
});

test("all of a box is in view at any aspect ratio", () => {
  const half = [2, 0.1, 0.7],
    slope = Math.tan((16 * Math.PI) / 180);
  for (const aspect of [0.3, 650 / 900, 1, 900 / 650, 4]) {
    for (const toCamera of sides(2)) {
      const length = Math.hypot(toCamera[0], toCamera[1]);
      const across = [-toCamera[1] / length, toCamera[0] / length, 0];
      const upward = [0, 1, 2].map((k) => {
        const [i, j] = [(k + 1) % 3, (k + 2) % 3];
        return toCamera[i] * across[j] - toCamera[j] * across[i];
      });
      const distance = distanceToFit(half, { toCamera, across, upward }, slope, aspect);
      let farthest = 0;
      for (let k = 0; k < 8; k++) {
        const corner = half.map((side, axis) => (k & (1 << axis) ? side : -side));
        const dot = (v) => v.reduce((sum, c, axis) => sum + c * corner[axis], 0);
        const depth = distance - dot(toCamera);
        farthest = Math.max(farthest, Math.abs(dot(upward)) / (slope * depth), Math.abs(dot(across)) / (slope * aspect * depth));
      }
      // The farthest corner is at the rim of the view.
      assert.ok(Math.abs(farthest - 1) < 1e-12, `${farthest}`);
    }
  }
});

test("a sheet that flies away is framed about its middle", () => {
  const frames = [0, 3, 6].map((z) => moved(flat, [z, 0, z]));
  const middles = frames.map((x) => [0, 1, 2].map((c) => (x[c] + x[3 + c] + x[6 + c] + x[9 + c]) / 4));
  const [low, high] = boxAboutMiddle(motion(frames), middles);
  [0, 0, 0].forEach((c, k) => assert.ok(Math.abs(low[k] - c) < 2e-4));
  [1, 1, 0].forEach((c, k) => assert.ok(Math.abs(high[k] - c) < 2e-4));
});
