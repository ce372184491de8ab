// Questions to the server: one under way, at most one waiting, and that is the latest.
export async function post(name, body, signal) {
  const reply = await fetch(`/${name}`, { method: "POST", signal, body: JSON.stringify(body),
    headers: { "content-type": "application/json" } });
  return reply.json();
}

export function failed(error) {
  return { status: "failed", messages: [`No answer: ${error.message || error}. Is the server still running?`] };
}

export class Latest {
  constructor(name, show) { this.name = name; this.show = show; this.waiting = null; this.busy = false; }
  async ask(body) {
    this.waiting = body;
    if (this.busy) return;
    this.busy = true;
    while (this.waiting) {
      const asked = this.waiting;
      this.waiting = null;
      let found;
      try { found = await post(this.name, asked); } catch (error) { found = failed(error); }
      try { this.show(asked, found); } catch (error) { console.error(error); }
    }
    this.busy = false;
  }
}

// A question that the next one, or a change of the setting, breaks off.
export class Single {
  constructor(name) { this.name = name; this.control = null; }
  stop() { if (this.control) this.control.abort(); this.control = null; }
  async ask(body) {
    this.stop();
    const control = this.control = new AbortController();
    try {
      const found = await post(this.name, body, control.signal);
      return control.signal.aborted ? null : found;
    } catch (error) {
      return control.signal.aborted ? null : failed(error);
    } finally {
      if (this.control === control) this.control = null;
    }
  }
}
