// The pressure of a gas against its volume.

import assert from "node:assert/strict";
import test from "node:test";
import { axisOf, placesOf, pressuresAndVolumes } from "../src/against.js";

const series = (name, unit, values) => ({ name, unit, values, times: values.map((_, k) => k) });

test("pressure and volume of a gas belong together by its name", () => {
  const list = [
    series("tip", "m", [0, 1]),
    series("air.pressure", "Pa", [101325, 101400]),
    series("air.gauge_pressure", "Pa", [0, 75]),
    series("air.volume", "m3", [1e-3, 2e-3]),
    series("gas[1].gauge_pressure", "Pa", [0, 5]),
    series("lonely.volume", "m3", [1, 1]),
  ];
  const pairs = pressuresAndVolumes(list);
  assert.deepEqual(pairs.map(({ name, pressure, volume }) => [name, pressure.name, volume.name]), [
    ["air", "air.gauge_pressure", "air.volume"],
  ]);
});

test("the axes reach from the least to the largest value, in units that suit them", () => {
  const axis = axisOf(series("air.volume", "m3", [1e-3, 2e-3, 1.5e-3]));
  assert.equal(axis.unit, "L");
  assert.deepEqual([axis.low, axis.high], [1, 2]);
  assert.deepEqual(placesOf(axis, 0, 100), [0, 100, 50]);
});

test("what does not change is in the middle of its axis", () => {
  for (const value of [0, 5]) {
    const axis = axisOf(series("air.volume", "", [value, value, value * (1 + 1e-16)]));
    placesOf(axis, 0, 100).forEach((place) => assert.ok(Math.abs(place - 50) < 1e-9));
  }
});
