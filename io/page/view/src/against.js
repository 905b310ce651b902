// The pressure of each enclosed gas against its volume, with a point at the time of the frame.

import { clean, largestOf, number, roundOff, suitedUnit } from "./format.js";

const SVG = "http://www.w3.org/2000/svg";
const HEIGHT = 170;
/** Room for the ends of the axes, pixels: left, right, above, below. */
const ROOM = [64, 12, 8, 20];

/** The series of pressures and volumes that belong together: `NAME.gauge_pressure` and `NAME.volume`. */
export function pressuresAndVolumes(series) {
  const volumes = series.filter((s) => s.name.endsWith(".volume"));
  return volumes.flatMap((volume) => {
    const name = volume.name.slice(0, -".volume".length);
    const pressure = series.find((s) => s.name === `${name}.gauge_pressure`);
    return pressure && pressure.times.length === volume.times.length ? [{ name, pressure, volume }] : [];
  });
}

/** The values of a series in the unit that suits them, without round-off, and their ends. */
export function axisOf(series) {
  const size = largestOf(series.values);
  const suited = suitedUnit(series.unit, size);
  const values = Array.from(series.values, (v) => clean(v, roundOff(size)) * suited.factor);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  // What does not change has the middle of the axis.
  const half = high - low > roundOff(Math.max(Math.abs(low), Math.abs(high))) ? 0 : Math.abs(high) / 2 || 0.5;
  return { values, unit: suited.unit, low: low - half, high: high + half };
}

/** Places of values between two ends of a drawing. */
export function placesOf({ values, low, high }, from, to) {
  return values.map((v) => from + ((v - low) / (high - low)) * (to - from));
}

export class Against {
  constructor(plots, { name, pressure, volume }) {
    this.plots = plots;
    this.pair = { name, pressure, volume };
    this.figure = document.createElement("figure");
    this.figure.className = "against";
    plots.container.append(this.figure);
    this.resize(plots.container.clientWidth);
  }

  /** Draws the values anew. */
  draw() {
    const { name, pressure, volume } = this.pair;
    const caption = document.createElement("figcaption");
    if (pressure.values.length === 0) {
      caption.textContent = `${name}: pressure against volume`;
      this.figure.replaceChildren(caption);
      this.at = null;
      return;
    }
    const [across, up] = [axisOf(volume), axisOf(pressure)];
    caption.textContent = `${name}: pressure less that outside (${up.unit}) against volume (${across.unit})`;
    const [left, right, above, below] = ROOM;
    const ends = { x: [left, this.width - right], y: [HEIGHT - below, above] };
    const [x, y] = [placesOf(across, ...ends.x), placesOf(up, ...ends.y)];
    const svg = made("svg", { width: this.width, height: HEIGHT, role: "img", "aria-label": caption.textContent });
    const frame = { x: left, y: above, width: ends.x[1] - left, height: ends.y[0] - above, class: "frame" };
    const text = (content, attributes) => Object.assign(made("text", attributes), { textContent: content });
    this.point = made("circle", { r: 4 });
    svg.append(
      made("rect", frame),
      made("polyline", { points: x.map((v, k) => `${v.toFixed(1)},${y[k].toFixed(1)}`).join(" ") }),
      text(number(across.low), { x: ends.x[0], y: HEIGHT - 4 }),
      text(number(across.high), { x: ends.x[1], y: HEIGHT - 4, "text-anchor": "end" }),
      text(number(up.low), { x: left - 6, y: ends.y[0], "text-anchor": "end" }),
      text(number(up.high), { x: left - 6, y: above + 10, "text-anchor": "end" }),
      this.point,
    );
    this.at = { x, y };
    this.figure.replaceChildren(caption, svg);
  }

  /** Takes over values that have been added. */
  refresh() {
    this.draw();
    return true;
  }

  /** Puts the point where the gas is at a time. */
  setTime(time, nearest) {
    if (!this.at) return;
    const k = nearest(this.pair.volume.times, time);
    this.point.setAttribute("cx", this.at.x[k]);
    this.point.setAttribute("cy", this.at.y[k]);
  }

  resize(width) {
    if (width === this.width) return;
    this.width = Math.max(width || 320, 120);
    this.draw();
    this.setTime(this.plots.time, this.plots.nearest);
  }
}

function made(name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}
