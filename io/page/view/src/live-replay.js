// What is shown of a run that goes on: its present state, in place of the frames of a recorded one.

import { Replay } from "./replay.js";

/** Ends of the range of fold angles, in degrees: the smallest that has all angles so far. */
const FOLD_ENDS = [5, 10, 20, 45, 90, 135, 180];
/** Heights are shown between multiples of this share of the size of the sheet. */
const HEIGHT_PARTS = 0.25;

export class LiveReplay extends Replay {
  constructor(data) {
    super(data);
    this.now = data.times[0];
    this.seen = { fold: 0, low: Infinity, high: -Infinity };
    this.part = HEIGHT_PARTS * extent(data.rest);
    this.look();
  }

  get time() {
    return this.now ?? this.data.times[0];
  }

  get startFrame() {
    return 0;
  }

  get foldRange() {
    const end = FOLD_ENDS.find((e) => this.seen.fold <= e) ?? 180;
    return { range: [-end, end], open: false };
  }

  get heightRange() {
    const { low, high } = this.seen;
    return [Math.floor(low / this.part) * this.part, Math.ceil(high / this.part) * this.part];
  }

  fold(edge) {
    return Math.max(-Math.PI, Math.min(Math.PI, this.folds[edge]));
  }

  /** Takes over a state. Says whether a range of colours has changed. */
  take({ t, x, bends, poses }) {
    this.now = t;
    this.x.set(doubles(x));
    const folds = this.mesh.foldAngles(this.x, new Float64Array(this.mesh.edgeCount));
    // Of creases in sheets that bend the kinks are shown.
    if (bends) doubles(bends).forEach((bend, e) => (folds[e] -= bend));
    this.mesh.followFolds(folds, this.folds);
    this.data.bodies.forEach((body, k) => body.poses.set(poses[k]));
    return this.look();
  }

  look() {
    const ranges = () => [...this.foldRange.range, ...this.heightRange].join();
    const before = ranges(),
      { seen } = this;
    for (const fold of this.folds) {
      const size = Math.abs(fold) * (180 / Math.PI);
      if (size > seen.fold) seen.fold = size;
    }
    for (let k = this.up; k < this.x.length; k += 3) {
      if (this.x[k] < seen.low) seen.low = this.x[k];
      if (this.x[k] > seen.high) seen.high = this.x[k];
    }
    return ranges() !== before;
  }
}

/** The numbers of a text. */
function doubles(base64) {
  return new Float64Array(Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)).buffer);
}

/** The longest side of the box around some positions. */
function extent(x) {
  const low = [Infinity, Infinity, Infinity],
    high = [-Infinity, -Infinity, -Infinity];
  x.forEach((value, k) => {
    low[k % 3] = Math.min(low[k % 3], value);
    high[k % 3] = Math.max(high[k % 3], value);
  });
  return Math.max(...low.map((value, axis) => high[axis] - value));
}
