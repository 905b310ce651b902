// What `#selftest=1` measures. The result is JSON in the attribute data-selftest of the body, for tests that
// run a browser without a window. Time may stand still there, so nothing here depends on a clock.

import { checksum } from "./decode.js";
import { describe } from "./hover.js";
import { LOOKS } from "./stage.js";

/** Collects what goes wrong from now on. */
export function watchErrors() {
  const found = [];
  window.addEventListener("error", (event) => found.push(String(event.message)));
  window.addEventListener("unhandledrejection", (event) => found.push(String(event.reason)));
  return found;
}

/** Draws and reads the picture: its hash and the share of pixels that are not background. */
function picture(stage) {
  stage.render();
  const gl = stage.renderer.getContext();
  const { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
  const pixels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  const words = new Uint32Array(pixels.buffer),
    background = backgroundOf(words, width, height);
  let hash = 0x811c9dc5,
    covered = 0;
  for (const word of words) {
    if (word !== background) covered++;
    hash = Math.imul(hash ^ word, 0x01000193);
  }
  return { hash: hash >>> 0, covered: covered / words.length, error: gl.getError() };
}

/** The colour that most of the four corners of the picture have. */
function backgroundOf(words, width, height) {
  const corners = [words[0], words[width - 1], words[width * (height - 1)], words[width * height - 1]];
  return corners.sort(
    (a, b) => corners.filter((c) => c === b).length - corners.filter((c) => c === a).length,
  )[0];
}

/** The number of distinct pictures that `acts` lead to; the pictures are added to `log`. */
function distinct(stage, acts, log) {
  const pictures = acts.map((act) => {
    act();
    return picture(stage);
  });
  log.push(...pictures);
  return new Set(pictures.map((p) => p.hash)).size;
}

/** Looks for the sheet under a grid of places, and at what the hover text says there. */
function hoverSomewhere(page) {
  const { container } = page.stage,
    parts = 24;
  for (let i = 1; i < parts * parts; i++) {
    const place = [
      ((i % parts) / parts) * container.clientWidth,
      (Math.floor(i / parts) / parts) * container.clientHeight,
    ];
    const found = page.hover.show(...place);
    if (found?.face !== undefined)
      return { ...found, lines: describe(page.replay, found), shown: !page.hover.box.hidden };
  }
  return null;
}

/** Whether the picture changes when a body is taken away. */
function bodiesShow(stage) {
  const whole = picture(stage).hash;
  return stage.bodyGroups.map((group) => {
    group.visible = false;
    const without = picture(stage).hash;
    group.visible = true;
    return { name: group.name, shows: whole !== without };
  });
}

/** Presses a key on the page and says which frame is shown then. */
function press(page, key) {
  document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  return page.replay.frame;
}

/** What was decoded and computed, for a comparison with the program that made the page. */
function numbers(replay) {
  const { data, mesh, quantities } = replay;
  return {
    vertices: data.vertices,
    edges: mesh.edgeCount,
    frames: replay.frames,
    checksum: checksum(data.positions),
    fieldChecksums: data.fields.map((f) => checksum(f.values)),
    positions: Array.from(replay.x),
    folds: Array.from(replay.folds, (_, e) => replay.fold(e)).map((a) => (Number.isNaN(a) ? null : a)),
    edgeEnds: Array.from(mesh.edges),
    values: quantities.filter((q) => q.key.startsWith("field-")).map((q) => q.value(0)),
    foldRange: quantities.find((q) => q.key === "fold").range(),
    usualRange: replay.usualRange(0.9),
  };
}

/** How many vertices are outside of the view at the start, in frames from the first to the last one. */
function outOfView(page) {
  const { stage, player, replay } = page,
    parts = Math.min(replay.frames - 1, 40);
  let outside = 0;
  for (let part = 0; part <= parts; part++) {
    player.seek(parts === 0 ? 0 : Math.round((part * (replay.frames - 1)) / parts));
    stage.camera.updateMatrixWorld();
    const { clientWidth, clientHeight } = stage.container;
    for (let v = 0; v < replay.data.vertices; v++) {
      const [x, y] = stage.placeOf(stage.vertexPlace(v));
      if (!(x >= 0 && y >= 0 && x <= clientWidth && y <= clientHeight)) outside++;
    }
  }
  return outside;
}

export async function selfTest(page, exceptions) {
  // Plots take their places after the code that makes them has ended.
  await new Promise((resolve) => setTimeout(resolve));
  const { replay, stage, player } = page,
    last = replay.frames - 1,
    log = [];
  const opened = { frame: replay.frame, outside: outOfView(page) };
  stage.resetCamera();
  const startColour = document.getElementById("colour").value;
  const seeks = [0, 0.25, 0.5, 0.75, 1].map((part) => Math.round(part * last));
  const frames = distinct(
    stage,
    seeks.map((k) => () => player.seek(k)),
    log,
  );
  player.seek(Math.round(last / 2));
  const orbit = [0, 1, 2, 3].map((k) => () => {
    stage.camera.position.applyAxisAngle(stage.up, k === 0 ? 0 : 0.4);
    stage.controls.update();
  });
  const views = distinct(stage, orbit, log);
  stage.resetCamera();
  const start = picture(stage);
  stage.frameSheet();
  const fitted = picture(stage);
  stage.resetCamera();
  const modes = replay.quantities.map((q) => ({ key: q.key, label: q.label }));
  const colourings = distinct(
    stage,
    modes.map((mode) => () => page.colourBy(mode.key)),
    log,
  );
  const sides = modes.map((mode) => {
    page.colourBy(mode.key);
    return stage.sheet.materials.map(([first]) => first.color.getHexString());
  });
  const toggles = ["wireframe", "rest", "edges"].map((id) => () => document.getElementById(id).click());
  const styles = distinct(stage, [() => page.colourBy("plain"), ...toggles], log);
  for (const act of toggles) act();
  const bodies = bodiesShow(stage);
  const looks = distinct(
    stage,
    LOOKS.map((look) => () => page.showBodies(look)),
    log,
  );
  page.showBodies(LOOKS[0]);
  const hover = hoverSomewhere(page);
  page.hover.hide();
  const keys = {
    end: press(page, "End"),
    left: press(page, "ArrowLeft"),
    home: press(page, "Home"),
    right: press(page, "ArrowRight"),
  };
  const over = document.querySelector("#plots .u-over");
  const clicked = over ? clickPlot(page, over) : null;
  const played = play(page);
  const slid = slide(page);
  stage.applyTheme();
  page.plots.build();
  player.seek(last);
  return {
    ...numbers(replay),
    pictures: { frames, views, colourings, styles, seeks: new Set(seeks).size },
    coveredAtStart: start.covered,
    coveredFitted: fitted.covered,
    covered: Math.min(...log.map((p) => p.covered)),
    glErrors: log.map((p) => p.error).filter((error) => error !== 0),
    modes,
    sides,
    bodies,
    looks,
    hover,
    keys,
    clicked,
    played,
    slid,
    opened,
    startColour,
    title: document.getElementById("title").textContent,
    scene: document.getElementById("scene").textContent,
    footer: document.getElementById("footer").textContent,
    plots: document.querySelectorAll("#plots canvas").length,
    requests: performance
      .getEntriesByType("resource")
      .map((entry) => entry.name)
      .filter((name) => !name.startsWith("data:")),
    overflow: document.documentElement.scrollWidth - window.innerWidth,
    exceptions,
  };
}

/** Moves the slider of the frames to its ends and its middle: the frame, what is said of it, and the picture. */
function slide(page) {
  const scrub = document.getElementById("scrub");
  const label = scrub.getAttribute("aria-label");
  const places = [0, 0.5, 1].map((part) => {
    scrub.value = Math.round(part * Number(scrub.max));
    scrub.dispatchEvent(new Event("input", { bubbles: true }));
    return { frame: page.replay.frame, text: document.getElementById("time").textContent, picture: picture(page.stage).hash };
  });
  return { label, places };
}

/** Plays to a little after the middle and beyond the end, once and in a loop, by a clock that starts at one second. */
function play(page) {
  const { player, replay } = page,
    { times } = replay.data,
    duration = times[times.length - 1] - times[0];
  player.seek(0);
  player.toggle();
  const starts = player.playing;
  player.tick(1000);
  player.tick(1000 + 550 * duration);
  const middle = replay.frame;
  player.tick(1001 + 1000 * duration);
  const played = { starts, middle, end: replay.frame, ends: !player.playing };
  player.loops = true;
  player.toggle();
  player.tick(1000);
  player.tick(1001 + 1000 * duration);
  player.tick(1001 + 1000 * duration);
  const again = player.playing && replay.frame;
  player.toggle();
  player.seek(replay.frames - 1);
  player.loops = false;
  return { ...played, again };
}

/** Clicks at three quarters of the width of a plot; the frame nearest to the time there has to be shown. */
function clickPlot(page, over) {
  const frame = over.getBoundingClientRect();
  const at = { clientX: frame.left + 0.75 * frame.width, clientY: frame.top + 5, bubbles: true };
  const capture = over.setPointerCapture;
  over.setPointerCapture = () => {};
  over.dispatchEvent(new PointerEvent("pointerdown", at));
  over.setPointerCapture = capture;
  return page.replay.time;
}
