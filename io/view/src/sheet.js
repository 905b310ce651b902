// The sheet as objects of three.js: faces with two sides, edges as lines of some width, pins, the rest shape.
// Positions are those of the stage: metres less a centre, divided by a size.

import {
  BackSide, BufferAttribute, BufferGeometry, FrontSide, Group, Mesh as Surface, MeshStandardMaterial, Points,
  PointsMaterial, Sphere, Vector3,
} from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { put } from "./colour.js";
import { placing } from "./replay.js";

/** Width in pixels of edges that show no value. */
const PLAIN_WIDTH = 1;
/** Largest width in pixels of edges that show a value. */
const VALUE_WIDTH = 4;
/** Edges that are shorter on the screen than this are invisible, in pixels: a pixel of line for three of face. */
const FADED_LENGTH = 4;
/** Edges that are longer on the screen than this have their full strength, in pixels. */
const FULL_LENGTH = 24;

const everywhere = () => new Sphere(new Vector3(), Infinity);

export class SheetObjects {
  constructor(replay, colours) {
    this.replay = replay;
    const { mesh } = replay;
    this.group = new Group();
    // Three corners of its own for each face, so that a face can have a colour.
    this.corners = new BufferAttribute(new Float32Array(9 * mesh.faceCount), 3);
    this.shades = new BufferAttribute(new Float32Array(9 * mesh.faceCount).fill(1), 3);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", this.corners);
    geometry.setAttribute("color", this.shades);
    geometry.boundingSphere = everywhere();
    this.materials = [FrontSide, BackSide].map((side) => new MeshStandardMaterial({
      side, vertexColors: true, flatShading: true, roughness: 0.85,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    }));
    this.surfaces = this.materials.map((material) => new Surface(geometry, material));
    this.lines = makeLines(mesh.edgeCount, 1);
    this.lines.material.vertexColors = true;
    this.ends = new Float32Array(6 * mesh.edgeCount);
    this.lineColours = new Float32Array(6 * mesh.edgeCount);
    this.ghost = makeLines(mesh.edgeCount, 0.35);
    this.ghost.visible = false;
    this.mark = makeLines(1, 1);
    this.mark.material.linewidth = 5;
    this.mark.visible = false;
    this.pins = new Points(new BufferGeometry(), new PointsMaterial({ size: 9, sizeAttenuation: false }));
    this.pinPositions = new BufferAttribute(new Float32Array(3 * replay.data.pins.length), 3);
    this.pins.geometry.setAttribute("position", this.pinPositions);
    this.pins.visible = replay.data.pins.length > 0;
    this.pins.frustumCulled = false;
    for (const object of this.surfaces) object.frustumCulled = false;
    this.group.add(...this.surfaces, this.lines, this.ghost, this.mark, this.pins);
    this.quantity = replay.quantities[0];
    this.showEdges = true;
    this.setColours(colours);
  }

  setColours(colours) {
    this.colours = colours;
    this.ghost.material.color.set(colours.ghost);
    this.mark.material.color.set(colours.mark);
    this.pins.material.color.set(colours.pin);
    this.setQuantity(this.quantity);
  }

  /** Colours by another quantity. Faces that show values are white beneath, those beside coloured edges are pale. */
  setQuantity(quantity) {
    this.quantity = quantity;
    this.place = quantity.map ? placing(quantity) : null;
    const onFaces = quantity.place === "vertex" || quantity.place === "face";
    const pale = quantity.place === "edge";
    const [front, back] = this.materials;
    front.color.set(onFaces ? "#ffffff" : pale ? this.colours.pale : this.colours.front);
    back.color.set(onFaces ? "#ffffff" : pale ? this.colours.pale : this.colours.back);
    this.lines.material.vertexColors = pale;
    this.lines.material.color.set(pale ? "#ffffff" : this.colours.edge);
    this.lines.material.needsUpdate = true;
    if (!onFaces) this.shades.array.fill(1);
    this.shades.needsUpdate = true;
  }

