// The scale of colours with its ends and its unit.

import { drawMap } from "./colour.js";
import { number } from "./format.js";

const $ = (id) => document.getElementById(id);

export function showLegend(quantity) {
  $("legend").hidden = !quantity.map;
  if (!quantity.map) return;
  $("legend").title = quantity.note ?? "";
  const [low, high] = quantity.range();
  $("legend-name").textContent =
    quantity.label +
    (quantity.unit ? ` (${quantity.unit})` : "") +
    (quantity.scale === "logarithmic" ? ", logarithmic" : "");
  drawMap(quantity.map, $("legend-bar"));
  const middle = quantity.scale === "logarithmic" ? Math.sqrt(low) * Math.sqrt(high) : (low + high) / 2;
  const { below, above } = quantity.open?.() ?? {};
  const ticks = [
    (below ? "\u2264 " : "") + number(low, 3),
    number(middle, 3),
    (above ? "\u2265 " : "") + number(high, 3),
  ];
  $("legend-ticks").replaceChildren(
    ...(high > low ? ticks : ["", ticks[1], ""]).map((textContent) =>
      Object.assign(document.createElement("span"), { textContent }),
    ),
  );
}
