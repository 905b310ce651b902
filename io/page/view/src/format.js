// Numbers as texts, as people write them: few digits, no round-off, and units that suit their size.

/** What is this share of the largest value of a quantity is round-off. */
const ROUND_OFF = 64 * Number.EPSILON;
/** Plain digits are read at a glance from here on, and up to there. */
const SHORTEST = 1e-3,
  LONGEST = 1e5;
/** Units are left as they are for values from here on, and up to there. */
const UNIT_FROM = 1e-2,
  UNIT_TO = 1e4;
/** Units that take prefixes, and up to which power of a thousand they do. */
const PREFIXED = { m: 1, s: 0, N: 3, J: 3, Pa: 3, W: 3, Hz: 3, rad: 0 };
/** Units of areas, volumes and masses below a size, smallest last: what they are less than, the factor, the unit. */
const SMALLER = {
  m2: [[1e-2, 1e4, "cm2"], [1e-6, 1e6, "mm2"]],
  m3: [[1e-2, 1e3, "L"], [1e-5, 1e6, "mL"]],
  kg: [[1e-2, 1e3, "g"], [1e-5, 1e6, "mg"]],
};
const PREFIXES = { "-5": "f", "-4": "p", "-3": "n", "-2": "\u00b5", "-1": "m", 1: "k", 2: "M", 3: "G" };
const SMALLEST_PREFIX = -5;
const DIGITS = "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079";

/** A whole number as a power. */
function superscript(exponent) {
  return [...String(exponent)].map((c) => (c === "-" ? "\u207b" : DIGITS[c])).join("");
}

/** The largest size of some values; missing values count for nothing. */
export function largestOf(values) {
  let largest = 0;
  for (const value of values) {
    const size = Math.abs(value);
    if (size > largest && size < Infinity) largest = size;
  }
  return largest;
}

/** The size up to which values are round-off, of a quantity whose largest size in the run is given. */
export function roundOff(largest) {
  return ROUND_OFF * largest;
}

/** A value, or zero where it is no more than round-off. */
export function clean(value, floor) {
  return Math.abs(value) <= floor ? 0 : value;
}

/** At most four significant digits, and a power of ten where plain digits would be long. */
export function number(value, digits = 4) {
  if (value === null || Number.isNaN(value)) return "none";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (!(size < Infinity)) return value > 0 ? "\u221e" : "-\u221e";
  // Rounding may lead to the next power of ten.
  const rounded = Number(value.toPrecision(digits));
  if (Math.abs(rounded) >= SHORTEST && Math.abs(rounded) < LONGEST) return String(rounded);
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  const factor = String(Number(mantissa));
  const power = `10${superscript(Number(exponent))}`;
  if (factor === "1") return power;
  return factor === "-1" ? `-${power}` : `${factor} \u00d7 ${power}`;
}

/** The unit that suits values of a size, and the factor from the unit that is given to it. */
export function suitedUnit(unit, size) {
  const smaller = size > 0 && SMALLER[unit]?.findLast(([below]) => size < below);
  if (smaller) return { factor: smaller[1], unit: smaller[2] };
  const [, symbol, rest] = /^([A-Za-z]+)(.*)$/.exec(unit ?? "") ?? [];
  const plain = { factor: 1, unit: unit ?? "" };
  // A prefix of a square metre would be squared, too.
  if (!(symbol in PREFIXED) || !/^($|[ /])/.test(rest)) return plain;
  if (!(size > 0) || (size >= UNIT_FROM && size < UNIT_TO)) return plain;
  const power = Math.max(Math.floor(Math.log10(size) / 3 + 1e-9), SMALLEST_PREFIX);
  const chosen = Math.min(power, PREFIXED[symbol]);
  if (chosen === 0) return plain;
  return { factor: 1000 ** -chosen, unit: PREFIXES[chosen] + unit };
}

/** A value with its unit, which suits the value or a `size` that others share; zero up to `floor`. */
export function withUnit(value, unit, { floor = 0, size = Math.abs(clean(value, floor)), digits = 4 } = {}) {
  const suited = suitedUnit(unit, size);
  const text = number(clean(value, floor) * suited.factor, digits);
  if (value === null || Number.isNaN(value) || !suited.unit) return text;
  return suited.unit === "\u00b0" ? text + suited.unit : `${text} ${suited.unit}`;
}

/** A word with its plural. */
export function count(n, one, many) {
  return `${n} ${n === 1 ? one : many}`;
}
