// Elements and pictures from data; texts only ever become text.
export const INK = "#1f2933", SOFT = "#55616c", FAINT = "#e4e7eb", WARNING = "#b3261e";
export const SIZE = 11; // of the letters in a picture [px]
const FONT = "Helvetica Neue, Helvetica, Arial, Liberation Sans, Roboto, sans-serif";
const SVG = "http://www.w3.org/2000/svg";

export const byId = (id) => document.getElementById(id);

export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

export function shape(name, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value !== null && value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

export function picture(width, height, title) {
  const made = shape("svg", { xmlns: SVG, width, height, viewBox: `0 0 ${width} ${height}`, role: "img",
    "font-family": FONT, "font-size": SIZE, fill: INK });
  made.append(shape("title", {}, title), shape("rect", { width, height, fill: "#fff" }));
  return made;
}

export function path(points, attributes, closed = false) {
  const d = points.map(([x, y], k) => `${k ? "L" : "M"}${x.toFixed(2)} ${y.toFixed(2)}`).join("");
  return shape("path", { fill: "none", d: d + (closed ? "Z" : ""), ...attributes });
}

export function table(found) {
  const head = element("tr", {}, ...found.columns.map(([title, figures]) =>
    element("th", { scope: "col", class: figures ? "figures" : null }, title)));
  const rows = found.rows.map((row) => element("tr", {}, ...row.map((text, k) =>
    element("td", { class: found.columns[k][1] ? "figures" : null }, text))));
  const made = element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows));
  const notes = (found.notes || []).map((note) => element("p", { class: "note" }, note));
  return [element("div", { class: "wide" }, made), ...notes];
}

export const card = (found) => element("div", { class: "card" }, element("h3", {}, found.title), ...table(found));

const HALO = { stroke: "#fff", "stroke-width": 3, "stroke-linejoin": "round", "paint-order": "stroke" };

// Words that find a place of their own, or none: what does not fit is left to the pointer.
export class Labels {
  constructor(width, height) { this.width = width; this.height = height; this.boxes = []; }
  avoid(x, y, w, h) { this.boxes.push([x, y, w, h]); }
  place(text, spots, attributes = {}) {
    const size = attributes["font-size"] || SIZE;
    const w = text.length * size * (attributes["font-weight"] ? 0.66 : 0.6) + 4, h = size * 1.25;
    for (const [x, y] of spots) {
      const box = [x - w / 2, y - h / 2, w, h];
      if (box[0] < 1 || box[1] < 1 || box[0] + w > this.width - 1 || box[1] + h > this.height - 1) continue;
      if (this.boxes.some(([a, b, c, d]) => a < box[0] + w && box[0] < a + c && b < box[1] + h && box[1] < b + d)) continue;
      this.boxes.push(box);
      return shape("text", { x, y: y + size * 0.36, "text-anchor": "middle", ...HALO, ...attributes }, text);
    }
    return null;
  }
}

export function around([x, y], gap = 12, wide = 16) {
  return [[x, y - gap], [x, y + gap], [x + wide, y - gap], [x - wide, y - gap], [x + wide, y + gap], [x - wide, y + gap],
    [x, y - 2 * gap], [x, y + 2 * gap], [x + 2 * wide, y], [x - 2 * wide, y]];
}

export function ticks(low, high, most = 5) {
  const width = high - low;
  if (!(width > 0) || !Number.isFinite(width)) return [];
  const size = 10 ** Math.floor(Math.log10(width / most));
  const step = [1, 2, 5, 10].map((k) => k * size).find((k) => width / k <= most);
  const found = [], places = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * width; k += 1)
    found.push([k * step, (k * step).toFixed(Math.min(places, 9)).replace("-", "−")]);
  return found;
}

export function arrow([x, y], [u, v], head) {
  const size = Math.hypot(u - x, v - y) || 1, a = (u - x) / size, b = (v - y) / size;
  return [[x, y], [u, v], [u - head * (a - 0.5 * b), v - head * (b + 0.5 * a)], [u, v],
    [u - head * (a + 0.5 * b), v - head * (b - 0.5 * a)]];
}

// An arrow as an outline, as wide as requested; its head is wider than any shaft.
export function broadArrow([x, y], [u, v], width) {
  const size = Math.hypot(u - x, v - y) || 1, a = (u - x) / size, b = (v - y) / size;
  const half = width / 2, wing = half + 4, neck = Math.max(size - 1.6 * wing, 0);
  const at = (along, across) => [x + along * a - across * b, y + along * b + across * a];
  return [at(0, half), at(neck, half), at(neck, wing), [u, v], at(neck, -wing), at(neck, -half), at(0, -half)];
}
