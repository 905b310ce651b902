// The texts of the page: title, summary, scene, how to make the run again, precision.

import { count, number, withUnit } from "./format.js";

const $ = (id) => document.getElementById(id);

/** Shows a text in its section, or leaves the section out when there is none. */
function section(id, text) {
  $(id).textContent = text;
  $(`${id}-section`).hidden = text === "";
}

/** A text of the program, whose numbers with exponents are written as people write them. */
export function readable(text) {
  return text.replace(/-?\d+(\.\d+)?e[-+]?\d+/g, (found) => number(Number(found)));
}

export function showTexts(replay) {
  const { data, mesh } = replay;
  $("title").textContent = data.title || "Run";
  const duration = data.times[data.frames - 1] - data.times[0];
  $("subtitle").textContent = [
    count(data.vertices, "vertex", "vertices"),
    count(mesh.edgeCount, "edge", "edges"),
    count(mesh.faceCount, "face", "faces"),
    data.live
      ? "live"
      : count(data.frames, "frame", "frames") + (data.frames > 1 ? ` over ${withUnit(duration, "s")}` : ""),
  ].join(" · ");
  const rows = data.summary.map(([name, value]) => {
    const row = document.createElement("tr");
    const head = Object.assign(document.createElement("th"), { textContent: name, scope: "row" });
    row.append(head, Object.assign(document.createElement("td"), { textContent: readable(value) }));
    return row;
  });
  $("summary").replaceChildren(...rows);
  $("summary-section").hidden = rows.length === 0;
  section("scene", data.scene);
  section("reproduce", data.reproduce);
  $("footer").replaceChildren(
    ...[
      `${data.program} ${data.version}.`,
      data.live ? "" : `Positions are rounded to ${withUnit(data.step / 2, "m", { digits: 2 })} in each coordinate.`,
      data.stride > 1
        ? `Has one in ${data.stride} of the ${data.frames_of_run} frames of the run, and the last one.`
        : "",
    ].map((text) => Object.assign(document.createElement("p"), { textContent: text })),
  );
}
