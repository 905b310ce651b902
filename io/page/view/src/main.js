// Starts the page: decodes the replay, connects the controls, the 3D view and the plots.

import "uplot/dist/uPlot.min.css";
import "./view.css";
import { Address } from "./address.js";
import { decode } from "./decode.js";
import { Hover } from "./hover.js";
import { listenToKeys, releaseControls, waitForSpace } from "./keys.js";
import { showLegend } from "./legend.js";
import { Live } from "./live.js";
import { LiveReplay } from "./live-replay.js";
import { Player } from "./player.js";
import { Plots } from "./plots.js";
import { Replay } from "./replay.js";
import { selfTest, watchErrors } from "./selftest.js";
import { LOOKS, Stage } from "./stage.js";
import { showTexts } from "./texts.js";
import { onThemeChange } from "./theme.js";

const $ = (id) => document.getElementById(id);
const SPEEDS = [
  [0.0625, "1/16"],
  [0.125, "1/8"],
  [0.25, "1/4"],
  [0.5, "1/2"],
  [1, "1"],
  [2, "2"],
  [4, "4"],
  [8, "8"],
];

class Page {
  constructor(replay) {
    this.replay = replay;
    showTexts(replay);
    this.stage = new Stage($("view"), replay);
    this.hover = new Hover($("view"), this.stage);
    this.player = replay.data.live ? new Live(this) : new Player(replay, () => this.changed());
    this.plots = new Plots($("plots"), replay.data.series, (time) => this.player.seekTime(time));
    this.connect();
    onThemeChange(() => {
      this.stage.applyTheme();
      this.plots.build();
    });
    this.player.seek(0);
    this.address = new Address(this);
    this.player.begin?.();
    this.changed();
    this.stage.controls.addEventListener("change", () => this.address.changed());
  }

  /** Brings everything that shows the frame up to date. */
  changed() {
    const { replay, player } = this;
    this.stage.update();
    this.hover.update(player.playing);
    this.plots.setTime(replay.time);
    $("scrub").value = replay.frame;
    $("time").textContent = player.timeText?.() ?? replay.frameText;
    $("play").textContent = player.playing ? "\u275A\u275A" : "\u25B6";
    $("play").setAttribute("aria-label", player.playing ? "Pause" : "Play");
    this.address.changed();
  }

  connect() {
    const { replay, player, stage } = this;
    $("scrub").max = replay.frames - 1;
    $("scrub").setAttribute("aria-label", replay.data.folded ? "Part of the folding" : "Frame");
    $("scrub").addEventListener("input", () => player.seek(Number($("scrub").value)));
    $("play").addEventListener("click", () => player.toggle());
    $("transport").hidden = replay.frames === 1 && !replay.data.live;
    $("speed").append(
      ...SPEEDS.map(([value, name]) => new Option(`${name}×`, value, value === 1, value === 1)),
    );
    $("speed").addEventListener("change", () => {
      player.speed = Number($("speed").value);
    });
    $("colour").append(...replay.quantities.map((q) => new Option(q.label, q.key)));
    $("colour").addEventListener("change", () => this.colourBy($("colour").value));
    $("bodies-label").hidden = replay.data.bodies.length === 0;
    $("bodies").addEventListener("change", () => this.showBodies($("bodies").value));
    $("reset").addEventListener("click", () => stage.resetCamera());
    $("fit").addEventListener("click", () => stage.frameSheet());
    const boxes = {
      edges: (on) => {
        stage.sheet.showEdges = on;
      },
      wireframe: (on) => stage.sheet.setWireframe(on),
      rest: (on) => {
        stage.sheet.ghost.visible = on;
      },
      loop: (on) => {
        player.loops = on;
      },
    };
    for (const [id, act] of Object.entries(boxes)) {
      $(id).addEventListener("change", () => {
        act($(id).checked);
        stage.request();
        this.address.changed();
      });
    }
    releaseControls();
    const step = (frames) => (isTen) => player.step?.(frames) ?? player.seek(replay.frame + (isTen ? 10 : 1) * frames);
    listenToKeys({
      " ": () => player.toggle(),
      ArrowLeft: step(-1),
      ArrowRight: step(1),
      Home: () => player.seek(0),
      End: () => player.seek(replay.frames - 1),
      r: () => stage.resetCamera(),
      f: () => stage.frameSheet(),
    });
  }

  colourBy(key) {
    const quantity = this.replay.quantities.find((q) => q.key === key) ?? this.replay.quantities[0];
    $("colour").value = quantity.key;
    this.stage.setQuantity(quantity);
    showLegend(quantity);
    this.address.changed();
  }

  showBodies(look) {
    $("bodies").value = LOOKS.includes(look) ? look : LOOKS[0];
    this.stage.showBodies($("bodies").value);
    this.hover.update();
    this.address.changed();
  }
}

async function main() {
  const isTest = new URLSearchParams(location.hash.slice(1)).has("selftest");
  const exceptions = watchErrors(),
    endWaiting = waitForSpace();
  const data = await decode(JSON.parse($("replay").textContent));
  const page = new Page(data.live ? new LiveReplay(data) : new Replay(data));
  $("message").hidden = true;
  page.address.read();
  if (endWaiting() % 2 === 1) page.player.toggle();
  if (isTest)
    document.body.dataset.selftest = JSON.stringify(await selfTest(page, exceptions));
}

main().catch((error) => {
  console.error(error);
  $("message").textContent = `The page cannot be shown: ${error.message}. It needs a browser with WebGL 2.`;
  document.body.dataset.failure = String(error);
});
