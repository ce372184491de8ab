// Studies by worker processes: broken off as soon as what they are of has changed.
import { byId, element, table } from "./dom.js";
import { Lines } from "./ask.js";
import { drawLines } from "./bars.js";

const asking = { critical: new Lines("study/critical"), sweep: new Lines("study/sweep"), slopes: new Lines("study/slopes") };
const HEADS = [["input", false], ["Ω rises by", true], ["over a tenth of its slider", true]];
let searched = null, traced = null;

export const why = (found) => (found.messages || ["no answer"]).slice(0, 2).join(" ");
const range = (control, view) => ({ name: control.name, low: control.input.low, high: control.input.high, changes: view.changes, position: view.position });

// Along an input these hold until anything else changes.
export async function critical(control, view, redraw) {
  if (searched) searched.marks([]), searched.status.textContent = "";
  searched = control;
  control.marks([]);
  control.status.textContent = "looking for critical values …";
  const known = new Map(), gaps = [];
  let confirmed = true;
  const whole = await asking.critical.ask({ ...range(control, view), at: Number(control.slider.value) }, (found) => {
    if (!found.events) { control.status.textContent = why(found); return; }
    // What happens where two stretches meet is found by both.
    for (const event of found.events) known.set(event.label, event);
    gaps.push(...found.gaps);
    confirmed &&= found.confirmed;
    control.marks([...known.values()].sort((a, b) => a.value - b.value), gaps);
    redraw();
    const count = `${known.size || "no"} critical value${known.size === 1 ? "" : "s"}`;
    const doubt = gaps.length ? `not proved in ${gaps.length} grey stretch${gaps.length === 1 ? "" : "es"}` : confirmed ? "proved, there are no others" : "not all confirmed";
    control.status.textContent = found.done < found.of ? `${count} so far, in ${found.done} of ${found.of} stretches of the slider …` : `${count} on the slider; ${doubt}`;
  });
  if (whole && searched === control) searched = null;
}

export async function sweep(control, view, redraw) {
  control.status.textContent = "sweeping …";
  const whole = await asking.sweep.ask(range(control, view), (found) => {
    control.status.textContent = !found.x ? why(found) : found.refused ? `${found.refused} points without an answer: ${why(found)}` : "";
    if (!found.x) return;
    traced = { ...found, control };
    redraw();
  });
  if (!whole) control.status.textContent = "";
}

export const traceOf = (gear) => traced?.places[gear] || [];

export function drawTrace(numberAt, shown) {
  const figure = byId("trace");
  if (!traced) { figure.hidden = true; return; }
  const { control } = traced, number = numberAt(control.keys[0]);
  const here = new Map();
  for (const bar of shown.bars) if (bar.here !== null) here.set(`stage ${bar.stage}`, Math.max(bar.here, here.get(`stage ${bar.stage}`) || 0));
  drawLines(figure, "trace", { x: traced.x, lines: new Map(Object.entries(traced.lines).map(([stage, values]) => [`stage ${stage}`, values])),
    title: control.name, unit: control.input.unit, point: number === null ? null : { at: number, values: here },
    marks: (control.known || []).map((event) => [event.value, event.label]) });
}

export function slopes({ keys, changes, position }) {
  const rows = [], notes = new Set(), status = byId("slopes-status");
  status.textContent = `working out what ${keys.length} inputs do …`;
  return asking.slopes.ask({ keys, changes, position }, (found) => {
    if (!found.rows) { status.textContent = why(found); return; }
    rows.push(...found.rows);
    rows.sort(([, a], [, b]) => b - a);
    for (const note of found.notes) notes.add(note);
    status.textContent = found.done < found.of ? `${found.done} of ${found.of} inputs so far …` : "";
    byId("mattering").replaceChildren(...table({ columns: HEADS, rows: rows.map(([row]) => row), notes: [...notes].slice(0, 3) }));
  });
}

// What belongs to one setting ends with it; what runs along an input ends with all others.
export function forget(keys, controls) {
  asking.slopes.stop();
  byId("slopes-status").textContent = "";
  byId("mattering").replaceChildren();
  const own = (control) => keys && control.keys.length === keys.length && control.keys.every((key) => keys.includes(key));
  if (searched && !own(searched)) asking.critical.stop(), searched = null;
  if (!controls.some(own)) asking.sweep.stop();
  for (const control of controls) if (!own(control)) { control.marks([]); control.status.textContent = ""; }
  if (traced && !own(traced.control)) traced = null;
}
