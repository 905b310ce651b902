// Numbers as people write them.

import assert from "node:assert/strict";
import test from "node:test";
import { clean, number, roundOff, suitedUnit, withUnit } from "../src/format.js";

test("no number has an exponent of computers, or more than four significant digits", () => {
  for (let exponent = -30; exponent <= 30; exponent++) {
    for (const factor of [1, 1.2474, -9.9996]) {
      const text = number(factor * 10 ** exponent);
      assert.doesNotMatch(text, /e/);
      const digits = text.replace(/ ?\u00d7? ?10[\u207b\u2070\u00b9\u00b2\u00b3\u2074-\u2079]+$/, "").replace(/^-?0*\.?0*|\./g, "");
      assert.ok(digits.replace(/0+$/, "").length <= 4, text);
    }
  }
  assert.equal(number(1.2474e-7), "1.247 \u00d7 10\u207b\u2077");
  assert.equal(number(1e-6), "10\u207b\u2076");
  assert.equal(number(0.0009999999), "0.001");
  assert.equal(number(99999.9), "10\u2075");
  assert.equal(number(-0), "0");
});

test("what is below the round-off of the largest value is zero", () => {
  const floor = roundOff(2.5);
  assert.equal(clean(1.247e-27, floor), 0);
  assert.equal(clean(-2.5 * Number.EPSILON, floor), 0);
  assert.equal(clean(1e-12, floor), 1e-12);
  assert.equal(withUnit(1.247e-27, "J", { floor }), "0 J");
});

test("units take the prefix that suits the value", () => {
  const cases = [
    [0.25, "m", "0.25 m"],
    [2.5e-6, "J", "2.5 \u00b5J"],
    [101325, "Pa", "101.3 kPa"],
    [4e-3, "m/s", "4 mm/s"],
    [3e-4, "N m", "300 \u00b5N m"],
    [3600, "s", "3600 s"],
    [7200000, "s", "7.2 \u00d7 10\u2076 s"],
    [1.5e-3, "m3", "1.5 L"],
    [2e-6, "m3", "2 mL"],
    [1e-3, "kg", "1 g"],
    [30, "\u00b0", "30\u00b0"],
    [1e-4, "1/m", "10\u207b\u2074 1/m"],
    [12, "", "12"],
  ];
  for (const [value, unit, text] of cases) assert.equal(withUnit(value, unit), text);
  // All values of an axis have the unit of the largest.
  assert.deepEqual(suitedUnit("J", 5e-4), { factor: 1e6, unit: "\u00b5J" });
});
