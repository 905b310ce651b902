// The keys of the page, and which of them belong to the controls.

/** What takes the space bar and the arrows for itself while it has the focus. */
const TAKES_SPACE = "select, button, summary, input[type=checkbox]";
const TAKES_ARROWS = "select, #sliders input";

/**
 * Gives the keys back to the page after a control was used by the pointer: it loses the focus. A control that
 * was reached by the tabulator keeps its own keys, as long as it has the focus.
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
    const taken = event.target.closest?.(event.key === " " ? TAKES_SPACE : TAKES_ARROWS);
    if (event.ctrlKey || event.metaKey || event.altKey || taken) return;
    const act = acts[event.key] ?? acts[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act(event.shiftKey);
  });
}