  setWireframe(on) {
    for (const surface of this.surfaces) surface.visible = !on;
  }

  /** Takes over positions of the stage and the values of the frame. */
  update(x) {
    const { faces, edges } = this.replay.mesh;
    const corners = this.corners.array;
    for (let k = 0; k < faces.length; k++) {
      const from = 3 * faces[k];
      corners[3 * k] = x[from];
      corners[3 * k + 1] = x[from + 1];
      corners[3 * k + 2] = x[from + 2];
    }
    this.corners.needsUpdate = true;
    this.copyEnds(x, this.ends);
    this.lines.geometry.attributes.instanceStart.data.needsUpdate = true;
    this.replay.data.pins.forEach((v, k) => this.pinPositions.setXYZ(k, x[3 * v], x[3 * v + 1], x[3 * v + 2]));
    this.pinPositions.needsUpdate = true;
    if (this.quantity.place === "edge") this.colourEdges(edges.length / 2);
    else if (this.place) this.colourFaces(faces);
  }

  /** Sets up the buffers of the lines; after this, their content alone changes. */
  start(x, rest) {
    this.lines.geometry.setPositions(this.copyEnds(x, this.ends));
    this.ends = this.lines.geometry.attributes.instanceStart.data.array;
    this.lines.geometry.setColors(this.lineColours);
    this.lineColours = this.lines.geometry.attributes.instanceColorStart.data.array;
    this.ghost.geometry.setPositions(this.copyEnds(rest, new Float32Array(this.ends.length)));
  }

  copyEnds(x, out) {
    const { edges } = this.replay.mesh;
    for (let k = 0; k < edges.length; k++) {
      const from = 3 * edges[k];
      out[3 * k] = x[from];
      out[3 * k + 1] = x[from + 1];
      out[3 * k + 2] = x[from + 2];
    }
    return out;
  }

  colourEdges(count) {
    const { quantity, place, lineColours } = this;
    for (let e = 0; e < count; e++) {
      put(quantity.map, place(quantity.value(e)), lineColours, 6 * e);
      lineColours.copyWithin(6 * e + 3, 6 * e, 6 * e + 3);
    }
    this.lines.geometry.attributes.instanceColorStart.data.needsUpdate = true;
  }

  colourFaces(faces) {
    const { quantity, place } = this, shades = this.shades.array;
    const perFace = quantity.place === "face";
    for (let k = 0; k < faces.length; k++) {
      put(quantity.map, place(quantity.value(perFace ? Math.floor(k / 3) : faces[k])), shades, 3 * k);
    }
    this.shades.needsUpdate = true;
  }

  /** Fades edges by their mean length on the screen, in pixels: many thin lines would darken the sheet. */
  fade(pixels) {
    const strength = Math.min(Math.max((pixels - FADED_LENGTH) / (FULL_LENGTH - FADED_LENGTH), 0), 1);
    const { material } = this.lines;
    if (this.quantity.place === "edge") {
      material.linewidth = Math.min(Math.max(pixels / 6, 1), VALUE_WIDTH);
      material.opacity = 1;
      this.lines.visible = true;
    } else {
      material.linewidth = PLAIN_WIDTH;
      material.opacity = 0.6 * strength;
      this.lines.visible = (this.showEdges && strength > 0) || !this.surfaces[0].visible;
      if (!this.surfaces[0].visible) material.opacity = Math.max(material.opacity, 0.25);
    }
  }

  /** Marks an edge, or none for null. */
  markEdge(edge) {
    this.mark.visible = edge !== null;
    if (edge !== null) this.mark.geometry.setPositions(this.ends.slice(6 * edge, 6 * edge + 6));
  }
}

function makeLines(count, opacity) {
  const material = new LineMaterial({ linewidth: 1, transparent: true, opacity });
  const geometry = new LineSegmentsGeometry();
  geometry.setPositions(new Float32Array(6 * count));
  const lines = new LineSegments2(geometry, material);
  lines.frustumCulled = false;
  return lines;
}
