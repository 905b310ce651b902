// The sheet as objects of three.js: faces with two sides and edges, pins, the rest shape.
// Positions are positions on the stage: metres less a centre, divided by a size.

import {
  BackSide,
  BufferAttribute,
  BufferGeometry,
  Color,
  FrontSide,
  Group,
  InstancedMesh,
  Matrix4,
  Mesh as Surface,
  MeshStandardMaterial,
  Sphere,
  SphereGeometry,
  Vector3,
} from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { put } from "./colour.js";
import { Sides, drawEdges, edgeUniforms } from "./edges.js";
import { castOnGround } from "./ground.js";
import { Normals } from "./normals.js";
import { placing } from "./replay.js";

/** Opacity of edges at full strength. */
const STRENGTH = 0.4;
/** Largest width in pixels of edges that show a value. */
const VALUE_WIDTH = 3;
/** Radius of the balls that mark pins, on the stage and as a share of the mean length of the edges. */
const PIN_RADIUS = 0.014;
const PIN_SHARE = 0.22;
// Squares of side s with a diagonal have 3.4 s pixels of lines on s^2 pixels: 34 % for s = 10, 11 % for 30.
/** Edges that are shorter on the screen than this are invisible, in pixels. */
const FADED_LENGTH = 10;
/** Edges that are longer on the screen than this have their full strength, in pixels. */
const FULL_LENGTH = 30;

const everywhere = () => new Sphere(new Vector3(), Infinity);

