// The train to scale, drawn once for a geometry; the forces of its flanks, drawn for every answer.
import { INK, SOFT, WARNING, Labels, around, broadArrow, path, picture, shape } from "./dom.js";

const ROOM = 520, EDGE = 14, HEAD = 24;
const DASH = "4 3", CENTRE = "10 3 2 3", WIDEST = 9;
let drawn = null, largest = 0;

export function drawTrain(figure, shapes) {
  for (const old of figure.querySelectorAll("svg")) old.remove();
  drawn = null;
  figure.hidden = !shapes;
  if (!shapes) return;
  drawn = shapes.views.map((view, k) => draw(view, k === 0));
  figure.prepend(...drawn.map((one) => one.svg));
  figure.dataset.of = JSON.stringify(shapes).length;
}

function draw(view, plan) {
  const wide = view.high[0] - view.low[0], tall = view.high[1] - view.low[1];
  const scale = Math.min(ROOM / wide, ROOM / tall);
  const width = wide * scale + 2 * EDGE, height = tall * scale + 2 * EDGE + HEAD;
  const at = ([x, y]) => [EDGE + (x - view.low[0]) * scale, HEAD + EDGE + (view.high[1] - y) * scale];
  const svg = picture(Math.max(width, 200), height, `the train, ${view.title.toLowerCase()}`);
  svg.setAttribute("data-name", plan ? "train" : "train from the side");
  const labels = new Labels(Math.max(width, 200), height);
  labels.avoid(0, 0, 200, 20);
  svg.append(shape("text", { x: EDGE, y: 15, "font-weight": 600 }, `${view.title}; right: ${view.axes[0]}, up: ${view.axes[1]}`));
  for (const ends of view.shafts)
    svg.append(path(ends.map(at), { stroke: SOFT, "stroke-width": 3, opacity: 0.35 }));
  for (const gear of view.gears) {
    for (const one of gear.full) svg.append(ring(gear, one, at, scale, {}));
    for (const one of gear.dashed) svg.append(ring(gear, one, at, scale, { "stroke-dasharray": DASH }));
  }
  const forces = shape("g", { class: "forces" });
  svg.append(forces);
  const spots = new Map();
  for (const gear of view.gears) {
    const [x, y] = at(gear.centre), floats = gear.held === "floats";
    svg.append(shape("circle", { cx: x, cy: y, r: 3.5, fill: floats ? "#fff" : INK, stroke: INK, "stroke-width": 1.4 },
      shape("title", {}, `gear ${gear.name}: ${gear.held}${gear.role ? `, ${gear.role}` : ""}`)));
    labels.avoid(x - 5, y - 5, 10, 10);
    const near = [...spots.keys()].find(([u, v]) => Math.hypot(u - x, v - y) < 2) || [x, y];
    spots.set(near, [...(spots.get(near) || []), gear.role ? `${gear.name} (${gear.role})` : gear.name]);
  }
  for (const [spot, names] of spots) {
    const word = labels.place(names.join(", "), around(spot), { "font-weight": 600 });
    if (word) svg.append(word);
  }
  return { svg, forces, at, view, size: Math.min(width, height), plan };
}

function ring(gear, one, at, scale, more) {
  const style = { fill: "none", stroke: gear.colour, "stroke-width": 1.3, ...more };
  if (!gear.round) return path(one.map(at), style);
  const [x, y] = at(gear.centre);
  return shape("circle", { cx: x, cy: y, r: one * scale, ...style });
}

export function drawForces(forces) {
  const sizes = Object.values(forces || {}).map(Math.abs);
  largest = Math.max(largest, ...sizes, 0);
  for (const one of drawn || []) {
    const arrows = [];
    for (const mesh of one.view.meshes) {
      const force = (forces || {})[mesh.name];
      if (!force || !mesh.push || !largest) continue;
      const way = Math.sign(force), size = Math.hypot(...mesh.push);
      const title = shape("title", {}, `mesh ${mesh.name}: ${force.toPrecision(4)} N`);
      const [x, y] = one.at(mesh.at), stroke = WIDEST * Math.abs(force) / largest;
      if (size < 0.05) {
        arrows.push(shape("circle", { cx: x, cy: y, r: Math.max(stroke / 2, 0.5) + 1, fill: WARNING }, title));
        continue;
      }
      const [u, v] = [way * mesh.push[0], -way * mesh.push[1]];
      const length = 0.11 * one.size, tip = [x + length * u, y + length * v], back = [x - 0.35 * length * u, y - 0.35 * length * v];
      const made = path(broadArrow(back, tip, Math.max(stroke, 0.5)), { fill: WARNING, opacity: 0.85, "data-mesh": mesh.name }, true);
      made.append(title);
      arrows.push(made);
    }
    one.forces.replaceChildren(...arrows);
  }
}

export const forgetForces = () => { largest = 0; };
