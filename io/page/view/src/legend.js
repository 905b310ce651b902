// The scale of colours with its ends and its unit.

import { drawMap } from "./colour.js";
import { clean, number, suitedUnit } from "./format.js";

const $ = (id) => document.getElementById(id);

export function showLegend(quantity) {
  $("legend").hidden = !quantity.map;
  if (!quantity.map) return;
  $("legend").title = quantity.note ?? "";
  const [low, high] = quantity.range();
  const suited = suitedUnit(quantity.unit, Math.max(Math.abs(low), Math.abs(high)));
  const tick = (value) => number(clean(value, quantity.floor()) * suited.factor, 3);
  $("legend-name").textContent =
    quantity.label +
    (suited.unit ? ` (${suited.unit})` : "") +
    (quantity.scale === "logarithmic" ? ", logarithmic" : "");
  drawMap(quantity.map, $("legend-bar"));
  const middle = quantity.scale === "logarithmic" ? Math.sqrt(low) * Math.sqrt(high) : (low + high) / 2;
  const { below, above } = quantity.open?.() ?? {};
  const ticks = [
    (below ? "\u2264 " : "") + tick(low),
    tick(middle),
    (above ? "\u2265 " : "") + tick(high),
  ];
  $("legend-ticks").replaceChildren(
    ...(high > low ? ticks : ["", ticks[1], ""]).map((textContent) =>
      Object.assign(document.createElement("span"), { textContent }),
    ),
  );
}
