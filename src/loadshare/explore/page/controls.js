// Inputs by search: a field, a slider, and a dial for what goes round.
import { SOFT, byId, element, path, shape } from "./dom.js";

const NUMBER = /^\s*([+\-−]?(?:\d+\.?\d*|\.\d+)(?:[eE][+\-−]?\d+)?)\s*(.*?)\s*$/;
const SHOWN = 30;
let count = 0;

export function read(one) {
  const [key, text, number, unit, low, high, step, whole, turning, about, assumed, geometry] = one;
  return { key, text, number, unit, low, high, step, whole, turning, about, assumed, geometry };
}

export function written(input, number) {
  const places = Math.max(0, Math.min(100, -Math.floor(Math.log10(input.step) + 1e-9)));
  const rounded = Number(number.toFixed(places));
  // Very large and very small numbers are shorter with an exponent.
  const text = Math.abs(rounded) >= 1e7 || (rounded !== 0 && Math.abs(rounded) < 1e-4) ? rounded.toExponential(6).replace(/\.?0+e/, "e") : String(rounded);
  return input.unit ? `${text} ${input.unit}` : Number(text);
}

// What is in a field as the server takes it: plain numbers of plain inputs are numbers.
export function given(input, text) {
  const plain = text.trim();
  if (input.unit) return plain;
  return plain !== "" && Number.isFinite(Number(plain)) ? Number(plain) : plain;
}

export function numberOf(input, value) {
  if (typeof value === "number") return value;
  const match = NUMBER.exec(value);
  if (!match || match[2] !== input.unit) return null;
  return Number(match[1].replace("−", "-"));
}

// A key may be broken after its dots.
const broken = (name) => name.split(/(?<=[.=])/).flatMap((part) => [element("wbr"), part]);

export class Control {
  // `keys` are the inputs that take the value; the first one lends its unit and range.
  constructor(name, inputs, actions) {
    this.name = name;
    this.keys = inputs.map((one) => one.key);
    this.input = { ...inputs[0] };
    this.actions = actions;
    this.build();
  }

  build() {
    const { input } = this, id = `control-${count += 1}`;
    this.field = element("input", { class: "value", id, spellcheck: "false", autocomplete: "off",
      onchange: () => this.set(given(input, this.field.value)) });
    this.slider = element("input", { type: "range", min: input.low, max: input.high, step: input.step,
      "aria-label": `${this.name}, slider`, oninput: () => this.slid() });
    this.ticks = element("div", { class: "ticks", role: "group", "aria-label": `critical values of ${this.name}` });
    this.events = element("ul", { class: "events" });
    this.status = element("p", { class: "small", role: "status" });
    this.apart = element("p", { class: "small apart" });
    const ends = ["low", "high"].map((end) => element("input", { value: input[end], "aria-label": `${end === "low" ? "least" : "largest"} value of the slider of ${this.name}`,
      inputmode: "decimal", onchange: (event) => this.reach(end, Number(event.target.value), event.target) }));
    this.ends = ends;
    const about = `${this.keys.length > 1 ? `${this.keys.length} inputs take this value. ` : ""}${input.about}${input.assumed ? " Assumed." : ""}`;
    const button = (text, label, action) => element("button", { type: "button", "aria-label": `${label} ${this.name}`, onclick: action }, text);
    this.critical = button("Critical values", "critical values of", () => this.actions.critical(this));
    this.sweep = button("Trace", "trace of a sweep over", () => this.actions.sweep(this));
    const bar = element("div", {}, this.slider, this.ticks);
    this.place = element("div", { class: "control", "data-name": this.name, role: "group", "aria-label": this.name },
      element("div", { class: "head" }, element("label", { class: "key", for: id }, ...broken(this.name)), this.field),
      input.turning ? element("div", { class: "with-dial" }, bar, this.dial()) : bar,
      element("div", { class: "row" }, this.critical, this.sweep,
        button("Case", "value of the case for", () => this.actions.back(this)),
        button("✕", "remove the slider of", () => this.actions.remove(this))),
      this.apart, this.status, this.events,
      element("details", {}, element("summary", {}, "range and meaning"), element("p", { class: "small" }, about),
        element("p", {}, "slider from ", ends[0], " to ", ends[1], ` ${input.unit}`)));
  }

