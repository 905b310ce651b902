// Colours of values: a sequential map (viridis), a diverging one (blue, grey, red), and one that stands out
// from paper.

// Viridis by Smith and van der Walt (CC0), every eighth part.
const VIRIDIS = [0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725];
// Diverging colours after Moreland (2009), "Diverging Color Maps for Scientific Visualization", every eighth
// part.
const COOLWARM = [0x3b4cc0, 0x688aef, 0x99baff, 0xc9d8ef, 0xdddddd, 0xf7c4ad, 0xf49a7b, 0xde614d, 0xb40426];
// Inferno by Smith and van der Walt (CC0), the first seven tenths of it, whose colours stand out from both
// sides of paper.
const INFERNO = [0x000004, 0x160b39, 0x420a68, 0x6a176e, 0x932667, 0xbc3754, 0xdd513a, 0xf37819];
const SIZE = 256;

function table(stops) {
  const srgb = new Uint8ClampedArray(3 * SIZE);
  const linear = new Float32Array(3 * SIZE);
  for (let k = 0; k < SIZE; k++) {
    const place = (k / (SIZE - 1)) * (stops.length - 1);
    const i = Math.min(Math.floor(place), stops.length - 2),
      part = place - i;
    for (let c = 0; c < 3; c++) {
      const shift = 16 - 8 * c;
      const value = ((stops[i] >> shift) & 255) * (1 - part) + ((stops[i + 1] >> shift) & 255) * part;
      srgb[3 * k + c] = value;
      const v = value / 255;
      linear[3 * k + c] = v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
    }
  }
  return { srgb, linear };
}

export const SEQUENTIAL = table(VIRIDIS);
export const DIVERGING = table(COOLWARM);
export const DARK = table(INFERNO);
/** Of what has no value, such as the fold angle of a boundary edge. */
const NONE = 0.22;

/** Writes the linear colour at `place` in [0, 1] of a map to `out[at..at + 3]`; NaN is grey. */
export function put(map, place, out, at) {
  if (Number.isNaN(place)) {
    out[at] = out[at + 1] = out[at + 2] = NONE;
    return;
  }
  const k = 3 * Math.round(Math.min(Math.max(place, 0), 1) * (SIZE - 1));
  out[at] = map.linear[k];
  out[at + 1] = map.linear[k + 1];
  out[at + 2] = map.linear[k + 2];
}

/** Draws a map from left to right into a canvas of 256 x 1 pixels. */
export function drawMap(map, canvas) {
  const context = canvas.getContext("2d");
  const image = context.createImageData(SIZE, 1);
  for (let k = 0; k < SIZE; k++) {
    for (let c = 0; c < 3; c++) image.data[4 * k + c] = map.srgb[3 * k + c];
    image.data[4 * k + 3] = 255;
  }
  context.putImageData(image, 0, 0);
}
