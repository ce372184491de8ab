// Questions to the server: one under way, at most one waiting, and that is the latest.
const send = (name, body, signal) => fetch(`/${name}`, { method: "POST", signal, body: JSON.stringify(body),
  headers: { "content-type": "application/json" } });

export const post = async (name, body) => (await send(name, body)).json();

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
      const question = this.waiting;
      this.waiting = null;
      let found;
      try { found = await post(this.name, question); } catch (error) { found = failed(error); }
      try { this.show(question, found); } catch (error) { console.error(error); }
    }
    this.busy = false;
  }
}

// A question that is answered line by line, and that the next one, or a change of the setting, breaks off.
export class Lines {
  constructor(name) { this.name = name; this.control = null; }
  stop() { if (this.control) this.control.abort(); this.control = null; }
  // Hands every line to `take`; whether all of them came.
  async ask(body, take) {
    this.stop();
    const control = this.control = new AbortController(), { signal } = control;
    try {
      const reply = await send(this.name, body, signal), reader = reply.body.pipeThrough(new TextDecoderStream()).getReader();
      let held = "", ended = false;
      while (!ended) {
        const { done, value } = await reader.read();
        if (signal.aborted) return false;
        ended = done;
        const lines = `${held}${value || ""}${done ? "\n" : ""}`.split("\n");
        held = lines.pop();
        for (const line of lines) if (line) take(JSON.parse(line));
      }
    } catch (error) {
      if (signal.aborted) return false;
      take(failed(error));
    } finally {
      if (this.control === control) this.control = null;
    }
    return true;
  }
}
