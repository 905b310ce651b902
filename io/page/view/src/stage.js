// The 3D view: camera, lights, the sheet and the bodies. Positions on the stage are metres less the centre of
// what the camera frames, divided by its radius, so that single precision serves small sheets and distant
// ones alike.

import {
  Box3,
  Color,
  DirectionalLight,
  Group,
  HemisphereLight,
  PerspectiveCamera,
  Raycaster,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { addPatch, makeBody, placeBody } from "./bodies.js";
import { ENOUGH, ENOUGH_BESIDE_BODIES, bestSide, boxAboutMiddle, distanceToFit } from "./framing.js";
import { Ground } from "./ground.js";
import { SheetObjects } from "./sheet.js";
import { themeColours } from "./theme.js";

/** Vertical angle of view in degrees. */
const ANGLE_OF_VIEW = 32;
/** How much of the radius of what is framed the half-spaces reach beyond it. */
const PATCH_REACH = 1.2;
/** How much longer than the sheet what is framed may be, by its motion and by bodies. */
const LARGEST_FRAME = 2.5;
/** By how much the camera is farther away than it has to be. */
const MARGIN = 1.15;
/** The smallest distance from which the camera looks at a box, on the stage. */
const NEAREST = 0.05;
/** How far away the light is that casts shadows, how far from the middle of the stage it does, and pixels of its map. */
const SUN_DISTANCE = 5;
const SHADOW_REACH = 1.8;
const SHADOW_PIXELS = 2048;
/** How bodies can be shown. */
export const LOOKS = ["solid", "glass", "hidden"];
/** What a see-through body covers of what is behind it. */
const GLASS = 0.25;

export class Stage {
  constructor(container, replay) {
    this.container = container;
    this.replay = replay;
    this.renderer = new WebGLRenderer({ antialias: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    container.prepend(this.renderer.domElement);
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(ANGLE_OF_VIEW, 1, 0.02, 200);
    this.up = new Vector3().setComponent(replay.up, 1);
    this.camera.up.copy(this.up);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.request());
    this.controls.addEventListener("start", () => (this.isAtStart = false));
    this.colours = themeColours();
    this.look = LOOKS[0];
    this.addLights();
    this.addBodies();
    this.chooseUnits();
    this.positions = new Float32Array(replay.x.length);
    this.sheet = new SheetObjects(replay, this.meanLength, this.colours);
    this.sheet.setRest(this.toStage(replay.data.rest, new Float32Array(replay.x.length)));
    this.scene.add(this.sheet.group);
    this.raycaster = new Raycaster();
    this.applyTheme();
    this.update();
    this.resize();
    this.resetCamera();
    new ResizeObserver(() => this.resize()).observe(container);
  }

  addLights() {
    this.scene.add(new HemisphereLight(0xffffff, 0xb0aca6, 1.2));
    // One light stands beside the camera and moves with it, so that no side of the sheet is dark; one stands above the
    // stage and casts soft shadows.
    const sun = new DirectionalLight(0xffffff, 1.2);
    const aside = new Vector3().setComponent((this.replay.up + 1) % 3, -0.5).setComponent((this.replay.up + 2) % 3, -0.4);
    sun.position.copy(this.up).multiplyScalar(2).add(aside).multiplyScalar(SUN_DISTANCE / 2);
    sun.castShadow = true;
    sun.shadow.mapSize.setScalar(SHADOW_PIXELS);
    Object.assign(sun.shadow, { radius: 5, blurSamples: 16, bias: -1e-4, normalBias: 0.01 });
    Object.assign(sun.shadow.camera, { near: 0.1, far: 2 * SUN_DISTANCE });
    for (const [side, sign] of [["left", -1], ["right", 1], ["bottom", -1], ["top", 1]]) {
      sun.shadow.camera[side] = sign * SHADOW_REACH;
    }
    this.renderer.shadowMap.enabled = true;
    this.scene.add(sun);
    const light = new DirectionalLight(0xffffff, 1.3);
    light.position.set(-0.8, 0.75, 0.6);
    this.camera.add(light, light.target);
    light.target.position.set(0, 0, -1);
    this.scene.add(this.camera);
  }

  addBodies() {
    this.bodies = new Group();
    this.bodyGroups = this.replay.data.bodies.map((body) => makeBody(body));
    this.replay.data.bodies.forEach((body, k) => placeBody(this.bodyGroups[k], body, 0));
    if (this.bodyGroups.length > 0) this.bodies.add(...this.bodyGroups);
    this.scene.add(this.bodies);
  }

  /**
   * Frames the sheet in all frames, and each body unless it is much larger or far away. Where the sheet goes far away, the
   * camera follows it, and what is framed is the sheet about its middle. Half-spaces reach beyond what is framed.
   */
  chooseUnits() {
    const { rest } = this.replay.data;
    const point = new Vector3(),
      length = (b) => b.getSize(point).length();
    const still = new Box3().setFromArray(this.replay.x);
    const range = this.replay.usualRange(1);
    const box = new Box3(...[0, 1].map((end) => new Vector3(...range.map((ends) => ends[end])))).union(still);
    // How far the camera has moved along with a sheet that leaves its view.
    this.shift = new Vector3();
    const middles = this.replay.middles();
    const about = new Box3(...boxAboutMiddle(this.replay, middles).map((corner) => new Vector3(...corner)));
    this.bodies.updateMatrixWorld(true);
    const bodies = this.bodyGroups.filter((group) => group.children.length > 0).map((group) => new Box3().setFromObject(group));
    const reach = bodies.reduce((sum, body) => sum.union(body), about.clone().union(still));
    this.follows = length(box) > LARGEST_FRAME * length(reach);
    if (this.follows) box.copy(about).union(still);
    const longest = LARGEST_FRAME * length(box);
    for (const body of bodies) {
      const wide = box.clone().union(body);
      if (length(wide) <= longest) box.copy(wide);
    }
    this.centre = box.getCenter(new Vector3()).toArray();
    this.size = box.getSize(point).length() / 2 || 1;
    const half = point.divideScalar(2 * this.size);
    this.box = new Box3(half.clone().negate(), half);
    this.replay.data.bodies.forEach((body, k) => {
      if (body.shape.kind === "half_space") {
        addPatch(this.bodyGroups[k], this.centre, PATCH_REACH * this.size);
      }
    });
    this.bodies.scale.setScalar(1 / this.size);
    this.bodies.position.set(...this.centre.map((c) => -c / this.size));
    this.meanLength = this.replay.mesh.meanLength(rest) / this.size;
    const { ground } = this.replay.data;
    if (ground === undefined) return;
    const place = new Vector3().setComponent(this.replay.up, (ground - this.centre[this.replay.up]) / this.size);
    this.ground = new Ground(place, this.up);
    this.scene.add(this.ground.object);
  }

  /** The mean place of the vertices, on the stage. */
  middle() {
    const middle = new Vector3(),
      { positions } = this;
    for (let k = 0; k < positions.length; k++) middle.setComponent(k % 3, middle.getComponent(k % 3) + positions[k]);
    return middle.divideScalar(positions.length / 3);
  }

  /** Moves the camera along with the sheet, which leaves what it frames. */
  follow() {
    const middle = this.middle();
    this.anchor ??= middle.clone();
    const shift = middle.sub(this.anchor),
      step = shift.clone().sub(this.shift);
    this.shift = shift;
    this.camera.position.add(step);
    this.controls.target.add(step);
    this.controls.update();
  }

  toStage(x, out) {
    for (let k = 0; k < x.length; k++) out[k] = (x[k] - this.centre[k % 3]) / this.size;
    return out;
  }

  /** Shows the frame that the replay is at. */
  update() {
    this.sheet.update(this.toStage(this.replay.x, this.positions));
    if (this.follows) this.follow();
    this.replay.data.bodies.forEach((body, k) => {
      if (body.poses.length > 7) placeBody(this.bodyGroups[k], body, this.replay.frame);
    });
    if (this.ground) this.ground.isStale = true;
    this.request();
  }

  /**
   * Takes the camera back so far that the sheet, as it is now, is in the box that fills the view, up to some times
   * its size at the start, and follows the sheet from there on. Says whether the camera has been taken back.
   */
  keepInView() {
    const box = this.box.clone().union(new Box3().setFromArray(this.positions)),
      length = (b) => b.getSize(new Vector3()).length();
    this.firstLength ??= length(this.box);
    if (this.follows || box.equals(this.box)) return false;
    if (length(box) > LARGEST_FRAME * this.firstLength) {
      this.follows = true;
      return false;
    }
    this.box = box;
    this.frameBox(box, this.camera.position.clone().sub(this.controls.target));
    return true;
  }

  /** Takes over the poses of bodies that have one pose, which has changed. */
  placeBodies() {
    this.replay.data.bodies.forEach((body, k) => placeBody(this.bodyGroups[k], body, 0));
  }

  setQuantity(quantity) {
    this.sheet.setQuantity(quantity);
    this.update();
  }

  applyTheme() {
    this.colours = themeColours();
    this.renderer.setClearColor(this.colours.background);
    this.sheet.setColours(this.colours);
    this.bodies.traverse(({ material, name }) => name in this.colours && material?.color.set(this.colours[name]));
    for (const { sides } of this.bodyGroups) sides?.colourAll(new Color(this.colours.outline).toArray());
    this.update();
  }

  /** Shows the bodies solid, see-through or not at all. */
  showBodies(look) {
    this.look = look;
    this.bodies.visible = look !== "hidden";
    this.bodies.traverse(({ material, name }) => {
      if (!material || !(name in this.colours)) return;
      const glass = look === "glass";
      Object.assign(material, { transparent: glass, opacity: glass ? GLASS : 1, depthWrite: !glass });
      material.needsUpdate = true;
    });
    if (this.ground) this.ground.isStale = true;
    this.request();
  }

  /** The camera at its start: all frames and bodies are in the view, from the side that shows most of the sheet. */
  resetCamera() {
    this.frameBox(this.box.clone().translate(this.shift), this.side());
    this.isAtStart = true;
  }

  /** From where the camera looks at the start. */
  side() {
    const { bodies } = this.replay.data;
    const isPlane = (k) => bodies[k].shape.kind === "half_space";
    // A plane hides the sheet from the side on which the sheet is not.
    const middle = new Vector3(...this.replay.middles()[0]);
    const towardSheet = ({ quaternion, position }) => {
      const normal = new Vector3(0, 0, 1).applyQuaternion(quaternion);
      return normal.multiplyScalar(middle.clone().sub(position).dot(normal) < 0 ? -1 : 1).toArray();
    };
    this.bestSide ??= new Vector3(
      ...bestSide(
        this.replay,
        this.bodyGroups
          .filter((_, k) => isPlane(k))
          .map(towardSheet),
        bodies.every((_, k) => isPlane(k)) ? ENOUGH : ENOUGH_BESIDE_BODIES,
      ),
    );
    return this.bestSide;
  }

  /** Where the camera is and what it looks at, in metres: six numbers with commas. Without what it has followed. */
  cameraText() {
    // A ten-thousandth of what is framed cannot be seen.
    const digits = Math.min(Math.max(Math.ceil(4 - Math.log10(this.size)), 0), 20);
    const ends = [this.camera.position, this.controls.target];
    const metres = ends.flatMap((p) => p.clone().sub(this.shift).toArray().map((c, k) => c * this.size + this.centre[k]));
    // The sum has no negative zero.
    return metres.map((c) => Number(c.toFixed(digits)) + 0).join(",");
  }

  /** Puts the camera where six numbers say, in metres: its position and what it looks at. */
  lookFrom(metres) {
    const [position, target] = [0, 3].map((from) =>
      new Vector3(...metres.slice(from, from + 3).map((c, k) => (c - this.centre[k]) / this.size)).add(this.shift),
    );
    const isPlace = metres.length === 6 && metres.every(Number.isFinite);
    if (!isPlace || position.distanceTo(target) < NEAREST) return;
    this.isAtStart = false;
    this.controls.target.copy(target);
    this.camera.position.copy(position);
    this.controls.update();
    this.request();
  }

  /** Moves the camera along its direction of view to where the sheet, as it is now, fills the view. */
  frameSheet() {
    const box = new Box3().setFromArray(this.positions);
    this.frameBox(box, this.camera.position.clone().sub(this.controls.target));
  }

  /** Looks at a box (on the stage) from a direction, from as near as its corners allow. */
  frameBox(box, direction) {
    const toCamera = direction.clone().normalize();
    const across = new Vector3().crossVectors(this.up, toCamera).normalize();
    const upward = new Vector3().crossVectors(toCamera, across);
    const slope = Math.tan((ANGLE_OF_VIEW * Math.PI) / 360);
    const centre = box.getCenter(new Vector3()),
      half = box.getSize(new Vector3()).divideScalar(2).toArray();
    const axes = { toCamera: toCamera.toArray(), across: across.toArray(), upward: upward.toArray() };
    const distance = Math.max(NEAREST, MARGIN * distanceToFit(half, axes, slope, this.camera.aspect));
    this.isAtStart = false;
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(toCamera, distance);
    this.controls.update();
    this.request();
  }

  resize() {
    const { clientWidth, clientHeight } = this.container;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    // What was framed for another shape of the view would be cut off in this one.
    if (this.isAtStart) this.resetCamera();
    this.render();
  }

  /** Asks for a picture at the next occasion. */
  request() {
    if (this.pending) return;
    this.pending = requestAnimationFrame(() => this.render());
  }

  render() {
    if (this.pending) cancelAnimationFrame(this.pending);
    this.pending = 0;
    const distance = this.camera.position.distanceTo(this.controls.target);
    const height = 2 * distance * Math.tan((ANGLE_OF_VIEW * Math.PI) / 360);
    this.sheet.fade((this.meanLength / height) * this.container.clientHeight);
    this.ground?.update(this.renderer, this.scene);
    this.renderer.render(this.scene, this.camera);
  }

  /**
   * What is at a place of the view (pixels from its upper left corner): `{ body }` of a solid one, or the face,
   * its nearest vertex and its nearest edge, or null.
   */
  pick(left, top) {
    const { clientWidth, clientHeight } = this.container;
    const place = new Vector2((2 * left) / clientWidth - 1, 1 - (2 * top) / clientHeight);
    this.raycaster.setFromCamera(place, this.camera);
    const sheet = this.raycaster.intersectObjects(this.sheet.surfaces, false)[0];
    const surfaces = this.bodyGroups.map((group) => group.children[0]);
    const solid = this.look === "solid" ? surfaces : [];
    const body = this.raycaster.intersectObjects(solid, false)[0];
    if (body && !(sheet?.distance < body.distance)) return { body: body.object.parent.name };
    return sheet ? this.nearest(sheet.faceIndex, sheet.point) : null;
  }

  /**
   * The vertex of the sheet that is seen within `reach` pixels of a place, or null: of the face there the nearest
   * one; beside the sheet the nearest of all.
   */
  vertexNear(left, top, reach) {
    const found = this.pick(left, top);
    if (found?.body !== undefined) return null;
    const { faces, vertexCount } = this.replay.mesh;
    const candidates = found
      ? faces.subarray(3 * found.face, 3 * found.face + 3)
      : Array.from({ length: vertexCount }, (_, v) => v);
    let nearest = null,
      least = reach;
    for (const v of candidates) {
      const [x, y] = this.placeOf(this.vertexPlace(v));
      const distance = Math.hypot(x - left, y - top);
      if (distance <= least) [nearest, least] = [v, distance];
    }
    return nearest;
  }

  /** The place of a vertex on the stage. */
  vertexPlace(vertex) {
    return new Vector3().fromArray(this.positions, 3 * vertex);
  }

  /** Where a point of the stage is seen: pixels from the upper left corner, and its depth. */
  placeOf(point) {
    const { clientWidth, clientHeight } = this.container;
    const { x, y, z } = point.project(this.camera);
    return [((x + 1) / 2) * clientWidth, ((1 - y) / 2) * clientHeight, z];
  }

  /** The point of the stage that is seen at a place, at a depth. */
  pointAt(left, top, depth) {
    const { clientWidth, clientHeight } = this.container;
    const place = new Vector3((2 * left) / clientWidth - 1, 1 - (2 * top) / clientHeight, depth);
    return place.unproject(this.camera);
  }

  /** A point of the stage in metres. */
  toMetres(point) {
    return point.toArray().map((c, k) => c * this.size + this.centre[k]);
  }

  nearest(face, point) {
    const { faces, faceEdges } = this.replay.mesh,
      x = this.positions;
    const corner = (k) => new Vector3().fromArray(x, 3 * faces[3 * face + (k % 3)]);
    let vertex = 0,
      edge = 0,
      toVertex = Infinity,
      toEdge = Infinity;
    for (let k = 0; k < 3; k++) {
      const a = corner(k),
        along = corner(k + 1).sub(a),
        offset = point.clone().sub(a);
      if (offset.length() < toVertex) [toVertex, vertex] = [offset.length(), faces[3 * face + k]];
      const part = Math.min(Math.max(offset.dot(along) / along.lengthSq(), 0), 1);
      const distance = offset.addScaledVector(along, -part).length();
      if (distance < toEdge) [toEdge, edge] = [distance, faceEdges[3 * face + k]];
    }
    return { face, vertex, edge };
  }
}
