// The keys of the page, and which of them belong to the controls.

/** Where keys are text: there they are left alone. */
const TEXTS = "textarea, [contenteditable], input:not([type]), input[type=text], input[type=search], input[type=number]";
const TAKES_ARROWS = "select, #sliders input";

/**
 * Whether a control takes a key for itself. The space bar plays wherever the focus is, but in texts: controls that
 * were reached by the tabulator are used by Enter.
 */
function takes(target, key) {
  return target.closest?.(key === " " ? TEXTS : `${TEXTS}, ${TAKES_ARROWS}`);
}

/** Counts how often the space bar is pressed before the page can play; the function that is returned ends that. */
export function waitForSpace() {
  let presses = 0;
  const press = (event) => {
    if (event.key !== " " || event.repeat || takes(event.target, " ")) return;
    event.preventDefault();
    presses++;
  };
  document.addEventListener("keydown", press);
  return () => {
    document.removeEventListener("keydown", press);
    return presses;
  };
}

/**
 * Gives the keys back to the page after a control was used by the pointer: it loses the focus. A control that
 * was reached by the tabulator keeps its arrows, as long as it has the focus.
 */
export function releaseControls() {
  let byPointer = false;
  const release = (event) => {
    // A select is used when its choice changes: a click only opens its list.
    const isOpen = event.type === "click" && event.target.closest("select");
    if (byPointer && !isOpen) document.activeElement?.blur();
  };
  document.addEventListener("pointerdown", () => (byPointer = true), true);
  document.addEventListener("keydown", (event) => event.key === "Tab" && (byPointer = false), true);
  document.addEventListener("click", release);
  document.addEventListener("change", release);
}

/** Calls the act of a key that is pressed, unless a control takes the key for itself. */
export function listenToKeys(acts) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || takes(event.target, event.key)) return;
    // The space bar does not turn boxes on and off, so that Enter does.
    if (event.key === "Enter" && event.target.matches?.("input[type=checkbox]")) {
      event.preventDefault();
      event.target.click();
      return;
    }
    // Some keyboards repeat a key that is held.
    if (event.key === " " && event.repeat) return event.preventDefault();
    const act = acts[event.key] ?? acts[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act(event.shiftKey);
  });
  // Some browsers press a button when the space bar is let go.
  document.addEventListener("keyup", (event) => {
    if (event.key === " " && !takes(event.target, " ")) event.preventDefault();
  });
}
