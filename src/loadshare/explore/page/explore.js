// The page: what is set, what was requested, what is shown; they are distinguished by a number.
import { byId, card, element, table } from "./dom.js";
import { Latest, Lines, post } from "./ask.js";
import { Control, listFound, numberOf, read } from "./controls.js";
import { drawFloats } from "./floats.js";
import { drawForces, drawTrain } from "./train.js";
import { drawBars, drawLines } from "./bars.js";
import { comparison, pinnedBars } from "./pins.js";
import * as samples from "./samples.js";
import * as studies from "./studies.js";
import { copyLink, linked, savePicture, saveText } from "./save.js";

const IDLE = 350; // milliseconds without a change after which the rest is worked out
const FIRST = 6; // controls at the beginning

const page = { case: null, inputs: new Map(), setting: new Map(), controls: [], position: 1, number: 0, shown: null, pins: [] };
const latest = new Latest("answer", show), whole = new Lines("whole");
let resting = 0, ofCase = null;

// --- What is set

const valueOf = (key) => (page.setting.has(key) ? page.setting.get(key) : page.inputs.get(key).text);

// In the unit of the case; the server converts what is entered in another unit. Null until it has.
function numberAt(key) {
  const value = valueOf(key), { shown } = page;
  return numberOf(page.inputs.get(key), value) ?? (shown?.changes[key] === value ? shown.answer.numbers[key] ?? null : null);
}

const showControl = (control) => control.show(control.keys.map(valueOf), numberAt(control.keys[0]));

function change(keys, value) {
  for (const key of keys) {
    if (value === page.inputs.get(key).text) page.setting.delete(key);
    else page.setting.set(key, value);
  }
  for (const control of page.controls)
    if (control.keys.some((key) => keys.includes(key))) showControl(control);
  ask(keys);
}

function reset() {
  page.setting.clear();
  page.controls.forEach(showControl);
  ask();
}

async function take(name) {
  if (page.controls.some((control) => control.name === name)) return focus(name);
  let keys = page.inputs.has(name) ? [name] : page.case.tied.find(([tied]) => tied === name)?.[1];
  if (!keys) {
    const found = await post("keys", { name }).catch(() => ({ messages: ["the server was not reached"] }));
    if (!found.keys) { byId("done").textContent = (found.messages || []).join(" "); return null; }
    keys = found.keys;
  }
  const control = new Control(name, keys.map((key) => page.inputs.get(key)), actions);
  showControl(control);
  page.controls.push(control);
  byId("controls").append(control.place);
  return control;
}

function focus(name) {
  const control = page.controls.find((one) => one.name === name);
  control.field.focus();
  return control;
}

const actions = {
  change,
  back(control) {
    for (const key of control.keys) page.setting.delete(key);
    page.controls.forEach(showControl);
    ask(control.keys);
  },
  critical: (control) => studies.critical(control, view(), redraw),
  sweep: (control) => studies.sweep(control, view(), redraw),
  remove(control) {
    page.controls = page.controls.filter((one) => one !== control);
    control.place.remove();
  },
};

// --- Requests

function ask(keys = null) {
  page.number += 1;
  studies.forget(keys, page.controls);
  samples.forget(view());
  const { body } = document;
  body.dataset.number = page.number;
  body.dataset.state = "asking";
  tell("solving", page.shown ? "what is shown is of the setting before" : "");
  forget();
  latest.ask({ number: page.number, changes: Object.fromEntries(page.setting), position: page.position });
}

// What belongs to one setting alone, and is not there yet for the next.
function forget() {
  clearTimeout(resting);
  whole.stop();
  trust("is worked out once no input moves");
  byId("cycle").hidden = true;
}

const trust = (text) => byId("trust").replaceChildren(element("p", { class: "note" }, text));

// The answer at all positions takes the place of the one before, which may be of one position alone.
const rest = (request) => whole.ask({ changes: request.changes, position: request.position }, (found) => {
  if (request.number !== page.number) return;
  if (found.tables) { show(request, found); return; }
  trust((found.messages || ["no answer"]).join(" "));
  if (page.shown?.answer.solved !== page.shown?.answer.count) say(found.messages);
});

// --- What is shown

function tell(state, text, outcome = "") {
  byId("state").textContent = state;
  byId("note").textContent = text;
  document.body.dataset.outcome = outcome;
}

function show(request, answer) {
  const present = request.number === page.number;
  if (!present && !answer.tables) return;
  if (answer.tables) fill(request, answer);
  else empty();
  if (!present) return;
  document.body.dataset.state = answer.tables ? "present" : "none";
  tell(answer.status, answer.bound || nothing(answer), answer.status);
  say(answer.messages);
  if (answer.count) place(answer.count);
  page.controls.forEach(showControl);
  for (const control of page.controls) control.slider.disabled = false;
  if (!answer.trust && (answer.tables || answer.solved < answer.count)) resting = setTimeout(() => rest(request), IDLE);
}

