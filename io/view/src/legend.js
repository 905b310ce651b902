// The scale of colours with its ends and its unit.

import { drawMap } from "./colour.js";
import { number } from "./format.js";

const $ = (id) => document.getElementById(id);

export function showLegend(quantity) {
  $("legend").hidden = !quantity.map;
  if (!quantity.map) return;
  const [low, high] = quantity.range();
  $("legend-name").textContent =
    quantity.label +
    (quantity.unit ? ` (${quantity.unit})` : "") +
    (quantity.scale === "logarithmic" ? ", logarithmic" : "");
  drawMap(quantity.map, $("legend-bar"));
  const middle = quantity.scale === "logarithmic" ? Math.sqrt(low * high) : (low + high) / 2;
  const ticks = high > low ? [low, middle, high] : ["", low, ""];
  $("legend-ticks").replaceChildren(
    ...ticks.map((value) =>
      Object.assign(document.createElement("span"), { textContent: value === "" ? "" : number(value, 3) }),
    ),
  );
}
