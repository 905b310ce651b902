// Edges that the material of the faces draws. Lines of their own beside the faces would shine through whatever lies
// closer above them than a pixel is deep.

import { BufferAttribute, EdgesGeometry } from "three";

/** Half the width of an edge in one of its faces, in pixels; where it has one face only, all of it. */
const HALF = 0.5;
const WHOLE = 1;

const VERTEX = `
attribute vec3 corner, width;
attribute vec4 side0, side1, side2;
varying vec3 vCorner, vWidth;
varying vec4 vSide0, vSide1, vSide2;
`;
const PASS_ON = `
vCorner = corner; vWidth = width;
vSide0 = side0; vSide1 = side1; vSide2 = side2;
`;
const FRAGMENT = `
uniform float strength, barWidth, pixelRatio;
varying vec3 vCorner, vWidth;
varying vec4 vSide0, vSide1, vSide2;
float ink(float corner, float width, vec4 side) {
  float pixels = corner / length(vec2(dFdx(corner), dFdy(corner)));
  float reach = width * mix(1.0, barWidth, side.a) * pixelRatio;
  return width > 0.0 ? clamp(reach + 0.5 - pixels, 0.0, 1.0) * mix(strength, 1.0, side.a) : 0.0;
}
`;
const DRAW = `
float ink0 = ink(vCorner.x, vWidth.x, vSide0), ink1 = ink(vCorner.y, vWidth.y, vSide1), ink2 = ink(vCorner.z, vWidth.z, vSide2);
gl_FragColor.rgb = mix(mix(mix(gl_FragColor.rgb, vSide0.rgb, ink0), vSide1.rgb, ink1), vSide2.rgb, ink2);
gl_FragColor.a = max(gl_FragColor.a, max(ink0, max(ink1, ink2)));
`;

/** What materials that draw edges have in common: how strong edges are, and how wide bars in pixels. */
export function edgeUniforms() {
  return { strength: { value: 1 }, barWidth: { value: 1 }, pixelRatio: { value: Math.min(window.devicePixelRatio, 2) } };
}

/** Makes a material draw the edges of its geometry. */
export function drawEdges(material, uniforms) {
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader =
      VERTEX + shader.vertexShader.replace("#include <begin_vertex>", `#include <begin_vertex>${PASS_ON}`);
    shader.fragmentShader =
      FRAGMENT + shader.fragmentShader.replace("#include <opaque_fragment>", `#include <opaque_fragment>${DRAW}`);
  };
  return material;
}

/**
 * The sides of triangles that have three corners of their own each: a width, and a colour that is plain (with the
 * strength of all edges) or that of a bar (opaque). Side k of a face is opposite to its corner k.
 */
export class Sides {
  constructor(geometry, faces) {
    this.faces = faces;
    const corners = new Float32Array(9 * faces);
    for (let k = 0; k < 9 * faces; k += 9) corners[k] = corners[k + 4] = corners[k + 8] = 1;
    geometry.setAttribute("corner", new BufferAttribute(corners, 3));
    this.width = new BufferAttribute(new Float32Array(9 * faces), 3);
    geometry.setAttribute("width", this.width);
    this.colours = [0, 1, 2].map((k) => {
      const colour = new BufferAttribute(new Float32Array(12 * faces), 4);
      geometry.setAttribute(`side${k}`, colour);
      return colour;
    });
  }

  /** Says which sides are drawn: whether a side of a face is drawn, and whether by this face alone. */
  show(isShown, isAlone) {
    const { array } = this.width;
    for (let face = 0; face < this.faces; face++) {
      for (let k = 0; k < 3; k++) {
        const width = isShown(face, k) ? (isAlone(face, k) ? WHOLE : HALF) : 0;
        for (let corner = 0; corner < 3; corner++) array[9 * face + 3 * corner + k] = width;
      }
    }
    this.width.needsUpdate = true;
  }

  /** Colours a side of a face: a linear colour, as a bar or plain. */
  colour(face, k, [r, g, b], isBar) {
    const { array } = this.colours[k];
    for (let corner = 0; corner < 3; corner++) array.set([r, g, b, isBar ? 1 : 0], 12 * face + 4 * corner);
  }

  /** Colours all sides alike, plain. */
  colourAll(colour) {
    for (let face = 0; face < this.faces; face++) for (let k = 0; k < 3; k++) this.colour(face, k, colour, false);
    this.changed();
  }

  /** After colours of sides. */
  changed() {
    for (const colour of this.colours) colour.needsUpdate = true;
  }
}

/** The sides of a geometry (without index) at which faces meet at more than an angle in degrees. */
export function outline(geometry, angle) {
  const { array } = geometry.attributes.position;
  const place = (list, k) => `${list[k]},${list[k + 1]},${list[k + 2]}`;
  const key = (p, q) => (p < q ? `${p};${q}` : `${q};${p}`);
  const sharp = new Set(),
    ends = new EdgesGeometry(geometry, angle).attributes.position.array;
  for (let k = 0; k < ends.length; k += 6) sharp.add(key(place(ends, k), place(ends, k + 3)));
  const sides = new Sides(geometry, array.length / 9);
  const isSharp = (face, k) => {
    const [p, q] = [1, 2].map((next) => place(array, 9 * face + 3 * ((k + next) % 3)));
    return sharp.has(key(p, q));
  };
  sides.show(isSharp, () => true);
  return sides;
}
