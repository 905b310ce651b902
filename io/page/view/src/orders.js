// What the page asks the run for. One request at a time: what is asked for meanwhile waits, and of drags and of a
// slider that wait the newest one is left.

export class Orders {
  /** `onRefused` is called with the status of a request that was refused, or null where there was no answer. */
  constructor(onRefused) {
    this.onRefused = onRefused;
    this.viewer = null;
    this.waiting = [];
    this.busy = false;
  }

  /** Asks for a command; `key` says which one that waits it takes the place of. */
  send(command, key = null) {
    const last = this.waiting.at(-1);
    if (key !== null && last?.key === key) last.command = command;
    else this.waiting.push({ command, key });
    if (!this.busy) this.post();
  }

  async post() {
    this.busy = true;
    while (this.waiting.length > 0) {
      const { command } = this.waiting.shift();
      const body = JSON.stringify({ viewer: this.viewer, command });
      const answer = await fetch("command", { method: "POST", body }).catch(() => null);
      if (!answer?.ok) this.onRefused(answer?.status ?? null);
    }
    this.busy = false;
  }
}
