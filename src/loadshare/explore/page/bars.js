// Ω of every branch and K_γ of every stage as bars; lines over a parameter or over positions.
import { INK, SOFT, FAINT, WARNING, path, picture, shape, ticks } from "./dom.js";

const WIDTH = 400, ROW = 19, LEFT = 96, RIGHT = 58;

export function drawBars(figure, { bars, measure }, pinned) {
  for (const old of figure.querySelectorAll("svg")) old.remove();
  figure.hidden = !bars.length;
  if (!bars.length) return;
  const stages = [...new Set(bars.map((b) => b.stage))];
  const most = Math.max(1.2, ...bars.flatMap((b) => [b.most || 0, ...pinned.map(([, p]) => p.get(b.mesh) || 0)]));
  const height = (bars.length + stages.length) * ROW + 34, room = WIDTH - LEFT - RIGHT;
  const at = (value) => LEFT + (room * value) / most;
  const svg = picture(WIDTH, height, "load sharing Ω by branch");
  svg.setAttribute("data-name", "sharing");
  let y = 6;
  for (const [value, text] of ticks(0, most, 6)) {
    svg.append(path([[at(value), 6], [at(value), height - 24]], { stroke: value === 1 ? INK : FAINT, "stroke-width": value === 1 ? 1.2 : 0.8 }));
    svg.append(shape("text", { x: at(value), y: height - 10, "text-anchor": "middle", "font-size": 10 }, text));
  }
  for (const stage of stages) {
    const own = bars.filter((b) => b.stage === stage), largest = own.reduce((a, b) => ((b.most || 0) > (a.most || 0) ? b : a));
    svg.append(shape("text", { x: 4, y: y + 13, "font-weight": 600 }, cut(`Stage ${stage}: ${measure === "Kγ" ? measure : `largest ${measure}`} = ${largest.text}`, 52)));
    y += ROW;
    for (const bar of own) {
      const title = shape("title", {}, `mesh ${bar.mesh}: Ω ${bar.text}${bar.here === null ? "" : `, here ${bar.here.toFixed(4)}`}`);
      const length = Math.max(0, at(bar.most || 0) - LEFT);
      svg.append(shape("text", { x: LEFT - 6, y: y + 13, "text-anchor": "end" }, cut(bar.mesh, 14)));
      svg.append(shape("rect", { x: LEFT, y: y + 3, width: length, height: ROW - 6, fill: bar.colour, opacity: 0.8 }, title));
      if (bar.here !== null && bar.here !== bar.most)
        svg.append(path([[at(bar.here), y + 1], [at(bar.here), y + ROW - 1]], { stroke: INK, "stroke-width": 2 }));
      for (const [name, values] of pinned) {
        const value = values.get(bar.mesh);
        if (value !== undefined && value !== null)
          svg.append(shape("rect", { x: LEFT, y: y + 2, width: at(value) - LEFT, height: ROW - 4, fill: "none", stroke: INK, "stroke-dasharray": "3 2" },
            shape("title", {}, `pinned ${name}: ${value.toFixed(4)}`)));
      }
      svg.append(shape("text", { x: WIDTH - RIGHT + 6, y: y + 13 }, bar.text));
      y += ROW;
    }
  }
  figure.prepend(svg);
}

const cut = (text, letters) => (text.length > letters ? `${text.slice(0, letters - 1)}…` : text);

const COLOURS = ["#1b4f8f", "#9a5b00", "#0b7a63", "#a8327c", "#7a2e12"];

// Lines of several values over one; a point, and marks, on them.
export function drawLines(figure, name, { x, lines, title, unit = "", point = null, marks = [] }) {
  for (const old of figure.querySelectorAll("svg")) old.remove();
  const known = [...lines.values()].flat().filter((v) => v !== null);
  figure.hidden = !known.length;
  if (!known.length) return;
  const height = 230 + 14 * lines.size, left = 52, foot = 190, right = WIDTH - 12;
  const pad = 0.06 * (Math.max(...known) - Math.min(...known)) || 0.01;
  const low = Math.min(...known) - pad, high = Math.max(...known) + pad, first = x[0], last = x.at(-1);
  const at = (u, v) => [left + ((right - left) * (u - first)) / (last - first || 1), foot - ((foot - 12) * (v - low)) / (high - low)];
  const svg = picture(WIDTH, height, title);
  svg.setAttribute("data-name", name);
  for (const [value, text] of ticks(low, high)) {
    const [, y] = at(first, value);
    svg.append(path([[left, y], [right, y]], { stroke: FAINT }), shape("text", { x: left - 5, y: y + 3.5, "text-anchor": "end", "font-size": 10 }, text));
  }
  for (const [value, text] of ticks(first, last, 6)) {
    const [u] = at(value, low);
    svg.append(path([[u, foot], [u, foot + 4]], { stroke: SOFT }));
    svg.append(shape("text", { x: Math.min(Math.max(u, left + 8), right - 10), y: foot + 16, "text-anchor": "middle", "font-size": 10 }, text));
  }
  for (const [value, text] of marks) {
    const [u] = at(value, low);
    svg.append(path([[u, 12], [u, foot]], { stroke: WARNING, "stroke-dasharray": "4 3" }));
    svg.lastChild.append(shape("title", {}, text));
  }
  let k = 0;
  for (const [label, values] of lines) {
    const colour = COLOURS[k % COLOURS.length];
    for (const run of runs(values)) svg.append(path(run.map((i) => at(x[i], values[i])), { stroke: colour, "stroke-width": 1.8 }));
    if (point) {
      const value = point.values.get(label);
      if (value !== undefined && value !== null && point.at >= first && point.at <= last) {
        const [u, v] = at(point.at, Math.min(Math.max(value, low), high));
        svg.append(shape("circle", { cx: u, cy: v, r: 5, fill: colour, stroke: "#fff", class: "here" }));
      }
    }
    const y = foot + 46 + 14 * k;
    svg.append(path([[left, y - 4], [left + 22, y - 4]], { stroke: colour, "stroke-width": 2 }));
    svg.append(shape("text", { x: left + 28, y }, cut(label, 50)));
    k += 1;
  }
  svg.append(shape("text", { x: (left + right) / 2, y: foot + 31, "text-anchor": "middle" }, cut(unit ? `${title} [${unit}]` : title, 60)));
  figure.prepend(svg);
}

function runs(values) {
  const found = [[]];
  values.forEach((v, i) => { if (v === null) found.push([]); else found.at(-1).push(i); });
  return found.filter((run) => run.length);
}
