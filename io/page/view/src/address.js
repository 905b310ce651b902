// What is shown, in the fragment of the address: `index.html#frame=20&colour=fold&camera=1,-2,1,0,0,0`. An
// address that is copied from the browser shows the same again.

/** Milliseconds after the last change until the address follows: browsers refuse many changes in a short time. */
const DELAY = 250;

/** The boxes with their states at the start. */
const BOXES = { edges: true, wireframe: false, rest: false, loop: false };

const $ = (id) => document.getElementById(id);

export class Address {
  constructor(page) {
    this.page = page;
    window.addEventListener("hashchange", () => this.read());
  }

  /** Shows what the address names, and all else as it is at the start. */
  read() {
    const { page } = this,
      choices = new URLSearchParams(location.hash.slice(1));
    page.colourBy(choices.get("colour") ?? page.replay.startColour);
    page.showBodies(choices.get("bodies"));
    page.stage.resetCamera();
    if (choices.has("camera")) {
      page.stage.lookFrom(choices.get("camera").split(",").map(Number));
      page.player.isTouched = true;
    }
    const frame = choices.has("frame") ? Number(choices.get("frame")) : NaN;
    if (Number.isNaN(frame)) page.player.open(page.replay.startFrame);
    else page.player.seek(frame);
    for (const [id, start] of Object.entries(BOXES)) {
      const isOn = choices.has(id) ? choices.get(id) === "1" : start;
      if ($(id).checked !== isOn) $(id).click();
    }
  }

  /** Something is shown that may differ from what the address names. */
  changed() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.write(), DELAY);
  }

  write() {
    const { replay, stage } = this.page;
    const entries = [
      ["frame", replay.frame, replay.startFrame],
      ["colour", $("colour").value, replay.startColour],
      ["bodies", $("bodies").value, $("bodies").options[0].value],
      ["camera", stage.isAtStart ? "" : stage.cameraText(), ""],
      ...Object.entries(BOXES).map(([id, start]) => [id, Number($(id).checked), Number(start)]),
    ];
    const named = entries.filter(([, value, start]) => value !== start);
    const fragment = named.map(([name, value]) => `${name}=${value}`).join("&");
    const address = fragment ? `#${fragment}` : location.pathname + location.search;
    try {
      history.replaceState(null, "", address);
    } catch (error) {
      // Some pages inside of others may not change their address; nothing else depends on it.
      console.warn(error);
    }
  }
}
