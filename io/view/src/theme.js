// Colours of the scheme that the reader prefers; view.css has them as variables.

const NAMES = [
  "background",
  "front",
  "back",
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

export function themeColours() {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

export function onThemeChange(act) {
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", act);
}