  dial() {
    this.needle = path([[28, 28], [50, 28]], { stroke: "currentColor", "stroke-width": 2.5, "stroke-linecap": "round" });
    const face = shape("svg", { width: 56, height: 56, viewBox: "0 0 56 56", class: "dial", "aria-hidden": "true" },
      shape("circle", { cx: 28, cy: 28, r: 25, fill: "none", stroke: SOFT }), path([[28, 28], [53, 28]], { stroke: SOFT, "stroke-dasharray": "2 3" }), this.needle);
    const turn = (event) => {
      if (this.slider.disabled) return;
      const box = face.getBoundingClientRect();
      const angle = Math.atan2(box.top + box.height / 2 - event.clientY, event.clientX - box.left - box.width / 2);
      const turn = this.input.high - this.input.low, value = (angle * turn) / (2 * Math.PI);
      this.slider.value = value < this.input.low ? value + turn : value;
      this.slid();
    };
    face.addEventListener("pointerdown", (event) => { face.setPointerCapture(event.pointerId); turn(event); });
    face.addEventListener("pointermove", (event) => { if (face.hasPointerCapture(event.pointerId)) turn(event); });
    return face;
  }

  slid() {
    const value = written(this.input, Number(this.slider.value));
    this.field.value = value;
    this.turned(Number(this.slider.value));
    this.set(value);
  }

  set(value) { this.actions.change(this.keys, value); }

  reach(end, value, field) {
    const other = end === "low" ? this.input.high : this.input.low;
    if (!Number.isFinite(value) || (end === "low" ? value >= other : value <= other)) { field.value = this.input[end]; return; }
    this.input[end] = value;
    const width = this.input.high - this.input.low;
    if (!this.input.whole) this.input.step = Number((10 ** Math.floor(Math.log10(width / 1000))).toPrecision(3));
    for (const [name, held] of [["min", "low"], ["max", "high"], ["step", "step"]]) this.slider.setAttribute(name, this.input[held]);
    this.marks([]);
  }

  // The value as it is set, and its number; one beyond the slider moves its end there. Without a
  // number the slider waits.
  show(values, number) {
    const [value] = values, apart = new Set(values).size > 1;
    this.apart.textContent = apart ? `These inputs differ: ${this.keys.map((key, k) => `${key} = ${values[k]}`).join(", ")}. Moving the slider sets all of them.` : "";
    this.slider.disabled = number === null;
    if (document.activeElement !== this.field || this.field.value.trim() !== String(value)) this.field.value = value;
    if (number === null) { this.slider.setAttribute("aria-valuetext", value); return; }
    if (!this.input.turning && number > this.input.high) this.ends[1].value = number, this.reach("high", number, this.ends[1]);
    if (!this.input.turning && number < this.input.low) this.ends[0].value = number, this.reach("low", number, this.ends[0]);
    this.slider.value = number;
    this.slider.setAttribute("aria-valuetext", value);
    this.turned(number);
  }

  turned(number) {
    if (!this.needle) return;
    const angle = (number * 2 * Math.PI) / (this.input.high - this.input.low);
    this.needle.setAttribute("d", `M28 28L${28 + 22 * Math.cos(angle)} ${28 - 22 * Math.sin(angle)}`);
  }

  // Critical values as ticks, each with what happens there; and where nothing is proved.
  marks(events, gaps = []) {
    const { low, high } = this.input, part = (value) => `${((100 * (value - low)) / (high - low)).toFixed(4)}%`;
    this.known = events;
    const go = (event) => () => this.set(event.text);
    this.ticks.replaceChildren(...gaps.map(([from, to, why]) => {
      const gap = element("span", { class: "gap", title: why });
      gap.style.left = part(from); gap.style.width = part(low + to - from);
      return gap;
    }), ...events.map((event) => {
      const tick = element("button", { type: "button", title: event.label, "aria-label": `go to ${event.label}`, onclick: go(event) });
      tick.style.left = part(event.value);
      return tick;
    }));
    this.events.replaceChildren(...events.map((event) => element("li", {}, element("button", { type: "button", onclick: go(event) }, event.label))));
  }
}

export function found(inputs, tied, words) {
  const parts = words.toLowerCase().split(/[\s.]+/).filter(Boolean);
  const fits = (text) => parts.every((part) => text.includes(part));
  const named = tied.filter((name) => fits(name.toLowerCase())).map((name) => [name, "all of them take one value"]);
  const single = inputs.filter((one) => fits(`${one.key} ${one.about}`.toLowerCase()));
  // Keys that hold all the words come before those whose meaning does.
  single.sort((a, b) => fits(b.key.toLowerCase()) - fits(a.key.toLowerCase()));
  return [...named, ...single.map((one) => [one.key, one.about])];
}

export function listFound(inputs, tied, take) {
  const words = byId("search").value.trim(), list = byId("found");
  if (!words) { list.replaceChildren(); return; }
  const all = found(inputs, tied, words);
  const rows = all.slice(0, SHOWN).map(([name, about]) => element("li", {},
    element("button", { type: "button", onclick: () => take(name) }, name, element("small", {}, about))));
  const rest = all.length ? all.length > SHOWN && `and ${all.length - SHOWN} more` : "No input has these words; keys joined by = or with a * are taken as they stand: press Enter.";
  if (rest) rows.push(element("li", {}, element("small", {}, rest)));
  list.replaceChildren(...rows);
}
