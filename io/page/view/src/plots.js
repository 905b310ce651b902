// Plots of the series over time, with a line at the time of the frame.

import uPlot from "uplot";
import { Against, pressuresAndVolumes } from "./against.js";
import { clean, largestOf, number, roundOff, suitedUnit, withUnit } from "./format.js";
import { themeColours } from "./theme.js";

const HEIGHT = 132;
/** Values of a series that grows; of more, every second one is kept. */
const MOST_VALUES = 4000;
/** Milliseconds between two drawings of plots that grow. */
const REFRESH = 250;
/** Line colours after Okabe and Ito, which readers with colour vision deficiencies tell apart. */
const LINES = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

const sameTimes = (a, b) => a.length === b.length && a.every((t, k) => t === b[k]);

/** A tick of an axis is zero where it is this share of the largest one. */
const ZERO_TICK = 1e-9;

/**
 * The sizes up to which the values of a series are round-off. Energies are compared with all energies, since they
 * become one another, and numbers without a unit with one.
 */
export function floorOf(series, all) {
  const alike = series.unit === "J" ? all.filter((s) => s.unit === "J") : [series];
  const largest = Math.max(...alike.map((s) => largestOf(s.values)));
  return roundOff(series.unit === "" ? Math.max(largest, 1) : largest);
}

/** Ticks of a linear axis as texts. */
function tickTexts(ticks, digits) {
  const largest = largestOf(ticks);
  // Ticks that are close to each other need more digits to be told apart.
  const apart = ticks.length > 1 ? Math.log10(largest / Math.abs(ticks[1] - ticks[0])) : 0;
  const enough = Math.min(Math.max(digits, Math.ceil(apart - 1e-9) + 1), 9);
  return ticks.map((tick) => number(clean(tick, ZERO_TICK * largest), enough));
}

/** Times at the ticks of an axis as texts, all in one unit. */
function timeTexts(ticks) {
  const size = largestOf(ticks);
  return ticks.map((t) => withUnit(t, "s", { size, floor: ZERO_TICK * size }));
}

/** Series that follow each other with the same unit, scale and times share a plot. */
export function groupSeries(series) {
  const groups = [];
  for (const s of series) {
    const last = groups.at(-1);
    const joins =
      last &&
      s.unit !== "" &&
      last.length < LINES.length &&
      last[0].unit === s.unit &&
      last[0].scale === s.scale &&
      sameTimes(last[0].times, s.times);
    if (joins) last.push(s);
    else groups.push([s]);
  }
  return groups;
}

export class Plots {
  /** `onTime` is called with the time in seconds at which the reader clicks or drags. */
  constructor(container, series, onTime) {
    this.container = container;
    this.groups = groupSeries(series);
    this.onTime = onTime;
    this.time = 0;
    this.nearest = nearest;
    this.build();
    new ResizeObserver(() => this.resize()).observe(container);
  }

  build() {
    this.container.replaceChildren();
    this.plots = [
      ...pressuresAndVolumes(this.groups.flat()).map((pair) => new Against(this, pair)),
      ...this.groups.map((group) => new Plot(this, group, themeColours())),
    ];
  }

  resize() {
    for (const plot of this.plots) plot.resize(this.container.clientWidth);
  }

  /** Forgets all values. */
  clear() {
    for (const s of this.groups.flat()) [s.times, s.values] = [[], []];
  }

  /** Adds a value to each of the series, in their order, and draws them anew at the next occasion. */
  append(time, values) {
    const series = this.groups.flat();
    series.forEach((s, k) => {
      s.times.push(time);
      s.values.push(values[k]);
      if (s.times.length > MOST_VALUES) {
        const thin = (list) => list.filter((_, i) => i % 2 === 0 || i === list.length - 1);
        [s.times, s.values] = [thin(s.times), thin(s.values)];
      }
    });
    this.pending ??= setTimeout(() => {
      this.pending = null;
      // A plot that had no values yet gets its axes.
      if (this.plots.some((plot) => !plot.refresh())) this.build();
      this.setTime(this.time);
    }, REFRESH);
  }

  setTime(time) {
    this.time = time;
    for (const plot of this.plots) plot.setTime(time, nearest);
  }
}

