// A run that goes on: the server sends its states, and the page that steers sends back what is to be done.

import { number, withUnit } from "./format.js";
import { Hand } from "./hand.js";
import { Orders } from "./orders.js";

const $ = (id) => document.getElementById(id);

/** The share of real time from which a run is said to be in real time: less is not seen. */
const REAL_TIME = 0.95;

/** Makes an element with attributes and texts or elements in it. */
function element(name, attributes, ...content) {
  const made = Object.assign(document.createElement(name), attributes);
  made.append(...content);
  return made;
}

export class Live {
  constructor(page) {
    this.page = page;
    this.role = null;
    this.frame = null;
    this.plotted = null;
    this.isTouched = false;
    this.isEnded = false;
    this.orders = new Orders((status) => this.refused(status));
    this.hand = new Hand($("view"), page.stage, this.orders, () => this.steers);
    this.arrange();
  }

  get playing() {
    return this.frame?.playing ?? false;
  }

  get steers() {
    return this.role?.steers ?? false;
  }

  /** Puts the controls of the run where a recorded run has its controls. */
  arrange() {
    document.body.classList.add("live");
    $("scrub").hidden = true;
    $("speed").parentElement.hidden = true;
    $("loop-label").hidden = true;
    const button = (id, text, title, act) => {
      const made = element("button", { id, type: "button", title }, text);
      made.addEventListener("click", act);
      return made;
    };
    $("play").title = "Play or pause (space)";
    $("play").after(
      button("step", "Step", "Take one step of time (right arrow)", () => this.step(1)),
      $("time"),
      element("output", { id: "pace" }),
      element("output", { id: "role" }),
    );
    $("transport").append(button("end", "End", "End the run", () => this.orders.send("end")));
    $("view").append(element("div", { id: "notice", hidden: true, role: "status" }));
    $("keys").textContent =
      "Drag a vertex to pull at the sheet, drag beside it to turn, right drag moves, the wheel zooms. Space plays, " +
      "the right arrow takes a step, F fits the sheet, R resets.";
    this.sliders = this.page.replay.data.live.sliders.map((slider, k) => this.slider(slider, k));
    if (this.sliders.length === 0) return;
    const rows = this.sliders.map(({ row }) => row);
    const section = element("section", { id: "sliders" }, element("h2", {}, "Drive"), ...rows);
    document.querySelector("aside").prepend(section);
  }

  slider({ name, unit, low, high }, k) {
    const input = element("input", { type: "range", min: low, max: high, step: "any", id: `slider-${k}` });
    const value = element("output", {});
    const row = element("label", {}, element("span", {}, name), input, value);
    const made = { row, input, value, unit, isHeld: false };
    input.addEventListener("input", () => {
      made.isHeld = true;
      this.orders.send({ set: { slider: k, value: Number(input.value) } }, `slider-${k}`);
      value.textContent = withUnit(Number(input.value), unit);
    });
    input.addEventListener("change", () => (made.isHeld = false));
    return made;
  }

  /** Listens to the run. */
  begin() {
    this.events = new EventSource("events");
    this.events.addEventListener("role", ({ data }) => this.takeRole(JSON.parse(data)));
    this.events.addEventListener("frame", ({ data }) => {
      this.newest = JSON.parse(data);
      this.plot(this.newest);
      // Of the states that come while nothing is drawn, the newest one is shown.
      this.drawing ??= requestAnimationFrame(() => {
        this.drawing = null;
        this.take(this.newest);
      });
    });
    this.events.addEventListener("end", () => this.end("The run has ended."));
    this.events.addEventListener("error", () => this.lost());
    this.page.stage.controls.addEventListener("start", () => (this.isTouched = true));
    this.showRole();
  }

  /** Adds a state to the plots, which begin with the first one that has come. */
  plot({ t, series }) {
    const { plots } = this.page;
    if (this.plotted === null) plots.clear();
    if (t !== this.plotted) plots.append(t, series);
    this.plotted = t;
  }

  takeRole(role) {
    this.role = role;
    this.orders.viewer = role.viewer;
    this.isLost = false;
    this.showRole();
  }

  showRole() {
    const { role } = this,
      others = (role?.pages ?? 1) - 1;
    const watchers = others === 1 ? "1 other page watches" : `${others} other pages watch`;
    $("role").textContent = role?.steers ? (others > 0 ? watchers : "") : role ? "Another page steers" : "";
    for (const control of ["play", "step", "end"]) $(control).disabled = !this.steers;
    for (const { input } of this.sliders) input.disabled = !this.steers;
    if (!this.steers) this.hand.letGo();
  }

  /** Shows a state. */
  take(frame) {
    const { page } = this;
    this.frame = frame;
    const isWider = page.replay.take(frame);
    page.stage.placeBodies();
    if (isWider) page.colourBy($("colour").value);
    page.changed();
    this.hand.show(frame.hand);
    // Until the reader turns the camera, it goes back as far as the sheet needs.
    if (!this.isTouched && !this.hand.held && page.stage.keepInView()) page.address.start = page.stage.cameraText();
    this.sliders.forEach(({ input, value, unit, isHeld }, k) => {
      if (isHeld) return;
      input.value = frame.sliders[k];
      value.textContent = withUnit(frame.sliders[k], unit);
    });
    $("pace").textContent = frame.playing ? paceText(frame.pace) : "paused";
    $("pace").dataset.real = String(frame.pace >= REAL_TIME);
    this.notify(frame.notice);
  }

  notify(notice) {
    $("notice").hidden = !notice;
    if (!notice) return;
    $("notice").textContent = notice.text;
    $("notice").dataset.kind = notice.kind;
  }

  /** The browser tries to come back by itself. */
  lost() {
    // The answer to the command that ends a run may be cut off by the end.
    if (this.isEnded) return;
    if (this.events.readyState === EventSource.CLOSED) return this.end("The run has ended, or another page is at its address.");
    this.isLost = true;
    this.role = null;
    this.showRole();
    this.notify({ kind: "problem", text: "The connection to the run is lost." });
  }

  end(text) {
    this.isEnded = true;
    this.events.close();
    if (this.drawing) {
      cancelAnimationFrame(this.drawing);
      this.take(this.newest);
    }
    this.role = null;
    this.showRole();
    this.frame = { ...this.frame, playing: false };
    $("pace").textContent = "ended";
    this.notify({ kind: "note", text });
    this.page.changed();
  }

  refused(status) {
    if (status === null) this.lost();
  }

  timeText() {
    return withUnit(this.page.replay.time, "s");
  }

  toggle() {
    if (this.steers) this.orders.send(this.playing ? "pause" : "play");
  }

  /** Takes one step forward; there is none back. */
  step(frames) {
    if (this.steers && frames > 0 && !this.playing) this.orders.send("step");
    return true;
  }

  // The present state is the only one.
  open() {}
  seek() {}
  seekTime() {}
}

/** How fast a run is beside the clock on the wall. */
export function paceText(pace) {
  if (pace === null) return "plays";
  return pace >= REAL_TIME ? "real time" : `${number(pace, 2)} of real time`;
}
