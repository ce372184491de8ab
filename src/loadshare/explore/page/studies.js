// Studies by worker processes: broken off as soon as what they are of has changed.
import { INK, FAINT, WARNING, byId, element, path, picture, shape, table, ticks } from "./dom.js";
import { Single } from "./ask.js";
import { drawLines } from "./bars.js";
import { numberOf } from "./controls.js";

const BINS = 40;
const asking = { critical: new Single("study/critical"), sweep: new Single("study/sweep"), slopes: new Single("study/slopes"), samples: new Single("samples") };
let traced = null, running = 0;

const why = (found) => (found.messages || ["no answer"]).slice(0, 2).join(" ");
const range = (control, view) => ({ name: control.name, low: control.input.low, high: control.input.high, changes: view.changes, position: view.position });

// Along an input these hold until anything else changes.
export async function critical(control, view) {
  control.told.textContent = "looking for critical values …";
  const found = await asking.critical.ask(range(control, view));
  if (!found) { control.told.textContent = ""; return; }
  if (!found.events) { control.told.textContent = why(found); return; }
  control.marks(found.events, found.gaps);
  const doubt = found.gaps.length ? `; not proved in ${found.gaps.length} grey stretches` : found.confirmed ? "; proved, there are no others" : "; not all confirmed";
  control.told.textContent = `${found.events.length || "no"} critical values on the slider${doubt}`;
}

export async function sweep(control, view, redraw) {
  control.told.textContent = "sweeping …";
  const found = await asking.sweep.ask(range(control, view));
  if (!found) { control.told.textContent = ""; return; }
  if (!found.x) { control.told.textContent = why(found); return; }
  control.told.textContent = found.refused ? `${found.refused} points without an answer: ${why(found)}` : "";
  traced = { ...found, control };
  redraw();
}

export const traceOf = (gear) => traced?.places[gear] || [];

export function drawTrace(value, shown) {
  const figure = byId("trace");
  if (!traced) { figure.hidden = true; return; }
  const { control } = traced, number = numberOf(control.input, value(control.keys[0]));
  const here = new Map();
  for (const bar of shown.bars) if (bar.here !== null) here.set(`stage ${bar.stage}`, Math.max(bar.here, here.get(`stage ${bar.stage}`) || 0));
  drawLines(figure, "trace", { x: traced.x, lines: new Map(Object.entries(traced.lines).map(([stage, values]) => [`stage ${stage}`, values])),
    title: control.name, unit: control.input.unit, point: number === null ? null : { at: number, values: here },
    marks: (control.known || []).map((event) => [event.value, event.told]) });
}

export async function slopes(view) {
  const names = view.names.length ? view.names : [];
  byId("study").textContent = "working out what matters …";
  const found = await asking.slopes.ask({ name: names[0], keys: view.keys, changes: view.changes, position: view.position });
  if (!found) return;
  byId("study").textContent = found.rows ? "" : why(found);
  if (found.rows) byId("mattering").replaceChildren(element("h4", {}, "What matters here"), ...table(found));
}

export async function tolerance(view, controls) {
  const samples = Number(byId("samples").value), limit = Number(byId("limit").value), mine = running += 1;
  const ranges = Object.fromEntries(controls.map((one) => [one.name, [one.input.low, one.input.high]]));
  const values = [];
  let first = 0, refused = 0;
  byId("stop").disabled = false;
  byId("study").textContent = "the study begins …";
  while (mine === running && first < samples) {
    const found = await asking.samples.ask({ ranges, samples, first, changes: view.changes, position: view.position });
    if (mine !== running) return;
    if (!found || !found.values) { byId("study").textContent = found ? why(found) : ""; break; }
    for (const value of found.values) values.push(value);
    first += found.done; refused += found.refused;
    byId("study").textContent = `${first} of ${samples} samples${refused ? `, ${refused} without an answer: ${found.messages[0] || ""}` : ""}`;
    drawHistogram(values, limit);
  }
  byId("stop").disabled = true;
}

export function stop() {
  running += 1;
  asking.samples.stop();
  byId("stop").disabled = true;
}

// What belongs to one setting ends with it; what runs along an input ends with all others.
export function forget(keys, controls) {
  if (!byId("stop").disabled) byId("study").textContent = "stopped: the setting has changed";
  stop();
  asking.slopes.stop();
  byId("mattering").replaceChildren();
  byId("histogram").hidden = true;
  const own = (control) => keys && control.keys.length === keys.length && control.keys.every((key) => keys.includes(key));
  if (!controls.some(own)) { asking.critical.stop(); asking.sweep.stop(); }
  for (const control of controls) if (!own(control)) { control.marks([]); control.told.textContent = ""; }
  if (traced && !own(traced.control)) traced = null;
}

function statistics(values, limit) {
  const count = values.length, mean = values.reduce((a, b) => a + b, 0) / count;
  const deviation = Math.sqrt(values.reduce((a, b) => a + (b - mean) ** 2, 0) / Math.max(count - 1, 1));
  const half = (1.959964 * deviation) / Math.sqrt(count), sorted = Float64Array.from(values).sort();
  const over = values.filter((v) => v > limit).length / count;
  return `mean Ω ${mean.toFixed(4)} (95 %: ${(mean - half).toFixed(4)} to ${(mean + half).toFixed(4)}), largest ${sorted[count - 1].toFixed(4)}, `
    + `share above ${limit}: ${over.toFixed(4)}; ${count} certified samples`;
}

function drawHistogram(values, limit) {
  const figure = byId("histogram");
  for (const old of figure.querySelectorAll("svg")) old.remove();
  figure.hidden = !values.length;
  if (!values.length) return;
  let low = Infinity, high = -Infinity;
  for (const value of values) { low = Math.min(low, value); high = Math.max(high, value); }
  if (high - low < 1e-9) { low -= 1e-3; high += 1e-3; }
  const counts = new Array(BINS).fill(0);
  for (const value of values) counts[Math.min(BINS - 1, Math.floor((BINS * (value - low)) / (high - low)))] += 1;
  const width = 400, foot = 170, left = 14, room = width - 2 * left, most = Math.max(...counts);
  const svg = picture(width, foot + 44, "largest Ω of the samples"), at = (v) => left + (room * (v - low)) / (high - low);
  svg.setAttribute("data-name", "histogram");
  counts.forEach((count, k) => svg.append(shape("rect", { x: left + (room * k) / BINS, width: room / BINS - 1, y: foot - (150 * count) / most,
    height: (150 * count) / most, fill: "#1b4f8f" }, shape("title", {}, `${count} samples`))));
  svg.append(path([[left, foot], [left + room, foot]], { stroke: INK }));
  if (limit > low && limit < high) svg.append(path([[at(limit), 10], [at(limit), foot]], { stroke: WARNING, "stroke-dasharray": "4 3" }));
  for (const [value, text] of ticks(low, high, 5)) {
    svg.append(path([[at(value), foot], [at(value), foot + 4]], { stroke: FAINT }));
    svg.append(shape("text", { x: Math.min(Math.max(at(value), 18), width - 18), y: foot + 17, "text-anchor": "middle", "font-size": 10 }, text));
  }
  svg.append(shape("text", { x: width / 2, y: foot + 34, "text-anchor": "middle" }, "largest Ω of a sample"));
  figure.prepend(svg);
  byId("statistics").textContent = statistics(values, limit);
}