function nothing({ status, position, solved, count }) {
  if (status === "invalid") return "this setting is not a valid case; nothing was solved";
  return solved < count ? `there is no answer at position ${position}; the others follow once no input moves` : "there is no answer for this setting";
}

function fill(request, answer) {
  const { shown } = page, drawn = shown?.number === request.number && shown.answer.solved === answer.solved;
  page.shown = { ...request, answer };
  for (const pin of page.pins) if (pin.number === request.number) pin.answer = answer;
  if (!drawn) figures(request, answer);
  if (answer.trust) {
    byId("trust").replaceChildren(element("dl", {}, ...Object.entries(answer.trust).flatMap(([name, text]) =>
      [element("dt", {}, name), element("dd", {}, text)])));
  }
  if (answer.cycle) {
    const lines = new Map(Object.entries(answer.cycle.omega).map(([stage, values]) => [`stage ${stage}`, values]));
    drawLines(byId("cycle"), "cycle", { x: answer.cycle.positions, lines, title: "position" });
  }
}

function figures(request, answer) {
  byId("answer").dataset.of = request.number;
  byId("of").textContent = `${settingText(request)}${answer.states ? "" : ` There is no answer at position ${answer.position}, and no picture of it.`}`;
  byId("summary").textContent = summary(answer);
  byId("tables").replaceChildren(...answer.tables.map(card));
  byId("states").replaceChildren(...(answer.states ? table(answer.states) : []));
  draw();
}

// The largest Ω of every stage, and what it is: what stays in sight while sliders move.
function summary({ bars, measure }) {
  const most = new Map();
  for (const bar of bars) if (bar.most !== null && !(most.get(bar.stage)?.most >= bar.most)) most.set(bar.stage, bar);
  return [...most].map(([stage, bar], k) => `${measure === "Kγ" ? "Kγ " : k ? "" : `${measure}: `}${stage} = ${bar.text}`).join(", ");
}

function draw() {
  const { answer } = page.shown;
  drawBars(byId("bars"), answer, pinnedBars(page.pins));
  drawFloats(byId("floats"), answer.floats || [], (gear) => ({
    trace: studies.traceOf(gear),
    pinned: page.pins.flatMap((pin) => (pin.answer.floats || []).filter((f) => f.gear === gear).map((f) => [pin.name, f.here])),
  }));
  const shapes = answer.train || page.case.train;
  if (ofCase !== shapes) {
    drawTrain(byId("train"), shapes);
    ofCase = shapes;
  }
  drawForces(answer.forces);
  studies.drawTrace(numberAt, answer);
  byId("pins").hidden = !page.pins.length;
  byId("compared").replaceChildren(...comparison(page.pins, page.shown, settingText, unpin));
}

const redraw = () => page.shown && draw();

function empty() {
  page.shown = null;
  delete byId("answer").dataset.of;
  for (const id of ["of", "summary"]) byId(id).textContent = "";
  for (const id of ["tables", "states", "floats"]) byId(id).replaceChildren();
  drawBars(byId("bars"), { bars: [] }, []);
  drawForces([]);
  byId("trace").hidden = true;
  byId("compared").replaceChildren();
}

function say(messages) {
  byId("messages").replaceChildren(...(messages || []).map((message) => element("li", {}, message)));
}

function changesText({ changes }) {
  const parts = Object.entries(changes).map(([key, value]) => `${key} = ${value}`);
  const more = parts.length > 5 ? `, and ${parts.length - 5} more` : "";
  return `${parts.length ? `Setting: ${parts.slice(0, 5).join(", ")}${more}` : "As the case has it"}.`;
}

const settingText = (one) => `${page.case.positions > 1 ? `Pictures at position ${one.position}. ` : ""}${changesText(one)}`;

// --- Position

function place(count) {
  const holder = byId("position");
  page.position = Math.min(page.position, count);
  if (holder.dataset.count !== String(count)) {
    holder.dataset.count = count;
    holder.replaceChildren(...(count > 1 ? [positionControl(count)] : []));
  }
  if (count < 2) return;
  const slider = byId("position-slider"), angles = page.case.angles?.length === count ? page.case.angles : null;
  slider.value = page.position;
  const text = `${page.position} of ${count}${angles ? `, input turned by ${angles[page.position - 1]}°` : ""}`;
  byId("position-text").textContent = text;
  slider.setAttribute("aria-valuetext", text);
}

