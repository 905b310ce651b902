// The bodies that the sheet meets, as objects of three.js in metres. Their poses are set for each frame.

import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  CapsuleGeometry,
  CylinderGeometry,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  PlaneGeometry,
  Quaternion,
  ShadowMaterial,
  SphereGeometry,
  Vector3,
} from "three";
import { drawEdges, edgeUniforms, outline } from "./edges.js";
import { castOnGround } from "./ground.js";

/** Shapes of three.js stand along y, shapes of the document along z. */
const upright = (geometry) => geometry.rotateX(Math.PI / 2);

/** Edges of a body are outlined where its faces meet at more than this angle, in degrees. */
const OUTLINED = 25;

/** Gives an object the name of its colour in the theme, which sets the colour. */
const coloured = (name, object) => Object.assign(object, { name });

/** A group for a body with its surface, which draws its outline; half-spaces get theirs from `addPatch`. */
export function makeBody(body) {
  const group = new Group();
  group.name = body.name;
  if (body.shape.kind !== "half_space") {
    const material = new MeshStandardMaterial({
      roughness: 0.9,
      side: DoubleSide,
      flatShading: body.shape.kind === "mesh",
      // Of what is in the same place, the sheet is in front.
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 32,
    });
    const geometry = geometryOf(body.shape).toNonIndexed();
    group.sides = outline(geometry, OUTLINED);
    group.add(coloured("body", new Mesh(geometry, drawEdges(material, edgeUniforms()))));
    const [surface] = group.children;
    surface.position.set(...centreOf(body.shape));
    Object.assign(surface, { castShadow: true, receiveShadow: true });
    castOnGround(surface);
  }
  return group;
}

/** The centre of a shape in its own frame. */
function centreOf(shape) {
  if (shape.kind !== "mesh") return [0, 0, 0];
  const low = [Infinity, Infinity, Infinity],
    high = [-Infinity, -Infinity, -Infinity];
  shape.vertices.forEach((value, k) => {
    low[k % 3] = Math.min(low[k % 3], value);
    high[k % 3] = Math.max(high[k % 3], value);
  });
  return low.map((value, axis) => (value + high[axis]) / 2);
}

/** A shape about its centre, so that single precision has all the digits that are seen. */
function geometryOf(shape) {
  switch (shape.kind) {
    case "cuboid":
      return new BoxGeometry(...shape.half.map((h) => 2 * h));
    case "sphere":
      return upright(new SphereGeometry(shape.radius, 64, 32));
    case "cylinder":
      return upright(new CylinderGeometry(shape.radius, shape.radius, 2 * shape.half_height, 64));
    case "capsule":
      return upright(new CapsuleGeometry(shape.radius, 2 * shape.half_length, 16, 64));
    case "mesh": {
      // Coordinates are doubles, about their own centre, so that single precision has all digits that matter.
      const geometry = new BufferGeometry(),
        centre = centreOf(shape);
      const positions = Float32Array.from(shape.vertices, (value, k) => value - centre[k % 3]);
      geometry.setAttribute("position", new BufferAttribute(positions, 3));
      geometry.setIndex(new BufferAttribute(shape.faces, 1));
      return geometry;
    }
    default:
      throw new Error(`unknown shape ${shape.kind}`);
  }
}

/** Poses are seven numbers: quaternion and translation. A single pose holds for all frames. */
export function placeBody(group, body, frame) {
  const at = body.poses.length === 7 ? 0 : 7 * frame;
  const p = body.poses;
  group.quaternion.set(p[at], p[at + 1], p[at + 2], p[at + 3]).normalize();
  group.position.set(p[at + 4], p[at + 5], p[at + 6]);
}

/** The largest of 1, 2, 5 times a power of ten that is not above `length`. */
function roundLength(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  const digit = length / power;
  return (digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power;
}

/** How dark a shadow on the plane is. */
const SHADE = 0.22;

/** Cells of the grid from the middle of a patch to its rim. */
const CELLS = 10;

/**
 * The visible part of the plane of a half-space: a square patch with a grid, centred below `centre` (metres,
 * in space) where the body is in its first pose. `reach` (metres) is how far the patch has to go at least.
 */
export function addPatch(group, centre, reach) {
  const cell = roundLength((2 * reach) / CELLS);
  const half = CELLS * cell;
  const turn = new Quaternion().copy(group.quaternion).invert();
  const local = new Vector3(...centre).sub(group.position).applyQuaternion(turn);
  const x0 = Math.round(local.x / cell) * cell,
    y0 = Math.round(local.y / cell) * cell;
  const plane = new PlaneGeometry(2 * half, 2 * half).translate(x0, y0, 0);
  const surface = new MeshBasicMaterial({
    polygonOffset: true,
    polygonOffsetFactor: 2,
    polygonOffsetUnits: 9,
  });
  const points = [];
  for (let k = -CELLS; k <= CELLS; k++) {
    points.push(x0 - half, y0 + k * cell, 0, x0 + half, y0 + k * cell, 0);
    points.push(x0 + k * cell, y0 - half, 0, x0 + k * cell, y0 + half, 0);
  }
  const grid = new BufferGeometry();
  grid.setAttribute("position", new BufferAttribute(Float32Array.from(points), 3));
  const lines = new LineSegments(grid, new LineBasicMaterial());
  const shade = new ShadowMaterial({ opacity: SHADE, depthWrite: false, polygonOffset: true, polygonOffsetFactor: 1 });
  const shadow = Object.assign(new Mesh(plane, shade), { receiveShadow: true });
  group.add(coloured("floor", new Mesh(plane, surface)), coloured("grid", lines), coloured("shadow", shadow));
}
