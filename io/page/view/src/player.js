// The frame that is shown, and playing.

export class Player {
  /** `onChange` is called after every change of the frame or of playing. */
  constructor(replay, onChange) {
    this.replay = replay;
    this.onChange = onChange;
    this.speed = 1;
    this.loops = false;
    this.playing = false;
    this.isOpening = false;
  }

  /** Shows the frame that the page opens at, from where playing begins at the start. */
  open(frame) {
    this.seek(frame);
    this.isOpening = true;
  }

  seek(frame) {
    this.isOpening = false;
    const last = this.replay.frames - 1;
    this.show(Math.min(Math.max(Math.round(frame), 0), last));
    this.time = this.replay.time;
  }

  seekTime(time) {
    this.seek(this.replay.nearestFrame(time));
  }

  show(frame) {
    if (frame === this.replay.frame) return;
    this.replay.seek(frame);
    this.onChange();
  }

  toggle() {
    this.playing = !this.playing && this.replay.frames > 1;
    if (this.playing) {
      const { times } = this.replay.data;
      const isOver = this.isOpening || this.replay.frame === this.replay.frames - 1;
      this.time = isOver ? times[0] : this.replay.time;
      this.isOpening = false;
      this.clock = null;
      requestAnimationFrame((now) => this.tick(now));
    }
    this.onChange();
  }

  /** Goes on in the time of the run by the time that passed, times the speed; at the last frame it stops, or begins anew. */
  tick(now) {
    if (!this.playing) return;
    const { times } = this.replay.data,
      end = times[times.length - 1];
    if (this.clock !== null) this.time += ((now - this.clock) / 1000) * this.speed;
    this.clock = now;
    this.show(this.replay.frameAt(this.time));
    if (this.time >= end && !this.loops) {
      this.playing = false;
      this.onChange();
      return;
    }
    if (this.time >= end) this.time = times[0];
    requestAnimationFrame((then) => this.tick(then));
  }
}
