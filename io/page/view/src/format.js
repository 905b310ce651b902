// Numbers as texts.

/** Four significant digits, with an exponent where plain digits would be long. */
export function number(value, digits = 4) {
  if (value === null || Number.isNaN(value)) return "none";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-3)
    return value
      .toExponential(digits - 1)
      .replace(/\.?0+e/, "e")
      .replace("e+", "e");
  return String(Number(value.toPrecision(digits)));
}

export function withUnit(value, unit) {
  return unit ? `${number(value)} ${unit}` : number(value);
}

/** A word with its plural. */
export function count(n, one, many) {
  return `${n} ${n === 1 ? one : many}`;
}