export class SheetObjects {
  /** `meanLength` is the mean length of the edges on the stage. */
  constructor(replay, meanLength, colours) {
    this.replay = replay;
    const { mesh } = replay;
    this.group = new Group();
    // Three corners of its own for each face, so that a face can have a colour.
    this.corners = new BufferAttribute(new Float32Array(9 * mesh.faceCount), 3);
    this.shades = new BufferAttribute(new Float32Array(9 * mesh.faceCount).fill(1), 3);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", this.corners);
    geometry.setAttribute("color", this.shades);
    this.normals = new Normals(mesh);
    this.facing = new BufferAttribute(new Float32Array(9 * mesh.faceCount), 3);
    geometry.setAttribute("normal", this.facing);
    geometry.boundingSphere = everywhere();
    this.uniforms = edgeUniforms();
    // Each sheet has materials of its own.
    const sheets = replay.data.sheets.length > 1 ? replay.data.sheets : [mesh.faceCount];
    let first = 0;
    sheets.forEach((faces, sheet) => {
      geometry.addGroup(3 * first, 3 * faces, sheet);
      first += faces;
    });
    this.materials = [FrontSide, BackSide].map((side) =>
      sheets.map(
        () => {
          const look = { side, vertexColors: true, roughness: 0.85 };
          return drawEdges(new MeshStandardMaterial(look), this.uniforms);
        },
      ),
    );
    this.sides = new Sides(geometry, mesh.faceCount);
    const { faceEdges, hinges } = mesh;
    this.sides.show(
      () => true,
      (face, k) => hinges[2 * faceEdges[3 * face + ((k + 1) % 3)]] < 0,
    );
    this.surfaces = this.materials.map((materials) => new Surface(geometry, materials));
    // In a wireframe edges are lines, and faces draw them else.
    this.lines = makeLines(mesh.edgeCount, 1);
    Object.assign(this.lines.material, { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    this.bars = makeLines(mesh.edgeCount, 1);
    this.bars.geometry.setColors(new Float32Array(6 * mesh.edgeCount));
    this.bars.material.vertexColors = true;
    this.ghost = makeLines(mesh.edgeCount, 0.35);
    this.ghost.visible = false;
    this.mark = makeLines(1, 1);
    this.mark.material.linewidth = 5;
    this.mark.material.depthTest = false;
    this.mark.renderOrder = 1;
    this.mark.visible = false;
    const ball = new SphereGeometry(Math.min(PIN_RADIUS, PIN_SHARE * meanLength), 16, 12);
    this.pins = new InstancedMesh(
      ball,
      new MeshStandardMaterial({ roughness: 0.6 }),
      replay.data.pins.length + replay.data.immobile.length,
    );
    this.pins.frustumCulled = false;
    for (const object of this.surfaces) {
      Object.assign(object, { frustumCulled: false, castShadow: true, receiveShadow: true });
      castOnGround(object);
    }
    this.group.add(...this.surfaces, this.lines, this.bars, this.ghost, this.mark, this.pins);
    this.quantity = replay.quantities[0];
    this.showEdges = true;
    this.wireframe = false;
    this.setColours(colours);
  }

  setColours(colours) {
    this.colours = colours;
    this.ghost.material.color.set(colours.ghost);
    this.mark.material.color.set(colours.mark);
    const { pins, immobile } = this.replay.data;
    const [pin, locked] = [new Color(colours.pin), new Color(colours.locked)];
    [...pins, ...immobile].forEach((_, k) => this.pins.setColorAt(k, k < pins.length ? pin : locked));
    if (this.pins.instanceColor) this.pins.instanceColor.needsUpdate = true;
    this.setQuantity(this.quantity);
  }

  /** Colours by another quantity. Faces that show values are white beneath, beside coloured edges pale, and beside
   * coloured creases they have the two colours of their sheet. */
  setQuantity(quantity) {
    this.quantity = quantity;
    this.place = quantity.map ? placing(quantity) : null;
    const onFaces = quantity.place === "vertex" || quantity.place === "face";
    const pale = quantity.place === "edge" && !quantity.ofCreases;
    this.materials.forEach((materials, side) =>
      materials.forEach((material, sheet) => {
        const own = this.colours.sheets[sheet % this.colours.sheets.length][side];
        material.color.set(onFaces ? "#ffffff" : pale ? this.colours.pale : own);
      }),
    );
    this.lines.material.color.set(this.colours.edge);
    this.sides.colourAll(new Color(this.colours.edge).toArray());
    this.bars.visible = false;
    if (!onFaces) this.shades.array.fill(1);
    this.shades.needsUpdate = true;
  }

  /** In a wireframe, edges show what faces show else. */
  setWireframe(on) {
    this.wireframe = on;
    for (const surface of this.surfaces) surface.visible = !on;
    if (this.place) this.colour();
  }

  /** Takes over positions of the stage and the values of the frame. */
  update(x) {
    const { faces } = this.replay.mesh;
    const corners = this.corners.array;
    for (let k = 0; k < faces.length; k++) {
      const from = 3 * faces[k];
      corners[3 * k] = x[from];
      corners[3 * k + 1] = x[from + 1];
      corners[3 * k + 2] = x[from + 2];
    }
    this.corners.needsUpdate = true;
    this.normals.update(x, this.facing.array);
    this.facing.needsUpdate = true;
    this.copyEnds(x, this.lines);
    const place = new Matrix4();
    [...this.replay.data.pins, ...this.replay.data.immobile].forEach((v, k) =>
      this.pins.setMatrixAt(k, place.makeTranslation(x[3 * v], x[3 * v + 1], x[3 * v + 2])),
    );
    this.pins.instanceMatrix.needsUpdate = true;
    if (this.place) this.colour();
  }

  colour() {
    this.bars.visible = this.wireframe;
    if (this.wireframe) this.colourEdges();
    else if (this.quantity.place === "edge") this.colourSides();
    else this.colourFaces(this.replay.mesh.faces);
  }

  /** Takes over the rest shape, in positions of the stage. */
  setRest(x) {
    this.copyEnds(x, this.ghost);
  }

  /** Puts lines along all edges. */
  copyEnds(x, lines) {
    const { edges } = this.replay.mesh,
      { data } = lines.geometry.attributes.instanceStart,
      out = data.array;
    for (let k = 0; k < edges.length; k++) {
      const from = 3 * edges[k];
      out[3 * k] = x[from];
      out[3 * k + 1] = x[from + 1];
      out[3 * k + 2] = x[from + 2];
    }
    data.needsUpdate = true;
  }

  /** Puts bars with colours along the edges that have something to show. */
  colourEdges() {
    const { quantity, place } = this,
      { geometry } = this.bars,
      { edges, edgeFaces } = this.replay.mesh;
    const indexAt = { edge: (e) => e, face: (e) => edgeFaces[e], vertex: (e, end) => edges[2 * e + end] }[
      quantity.place
    ];
    const from = this.lines.geometry.attributes.instanceStart.data.array;
    const ends = geometry.attributes.instanceStart.data,
      colours = geometry.attributes.instanceColorStart.data;
    let count = 0;
    for (let e = 0; e < this.replay.mesh.edgeCount; e++) {
      const first = place(quantity.value(indexAt(e, 0)));
      if (quantity.leavesOut(first)) continue;
      for (let k = 0; k < 6; k++) ends.array[6 * count + k] = from[6 * e + k];
      put(quantity.map, first, colours.array, 6 * count);
      put(quantity.map, place(quantity.value(indexAt(e, 1))), colours.array, 6 * count + 3);
      count++;
    }
    geometry.instanceCount = count;
    ends.needsUpdate = colours.needsUpdate = true;
  }

  /** Colours the sides of faces that have something to show. */
  colourSides() {
    const { quantity, place, sides } = this,
      { faceEdges } = this.replay.mesh;
    const edge = new Color(this.colours.edge).toArray(),
      colour = [0, 0, 0];
    for (let k = 0; k < faceEdges.length; k++) {
      const at = place(quantity.value(faceEdges[k])),
        isBar = !quantity.leavesOut(at);
      if (isBar) put(quantity.map, at, colour, 0);
      // The side that begins at a corner is opposite to the last one.
      sides.colour(Math.floor(k / 3), (k + 2) % 3, isBar ? colour : edge, isBar);
    }
    sides.changed();
  }

  colourFaces(faces) {
    const { quantity, place } = this,
      shades = this.shades.array;
    const perFace = quantity.place === "face";
    for (let k = 0; k < faces.length; k++) {
      put(quantity.map, place(quantity.value(perFace ? Math.floor(k / 3) : faces[k])), shades, 3 * k);
    }
    this.shades.needsUpdate = true;
  }

  /** Fades edges by their mean length on the screen, in pixels: many thin lines would darken the sheet. */
  fade(pixels) {
    const share = Math.min(Math.max((pixels - FADED_LENGTH) / (FULL_LENGTH - FADED_LENGTH), 0), 1);
    this.bars.material.linewidth = Math.min(Math.max(pixels / 6, 1), VALUE_WIDTH);
    this.uniforms.barWidth.value = this.bars.material.linewidth;
    this.uniforms.strength.value = this.showEdges ? STRENGTH * share : 0;
    this.lines.material.opacity = STRENGTH * Math.max(share, 0.5);
    this.lines.visible = this.wireframe;
  }

  /** Marks an edge, or none for null. */
  markEdge(edge) {
    this.mark.visible = edge !== null;
    if (edge === null) return;
    const { data } = this.mark.geometry.attributes.instanceStart;
    const { array } = this.lines.geometry.attributes.instanceStart.data;
    data.array.set(array.subarray(6 * edge, 6 * edge + 6));
    data.needsUpdate = true;
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
