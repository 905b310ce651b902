// What is under the pointer, as a text beside it.

import { clean, number, withUnit } from "./format.js";

function held({ pins, immobile }, vertex) {
  if (pins.includes(vertex)) return ", pinned";
  return immobile.includes(vertex) ? ", kept in place by its rods" : "";
}

/** The lines of the text for what Stage.pick found. */
export function describe(replay, found) {
  if (found.body !== undefined) return [`Body ${found.body}`];
  const { face, vertex, edge } = found;
  const { edges } = replay.mesh,
    x = replay.x;
  const position = [0, 1, 2].map((k) => number(clean(x[3 * vertex + k], replay.data.step / 2))).join(", ");
  const fold = replay.fold(edge) * (180 / Math.PI);
  const lines = [
    `Vertex ${vertex} at (${position}) m${held(replay.data, vertex)}`,
    `Edge ${edge}, vertices ${edges[2 * edge]} and ${edges[2 * edge + 1]}`,
    Number.isNaN(fold) ? "No fold angle: boundary" : `Fold angle ${number(clean(fold, replay.foldFloor))}°`,
    `Face ${face}`,
  ];
  for (const quantity of replay.quantities) {
    if (quantity.key.startsWith("field-")) {
      const index = { vertex, edge, face }[quantity.place];
      lines.push(`${quantity.label} (${quantity.place}): ${withUnit(quantity.value(index), quantity.unit, { floor: quantity.floor() })}`);
      if (quantity.note) lines.push(quantity.note);
    }
  }
  return lines;
}

/** Distance of the text from the pointer, in pixels. */
const GAP = 14;

export class Hover {
  constructor(container, stage) {
    this.box = document.getElementById("hover");
    this.container = container;
    this.stage = stage;
    this.found = null;
    container.addEventListener("pointermove", (event) => {
      if (event.buttons === 0) this.at(event);
    });
    container.addEventListener("pointerup", (event) => this.at(event));
    container.addEventListener("pointerleave", () => this.hide());
  }

  at(event) {
    const frame = this.container.getBoundingClientRect();
    this.show(event.clientX - frame.left, event.clientY - frame.top);
  }

  show(left, top) {
    this.found = this.stage.pick(left, top);
    this.place = [left, top];
    if (!this.found) return this.hide();
    this.refresh();
    const { clientWidth, clientHeight } = this.container,
      { box } = this;
    const x =
      left + GAP + box.offsetWidth > clientWidth ? Math.max(left - GAP - box.offsetWidth, 0) : left + GAP;
    const y =
      top + GAP + box.offsetHeight > clientHeight ? Math.max(top - GAP - box.offsetHeight, 0) : top + GAP;
    box.style.transform = `translate(${x}px, ${y}px)`;
    return this.found;
  }

  /** The values of what was found last, in the frame that is shown now. */
  refresh() {
    this.box.replaceChildren(
      ...describe(this.stage.replay, this.found).map((line) =>
        Object.assign(document.createElement("div"), { textContent: line }),
      ),
    );
    this.box.hidden = false;
    this.stage.sheet.markEdge(this.found.edge ?? null);
    this.stage.request();
  }

  hide() {
    this.found = null;
    this.box.hidden = true;
    this.stage.sheet.markEdge(null);
    this.stage.request();
    return null;
  }

  /** After a change of the frame, something else may be under the pointer. While the run plays nothing is said. */
  update(isPlaying = false) {
    if (this.found && isPlaying) this.hide();
    else if (this.found) this.show(...this.place);
  }
}
