// The decoded replay: positions and values of a frame, and the quantities that the sheet can be coloured by.

import { roundOff, withUnit } from "./format.js";
import { DARK, DIVERGING, SEQUENTIAL } from "./colour.js";
import { frameOfMotion } from "./framing.js";
import { Mesh } from "./mesh.js";

const AXES = { x: 0, y: 1, z: 2 };

export class Replay {
  constructor(data) {
    this.data = data;
    this.mesh = new Mesh(data.faces, data.vertices);
    this.frames = data.frames;
    this.up = AXES[data.up];
    this.x = new Float64Array(3 * data.vertices);
    this.frame = -1;
    this.folds = new Float64Array(this.mesh.edgeCount);
    this.quantities = [
      { key: "plain", label: "Plain", place: "none" },
      foldQuantity(this),
      heightQuantity(this),
      ...data.fields.map((field, k) => fieldQuantity(this, field, k)),
    ];
    this.seek(0);
  }

  /** Positions of a frame in metres, into `out`. */
  positionsOf(frame, out) {
    const { low, step, positions } = this.data;
    const width = 3 * this.data.vertices,
      from = frame * width;
    for (let k = 0; k < width; k++) out[k] = low[k % 3] + step * positions[from + k];
    return out;
  }

  seek(frame) {
    this.frame = frame;
    this.positionsOf(frame, this.x);
    this.foldsOf(frame, this.x, this.folds);
  }

  /**
   * The fold angle of each edge in a frame with positions `x`, in radians, into `out`: of creases in sheets that
   * bend the kink, without the bend of the faces beside it.
   */
  foldsOf(frame, x, out) {
    this.mesh.foldAngles(x, out);
    const bends = this.data.fields[this.data.bends];
    if (!bends) return out;
    const decode = signedDecoder(bends),
      from = frame * this.mesh.edgeCount;
    for (let e = 0; e < this.mesh.edgeCount; e++) out[e] -= decode(bends.values[from + e]) / DEGREES;
    return out;
  }

  /**
   * The fold angle of an edge, in radians within [-pi, pi], to the side from which it came: a mountain that
   * is shut and pressed through itself is one of half a turn.
   */
  fold(edge) {
    const turns = this.turns[this.frame * this.mesh.edgeCount + edge];
    return Math.max(-Math.PI, Math.min(Math.PI, this.folds[edge] + 2 * Math.PI * turns));
  }

  /** The whole turns of each edge in each frame, of folds that are followed from the first frame on. */
  get turns() {
    return (this.foundTurns ??= foldTurns(this));
  }

  get time() {
    return this.data.times[this.frame];
  }

  /** The quantity that the sheet is coloured by at first. */
  get startColour() {
    const { colour } = this.data;
    return colour === undefined ? this.quantities[0].key : `field-${colour}`;
  }

  /** The frame that the page opens at: one in which something has happened. */
  get startFrame() {
    return (this.foundStart ??= frameOfMotion(this));
  }

  /** The time of the frame, in the unit that suits the whole motion. */
  get timeText() {
    const { times } = this.data,
      size = Math.max(Math.abs(times[0]), Math.abs(times[times.length - 1]));
    return withUnit(this.time, "s", { size, floor: roundOff(size) });
  }

  /** The fold angle that positions in steps may have in a flat sheet, degrees. */
  get foldFloor() {
    const { step, rest } = this.data;
    return (this.foundFloor ??= ((4 * step) / this.mesh.meanLength(rest)) * DEGREES);
  }

  /** What is said of the frame: of a crease pattern how far it is folded, of other runs the time. */
  get frameText() {
    const { folded } = this.data;
    const at = folded ? `${(100 * folded[this.frame]).toFixed(0)} % of the fold` : this.timeText;
    return `${at} · ${this.frame + 1}/${this.frames}`;
  }

  /** The two quantiles of each coordinate over all frames between which a share of its values lies. */
  usualRange(share) {
    const { low, step, positions } = this.data;
    return [0, 1, 2].map((axis) => {
      const histogram = new Uint32Array(65536);
      for (let k = axis; k < positions.length; k += 3) histogram[positions[k]]++;
      const outside = (positions.length / 3) * ((1 - share) / 2);
      let first = 0,
        last = 65535;
      for (let below = histogram[0]; below <= outside;) below += histogram[++first];
      for (let above = histogram[65535]; above <= outside;) above += histogram[--last];
      return [low[axis] + step * first, low[axis] + step * last];
    });
  }