class Plot {
  constructor(plots, group, colours) {
    this.plots = plots;
    this.group = group;
    const figure = document.createElement("figure");
    this.caption = document.createElement("figcaption");
    this.labels = group.map((series, k) => {
      const name = document.createElement("span"),
        value = document.createElement("output");
      name.style.setProperty("--key", LINES[k]);
      name.className = group.length > 1 ? "key" : "";
      const entry = document.createElement("span");
      entry.append(name, " ", value);
      this.caption.append(entry, " ");
      return { name, value };
    });
    figure.append(this.caption);
    plots.container.append(figure);
    this.line = document.createElement("div");
    this.line.className = "now";
    const logarithmic = group[0].scale === "logarithmic";
    this.logarithmic = logarithmic;
    this.readValues();
    if (group[0].times.length === 0 || this.values.every((list) => list.every((v) => v === null))) {
      figure.append(Object.assign(document.createElement("p"), { textContent: "No values to plot." }));
      return;
    }
    this.plot = new uPlot(this.options(colours, logarithmic), [group[0].times, ...this.values], figure);
    this.plot.over.append(this.line);
    this.drag(this.plot.over);
  }

  readValues() {
    const suited = suitedUnit(this.group[0].unit, Math.max(...this.group.map((s) => largestOf(s.values))));
    const all = this.plots.groups.flat();
    this.values = this.group.map((s) => {
      const floor = floorOf(s, all);
      return Array.from(s.values, (v) => {
        const shown = clean(v, floor) * suited.factor;
        return this.logarithmic && shown <= 0 ? null : shown;
      });
    });
    this.group.forEach(({ name }, k) => {
      this.labels[k].name.textContent = name + (suited.unit ? ` (${suited.unit})` : "");
    });
  }

  /** Takes over values that have been added; false if there is no plot for them yet. */
  refresh() {
    this.readValues();
    if (!this.plot) return this.values.every((list) => list.every((v) => v === null));
    this.plot.setData([this.group[0].times, ...this.values]);
    return true;
  }

  options(colours, logarithmic) {
    const axis = {
      stroke: colours.text,
      grid: { stroke: colours.axis, width: 1 },
      ticks: { show: false },
      font: "11px system-ui",
    };
    return {
      width: this.plots.container.clientWidth || 320,
      height: HEIGHT,
      legend: { show: false },
      cursor: { drag: { x: false, y: false, setScale: false }, points: { size: 5 }, y: false },
      // The line at the time of the frame has a place once the plot knows its own size.
      hooks: { draw: [() => this.setTime(this.plots.time)] },
      scales: {
        x: { time: false, range: this.widen },
        y: logarithmic ? { distr: 3 } : {},
      },
      axes: [
        { ...axis, size: 24, space: 60, values: (_, ticks) => timeTexts(ticks) },
        {
          ...axis,
          size: 58,
          space: 24,
          gap: 4,
          splits: logarithmic ? (_, __, low, high) => decades(low, high) : undefined,
          filter: logarithmic ? (_, ticks) => ticks : undefined,
          values: (_, ticks) => (logarithmic ? ticks.map((v) => number(v, 3)) : tickTexts(ticks, 3)),
        },
      ],
      series: [
        {},
        ...this.group.map((_, k) => ({
          stroke: this.group.length > 1 ? LINES[k] : colours.line,
          width: 1.5,
          points: { show: this.group[0].times.length < 3 },
        })),
      ],
    };
  }

  /** The range of times, with some width when there is but one time. */
  widen(_, low, high) {
    return low === high ? [low - 0.5, high + 0.5] : [low, high];
  }

  drag(over) {
    const toTime = (event) => {
      const left = event.clientX - over.getBoundingClientRect().left;
      this.plots.onTime(this.plot.posToVal(left, "x"));
    };
    over.addEventListener("pointerdown", (event) => {
      over.setPointerCapture(event.pointerId);
      toTime(event);
    });
    over.addEventListener("pointermove", (event) => {
      if (over.hasPointerCapture(event.pointerId)) toTime(event);
    });
  }

  setTime(time) {
    if (!this.plot) return;
    const { times } = this.group[0];
    const left = this.plot.valToPos(time, "x");
    this.line.style.transform = `translateX(${left}px)`;
    this.line.hidden = left < 0 || left > this.plot.over.clientWidth;
    const k = nearest(times, time);
    this.labels.forEach(({ value }, i) => {
      const shown = this.values[i][k] ?? null;
      value.textContent = shown === null ? "\u2013" : number(shown);
    });
  }

  resize(width) {
    if (this.plot && width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: HEIGHT });
  }
}

/** At most five powers of ten between two numbers, or the numbers where there are fewer than two. */
function decades(low, high) {
  const first = Math.ceil(Math.log10(low) - 1e-9),
    last = Math.floor(Math.log10(high) + 1e-9);
  if (last <= first) return [low, high];
  const step = Math.ceil((last - first) / 4),
    powers = [];
  for (let power = first; power <= last; power += step) powers.push(10 ** power);
  return powers;
}

/** The index of the entry of an ascending list that is nearest to a value. */
function nearest(list, value) {
  let low = 0,
    high = list.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (list[middle] <= value) low = middle;
    else high = middle;
  }
  return Math.abs(list[high] - value) < Math.abs(list[low] - value) ? high : low;
}
