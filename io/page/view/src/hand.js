// The hand that pulls at a vertex: the pointer that holds it, and how it is shown.

import { BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial, SphereGeometry } from "three";
import { Vector3 } from "three";

/** How near the pointer has to be to a vertex to hold it, in pixels. */
const REACH = 24;
/** Radius of the ball that shows the hand, on the stage. */
const RADIUS = 0.016;

export class Hand {
  /** `orders` takes what the hand does; `mayHold` says whether the page steers. */
  constructor(container, stage, orders, mayHold) {
    Object.assign(this, { container, stage, orders, mayHold });
    this.held = null;
    this.group = new Group();
    this.geometry = new BufferGeometry();
    this.geometry.setAttribute("position", new BufferAttribute(new Float32Array(6), 3));
    this.line = new Line(this.geometry, new LineBasicMaterial({ depthTest: false }));
    this.ball = new Mesh(new SphereGeometry(RADIUS, 16, 12), new MeshBasicMaterial({ depthTest: false }));
    for (const object of [this.line, this.ball]) {
      object.renderOrder = 2;
      object.frustumCulled = false;
    }
    this.group.add(this.line, this.ball);
    this.group.visible = false;
    stage.scene.add(this.group);
    // Before the controls of the camera, which the press does not reach where it holds a vertex.
    container.addEventListener("pointerdown", (event) => this.press(event), true);
    container.addEventListener("pointermove", (event) => this.move(event), true);
    for (const kind of ["pointerup", "pointercancel", "lostpointercapture"]) {
      container.addEventListener(kind, (event) => this.release(event), true);
    }
  }

  at(event) {
    const frame = this.container.getBoundingClientRect();
    return [event.clientX - frame.left, event.clientY - frame.top];
  }

  press(event) {
    if (event.button !== 0 || this.held || !this.mayHold()) return;
    const [left, top] = this.at(event);
    const vertex = this.stage.vertexNear(left, top, REACH);
    if (vertex === null) return;
    event.stopPropagation();
    event.preventDefault();
    const [x, y, depth] = this.stage.placeOf(new Vector3().fromArray(this.stage.positions, 3 * vertex));
    this.held = { pointer: event.pointerId, depth, offset: [x - left, y - top] };
    this.container.setPointerCapture(event.pointerId);
    this.container.dataset.hand = "holds";
    this.orders.send({ grab: { vertex } });
  }

  /** The vertex is led along the plane through it that is parallel to the screen. */
  move(event) {
    const { held } = this;
    if (!held) {
      if (event.buttons === 0) this.offer(event);
      return;
    }
    if (event.pointerId !== held.pointer) return;
    event.stopPropagation();
    const [left, top] = this.at(event);
    const point = this.stage.pointAt(left + held.offset[0], top + held.offset[1], held.depth);
    this.orders.send({ drag: { to: this.stage.toMetres(point) } }, "drag");
  }

  release(event) {
    if (event.pointerId !== this.held?.pointer) return;
    event.stopPropagation();
    this.letGo();
  }

  letGo() {
    if (!this.held) return;
    this.held = null;
    delete this.container.dataset.hand;
    this.orders.send("release");
  }

  /** Shows by the pointer that there is a vertex to hold. */
  offer(event) {
    const isNear = this.mayHold() && this.stage.vertexNear(...this.at(event), REACH) !== null;
    if (isNear) this.container.dataset.hand = "offers";
    else delete this.container.dataset.hand;
  }

  /** Shows the hand of the run: `{ vertex, to }` in metres, or null. */
  show(hand) {
    this.group.visible = hand !== null;
    if (hand === null) return;
    const { stage } = this,
      ends = this.geometry.attributes.position;
    const to = stage.toStage(hand.to, new Float32Array(3));
    ends.array.set(stage.positions.subarray(3 * hand.vertex, 3 * hand.vertex + 3));
    ends.array.set(to, 3);
    ends.needsUpdate = true;
    this.ball.position.fromArray(to);
    for (const object of [this.line, this.ball]) object.material.color.set(stage.colours.mark);
  }
}