  /** The mean place of the vertices in each frame, metres. */
  middles() {
    const x = new Float64Array(this.x.length);
    return Array.from({ length: this.frames }, (_, frame) => {
      const sum = [0, 0, 0];
      this.positionsOf(frame, x).forEach((c, k) => (sum[k % 3] += c));
      return sum.map((c) => c / this.data.vertices);
    });
  }

  /** The range of the fold angles in degrees, and whether there are others. */
  get foldRange() {
    return (this.foundFolds ??= foldRange(this));
  }

  /** The range of the heights, metres. */
  get heightRange() {
    return (this.foundHeights ??= heightRange(this));
  }

  /** The last frame that is not after a time. */
  frameAt(time) {
    const { times } = this.data;
    let low = 0,
      high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** The frame nearest to a time. */
  nearestFrame(time) {
    const k = this.frameAt(time),
      { times } = this.data;
    return k + 1 < times.length && times[k + 1] - time < time - times[k] ? k + 1 : k;
  }
}

// A quantity has a value for each vertex, edge or face (`place`), a range, a scale and a map of colours. Its
// place in the map is in [0, 1]; edges that `leavesOut` names by their place show nothing. A quantity
// `ofCreases` is of some edges, and is shown on the two colours of the sheet. Ranges belong to the whole
// run, so that colours mean the same in every frame; `open` says beyond which ends there are
// values. Values up to the `floor` are round-off.

/** Creases whose value differs from zero by less than this share of the range of colours show nothing. */
const FLAT = 0.01;
const DEGREES = 180 / Math.PI;

function foldQuantity(replay) {
  return {
    key: "fold",
    label: "Fold angle",
    unit: "°",
    place: "edge",
    ofCreases: true,
    map: DIVERGING,
    scale: "linear",
    open: () => ({ below: replay.foldRange.open, above: replay.foldRange.open }),
    leavesOut: farFrom(0.5),
    range: () => replay.foldRange.range,
    floor: () => replay.foldFloor,
    value: (edge) => replay.fold(edge) * DEGREES,
  };
}

/** Leaves out creases whose place is that of zero. */
function farFrom(zero) {
  return (place) => !(Math.abs(place - zero) > FLAT);
}

/** Where the values of a field are, and what shows nothing: creases with the value zero. */
function placeOf(field, zero) {
  const ofCreases = field.place === "crease";
  return { place: ofCreases ? "edge" : field.place, ofCreases, leavesOut: ofCreases ? farFrom(zero) : Number.isNaN };
}

function foldTurns(replay) {
  const x = new Float64Array(replay.x.length),
    folds = new Float64Array(replay.folds.length),
    followed = new Float64Array(replay.folds.length);
  const turns = new Int8Array(replay.frames * folds.length);
  for (let frame = 0; frame < replay.frames; frame++) {
    replay.foldsOf(frame, replay.positionsOf(frame, x), folds);
    replay.mesh.followFolds(folds, followed);
    for (let e = 0; e < folds.length; e++)
      turns[frame * folds.length + e] = Math.round((followed[e] - folds[e]) / (2 * Math.PI));
  }
  return turns;
}

/** Of the fold angles above a degree in all frames, the share that is inside the range of colours. */
const FOLDS_IN_RANGE = 0.98;
/** Bins in a degree of the histogram of fold angles. */
const BINS = 10;

/**
 * A range to both sides of zero, in degrees, that has most of the fold angles in all frames, and whether
 * there are others. A few sharp creases do not take the colours from all other folds.
 */
function foldRange(replay) {
  const x = new Float64Array(replay.x.length),
    folds = new Float64Array(replay.folds.length);
  const histogram = new Uint32Array(180 * BINS + 1);
  let count = 0,
    largest = 0;
  for (let frame = 0; frame < replay.frames; frame++) {
    replay.foldsOf(frame, replay.positionsOf(frame, x), folds);
    for (const fold of folds) {
      const size = Math.abs(fold) * DEGREES;
      if (!(size > 1)) continue;
      histogram[Math.min(Math.ceil(size * BINS), 180 * BINS)]++;
      count++;
      largest = Math.max(largest, size);
    }
  }
  let bin = -1;
  for (let within = 0; within < FOLDS_IN_RANGE * count;) within += histogram[++bin];
  // Of a sheet that stays flat, a range below a degree would show how the positions were rounded.
  const end = Math.max(bin / BINS, 1);
  return { range: [-end, end], open: largest > end };
}

function heightRange(replay) {
  const { low, step, positions } = replay.data;
  let largest = 0;
  for (let k = replay.up; k < positions.length; k += 3) if (positions[k] > largest) largest = positions[k];
  return [low[replay.up], low[replay.up] + step * largest];
}

function heightQuantity(replay) {
  return {
    leavesOut: Number.isNaN,
    key: "height",
    label: `Height (${replay.data.up})`,
    unit: "m",
    place: "vertex",
    map: SEQUENTIAL,
    scale: "linear",
    range: () => replay.heightRange,
    floor: () => replay.data.step / 2,
    value: (vertex) => replay.x[3 * vertex + replay.up],
  };
}

function fieldQuantity(replay, field, k) {
  if (field.scale === "signed" || field.scale === "magnitude") return forceQuantity(replay, field, k);
  const { low, step, values } = field;
  const width = values.length / replay.frames;
  const logarithmic = field.scale === "logarithmic";
  let largest = 0;
  for (const value of values) if (value > largest) largest = value;
  const decode = logarithmic ? (q) => (q === 0 ? 0 : 10 ** (low + step * (q - 1))) : (q) => low + step * q;
  return {
    key: `field-${k}`,
    label: field.name,
    note: field.note,
    unit: field.unit,
    ...placeOf(field, 0),
    map: field.place === "crease" ? DARK : SEQUENTIAL,
    scale: field.scale,
    range: () => [field.place === "crease" ? 0 : decode(logarithmic ? Math.min(1, largest) : 0), decode(largest)],
    floor: () => Math.max(roundOff(Math.max(Math.abs(decode(0)), Math.abs(decode(largest)))), logarithmic ? 0 : step / 2),
    value: (index) => decode(values[replay.frame * width + index]),
  };
}

/** The share of the values that are not zero that is inside the range of colours. */
const FORCES_IN_RANGE = 0.98;
/** Integers from here on stand for negative values. */
const NEGATIVE = 32768;

/** What makes sizes of the integers of a field that has signs or magnitudes. */
function sizeDecoder({ low, step }) {
  return (q) => (q === 0 ? 0 : 10 ** (low + step * (q - 1)));
}

/** The same for values of either sign. */
function signedDecoder(field) {
  const size = sizeDecoder(field);
  return (q) => (q < NEGATIVE ? size(q) : -size(q - NEGATIVE));
}

/** A field whose values differ by orders of magnitude, such as forces: of either sign, or magnitudes. */
function forceQuantity(replay, field, k) {
  const { values } = field;
  const width = values.length / replay.frames;
  const size = sizeDecoder(field);
  const decode = signedDecoder(field);
  const hasSigns = field.scale === "signed";
  let found = null;
  const end = () => (found ??= usualSize(values, size));
  return {
    key: `field-${k}`,
    label: field.name,
    note: field.note,
    unit: field.unit,
    ...placeOf(field, hasSigns ? 0.5 : 0),
    map: hasSigns ? DIVERGING : SEQUENTIAL,
    scale: "linear",
    open: () => ({ below: hasSigns && end().open, above: end().open }),
    range: () => [hasSigns ? -end().size : 0, end().size],
    floor: () => roundOff(end().largest),
    value: (index) => decode(values[replay.frame * width + index]),
  };
}

/** The size that most of the values in all frames do not exceed, and whether others do. */
function usualSize(values, size) {
  const histogram = new Uint32Array(NEGATIVE);
  let largest = 0;
  for (const q of values) {
    const k = q % NEGATIVE;
    histogram[k]++;
    if (k > largest) largest = k;
  }
  const count = values.length - histogram[0];
  let last = 0;
  for (let within = 0; within < FORCES_IN_RANGE * count;) within += histogram[++last];
  return { size: size(last), largest: size(largest), open: largest > last };
}

/** The function from values to places in [0, 1]; zeros of a logarithmic scale are at its low end. */
export function placing(quantity) {
  const [low, high] = quantity.range();
  if (!(high > low)) return () => 0.5;
  if (quantity.scale === "logarithmic") {
    const from = Math.log(low),
      length = Math.log(high) - from;
    return (value) => (value > 0 ? (Math.log(value) - from) / length : 0);
  }
  return (value) => (value - low) / (high - low);
}
