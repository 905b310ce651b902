// Colours of the scheme that the reader prefers; view.css has them as variables.

const NAMES = [
  "background",
  "pale",
  "edge",
  "ghost",
  "mark",
  "pin",
  "locked",
  "body",
  "outline",
  "floor",
  "grid",
  "line",
  "text",
  "axis",
];

/** How many sheets have colours of their own; further ones have these by turns. */
const SHEETS = 6;

/** Colours by their names, and for `sheets` the front and the back of each. */
export function themeColours() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const sheets = Array.from({ length: SHEETS }, (_, k) => [colour(`front-${k}`), colour(`back-${k}`)]);
  return { ...Object.fromEntries(NAMES.map((name) => [name, colour(name)])), sheets };
}

export function onThemeChange(act) {
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", act);
}