function positionControl(count) {
  const slider = element("input", { type: "range", id: "position-slider", min: 1, max: count, step: 1,
    oninput: () => { page.position = Number(slider.value); place(count); ask(); } });
  return element("div", { class: "control" }, element("div", { class: "head" },
    element("label", { class: "key", for: "position-slider" }, "Position shown"), element("span", { class: "small", id: "position-text" })), slider);
}

// --- Pins

function pin() {
  if (document.body.dataset.state !== "present") return;
  const name = page.pins.some((one) => one.name === "A") && !page.pins.some((one) => one.name === "B") ? "B" : "A";
  page.pins = [...page.pins.filter((one) => one.name !== name), { name, ...page.shown }].sort((a, b) => (a.name < b.name ? -1 : 1));
  draw();
}

function unpin(name) {
  page.pins = page.pins.filter((one) => one.name !== name);
  if (page.shown) draw();
  else byId("pins").hidden = !page.pins.length;
}

// --- Beginning

// Floats, clearances and errors that the case has: what a designer asks first.
const mattering = () => [...page.inputs.values()].filter((one) => one.number !== 0 && !one.whole
  && /^(rings|splines|bearings)\.|^errors\..*(amount$|pin\.)/.test(one.key)).map((one) => one.key);

function firstNames() {
  const keys = [...page.inputs.keys()], nonzero = (key) => page.inputs.get(key).number !== 0;
  const varying = keys.filter((key) => !page.inputs.get(key).geometry);
  const own = (pattern) => keys.filter((key) => pattern.test(key) && nonzero(key));
  const tied = page.case.tied.map(([name]) => name).filter((name) => /^rings\.\*\.(float|radius)$/.test(name));
  const errors = own(/^errors\..*\.amount$/).flatMap((key) => [key, key.replace(/amount$/, "direction")]);
  return [...tied, ...own(/^(rings|splines|bearings)\..*(float|radius|clearance)/), ...own(/^operating\.(torque|power)/),
    ...errors.slice(0, 2), ...own(/^errors\..*\.pin\./), ...own(/friction$/), ...own(/^meshes\..*(gap|backlash)/),
    ...own(/^meshes\..*stiffness/), ...errors, ...varying, ...keys];
}

async function begin() {
  page.case = await fetch("/case").then((reply) => reply.json());
  page.inputs = new Map(page.case.inputs.map(read).map((one) => [one.key, one]));
  document.title = `${page.case.title} – loadshare explorer`;
  byId("title").textContent = page.case.title;
  byId("name").textContent = page.case.name;
  samples.offer(page.case.studies);
  addEventListener("hashchange", open);
  return open();
}

// The view of the address: at the beginning, and when another link is put there.
async function open() {
  const link = linked(page.inputs);
  page.setting = new Map(Object.entries(link.changes));
  page.position = link.position <= page.case.positions ? link.position : 1;
  place(page.case.positions);
  for (const control of [...page.controls]) actions.remove(control);
  ask();
  for (const name of link.names.length ? link.names : [...new Set(firstNames())].slice(0, FIRST)) await take(name);
}

const search = byId("search");
const all = () => [...page.inputs.values()];
const list = () => listFound(all(), page.case.tied.map(([name]) => name), (name) => { search.value = ""; list(); take(name).then((c) => c && focus(c.name)); });
search.addEventListener("input", list);
search.addEventListener("keydown", (event) => {
  if (event.key === "Escape") { search.value = ""; list(); }
  if (event.key !== "Enter" || !search.value.trim()) return;
  const first = byId("found").querySelector("button");
  if (first && !/[=*]/.test(search.value)) first.click();
  else take(search.value.trim()).then((control) => { if (control) { search.value = ""; list(); focus(control.name); } });
});
const view = () => ({ changes: Object.fromEntries(page.setting), names: page.controls.map((one) => one.name), position: page.position });
byId("slopes").addEventListener("click", () => studies.slopes({ ...view(), keys: [...new Set([...page.controls.flatMap((one) => one.keys), ...mattering()])] }));
byId("tolerance").addEventListener("click", () => samples.begin(view(), page.controls, changesText));
byId("reset").addEventListener("click", reset);
byId("pin").addEventListener("click", pin);
byId("link").addEventListener("click", () => copyLink(view()));
byId("toml").addEventListener("click", () => saveText(view()));
for (const kind of ["svg", "png"]) byId(kind).addEventListener("click", () => savePicture(kind, page, settingText));
begin().catch((error) => { document.body.dataset.state = "none"; tell("failed", `The page could not begin: ${error.message}`, "failed"); });
