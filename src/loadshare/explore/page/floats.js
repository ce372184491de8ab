// Floats in their regions: where the centre may be, where it is, where it was.
import { INK, SOFT, FAINT, WARNING, Labels, around, arrow, element, path, picture, shape, ticks } from "./dom.js";

const SIDE = 300, LEFT = 44, TOP = 26, BOTTOM = 40;
const views = new Map(); // a picture keeps its scale as long as what it shows has room

function viewOf(found) {
  const [x, y, half] = found.view, known = views.get(found.gear);
  if (known && half <= known[2] && half >= 0.4 * known[2]
    && Math.max(Math.abs(x - known[0]), Math.abs(y - known[1])) <= known[2] - 0.9 * half) return known;
  views.set(found.gear, found.view);
  return found.view;
}

export function drawFloats(place, floats, beside) {
  place.replaceChildren(...floats.map((found) => {
    const figure = element("figure", { "data-gear": found.gear }), more = beside(found.gear), view = viewOf(found);
    figure.append(draw(found, view, more),
      element("figcaption", {}, ...[...found.lines, ...outside(view, more)].map((line) => element("p", {}, line))));
    return figure;
  }));
}

// What is cut off at the edge of a picture, in words.
function outside([x, y, half], { trace = [], pinned = [] }) {
  const beyond = ([u, v]) => Math.max(Math.abs(u - x), Math.abs(v - y)) > half;
  const text = (value) => String(Number(value.toPrecision(4))).replace("-", "−");
  const lines = pinned.filter(([, point]) => beyond(point)).map(([name, [u, v]]) => `pinned ${name} at (${text(u)}, ${text(v)}) µm`);
  if (trace.some(beyond)) lines.push("part of the trace");
  return lines.length ? [`outside the picture: ${lines.join("; ")}`] : [];
}

function draw(found, [mx, my, half], { trace = [], pinned = [] }) {
  const plot = SIDE - LEFT;
  const scale = plot / (2 * half);
  const at = ([x, y]) => [LEFT + (x - mx + half) * scale, TOP + (my + half - y) * scale];
  const svg = picture(SIDE + 8, TOP + plot + BOTTOM, `gear ${found.gear}: ${found.lines.join("; ")}`);
  svg.setAttribute("data-name", `gear ${found.gear}`);
  const id = `clip-${[...found.gear].map((c) => c.codePointAt(0)).join("-")}`;
  svg.append(shape("clipPath", { id }, shape("rect", { x: LEFT, y: TOP, width: plot, height: plot })));
  svg.append(shape("text", { x: LEFT, y: 16, "font-size": 13, "font-weight": 600 }, `Gear ${found.gear}`));
  axes(svg, found, [mx, my, half], at, plot);
  const inside = shape("g", { "clip-path": `url(#${id})` });
  for (const piece of found.pieces) inside.append(path(piece.map(at), { fill: FAINT, stroke: FAINT }, true));
  for (const [, edge] of found.edges) inside.append(path(edge.map(at), { stroke: INK, "stroke-width": 1.6 }));
  for (const [, ring] of found.circles)
    inside.append(path(ring.map(at), { stroke: SOFT, "stroke-width": 1.2, "stroke-dasharray": "5 3" }));
  const [ox, oy] = at([0, 0]);
  inside.append(path([[ox - 5, oy], [ox + 5, oy]], { stroke: SOFT }), path([[ox, oy - 5], [ox, oy + 5]], { stroke: SOFT }));
  if (trace.length) inside.append(path(trace.map(at), { stroke: found.colour, "stroke-width": 2, opacity: 0.35, class: "trace" }));
  for (const [name, point] of pinned) {
    const [x, y] = at(point);
    inside.append(shape("circle", { cx: x, cy: y, r: 6, fill: "none", stroke: INK, "stroke-dasharray": "2 2" },
      shape("title", {}, `pinned ${name}`)));
  }
  if (found.path.length > 1)
    inside.append(path(found.path.map(at), { stroke: found.colour, opacity: 0.6 }));
  for (const [x, y] of found.path.map(at)) inside.append(shape("circle", { cx: x, cy: y, r: 2.5, fill: found.colour }));
  const here = at(found.here), labels = new Labels(SIDE + 8, TOP + plot);
  labels.avoid(here[0] - 8, here[1] - 8, 16, 16);
  const words = [];
  if (found.reaction) {
    const length = 0.24 * plot, [u, v] = found.reaction;
    const tip = [here[0] + length * u, here[1] - length * v];
    inside.append(path(arrow(here, tip, 9), { stroke: WARNING, "stroke-width": 2, "stroke-linecap": "round" }));
    for (const part of [0.3, 0.6, 0.9]) labels.avoid(here[0] + part * length * u - 4, here[1] - part * length * v - 4, 8, 8);
    words.push(labels.place(found.force, around(tip, 12, 26).map(within), { fill: WARNING }));
  }
  inside.append(shape("circle", { cx: here[0], cy: here[1], r: 5.5, fill: found.colour, stroke: "#fff", class: "here" },
    shape("title", {}, `x ${found.here[0]} µm, y ${found.here[1]} µm`)));
  for (const [name, edge, out] of found.edges) words.push(labels.place(name, spots(edge, out, at, plot), { fill: SOFT }));
  for (const [name, ring] of found.circles)
    words.push(labels.place(name.split(" beyond")[0].split(" used")[0], spots(ring.filter((_, k) => k % 6 === 0), [0.7, 0.7], at, plot), { fill: SOFT }));
  svg.append(inside, ...words.filter(Boolean));
  return svg;
}

const within = ([x, y]) => [x, Math.max(TOP + 8, y)];

function spots(edge, [u, v], at, plot) {
  const parts = [0.5, 0.3, 0.7, 0.1, 0.9].map((part) => edge[Math.round(part * (edge.length - 1))]).map(at);
  const there = parts.filter(([x, y]) => x >= LEFT && x <= LEFT + plot && y >= TOP && y <= TOP + plot);
  return there.flatMap(([x, y]) => [[x + 26 * u, y - 11 * v], [x + 34 * u, y - 22 * v], [x - 26 * u, y + 11 * v]]).map(within);
}

function axes(svg, found, [mx, my, half], at, plot) {
  const foot = TOP + plot;
  for (const [value, text] of ticks(mx - half, mx + half)) {
    const [x] = at([value, my]);
    svg.append(path([[x, TOP], [x, foot]], { stroke: FAINT, "stroke-width": 0.6 }));
    svg.append(shape("text", { x, y: foot + 14, "text-anchor": "middle", "font-size": 10 }, text));
  }
  for (const [value, text] of ticks(my - half, my + half)) {
    const [, y] = at([mx, value]);
    svg.append(path([[LEFT, y], [LEFT + plot, y]], { stroke: FAINT, "stroke-width": 0.6 }));
    svg.append(shape("text", { x: LEFT - 4, y: y + 3.5, "text-anchor": "end", "font-size": 10 }, text));
  }
  svg.append(shape("text", { x: LEFT + plot / 2, y: foot + 32, "text-anchor": "middle" },
    `along ${found.axes[0]} [µm]; upwards along ${found.axes[1]}`));
}
