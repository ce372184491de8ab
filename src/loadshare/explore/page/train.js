// The train to scale, drawn once for a geometry; the forces of its flanks, drawn for every answer.
import { INK, SOFT, WARNING, Labels, around, broadArrow, path, picture, shape } from "./dom.js";

const ROOM = 520, EDGE = 14, HEAD = 24;
const DASH = "4 3", CENTRE = "10 3 2 3", WIDEST = 9;
let drawn = null, strongest = 0; // the force that is drawn as wide as arrows get [N]

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

// One arrow for every flank that carries. The scale stays as long as the largest force is near it.
export function drawForces(forces = []) {
  const largest = Math.max(0, ...forces.map((one) => one.force));
  if (largest > strongest || largest < 0.4 * strongest) strongest = largest;
  for (const one of drawn || []) {
    const places = new Map(one.view.meshes.map((mesh) => [mesh.name, mesh.at]));
    one.forces.replaceChildren(...forces.filter(({ mesh }) => places.has(mesh)).map((force) => forceArrow(one, force, one.at(places.get(force.mesh)))));
  }
}

function forceArrow(one, { mesh, force, push, text }, [x, y]) {
  const title = shape("title", {}, text), stroke = (WIDEST * force) / strongest;
  const [u, v] = one.view.frame.map((axis) => axis.reduce((sum, part, k) => sum + part * push[k], 0));
  if (Math.hypot(u, v) < 0.05) return shape("circle", { cx: x, cy: y, r: Math.max(stroke / 2, 0.5) + 1, fill: WARNING }, title);
  const length = 0.11 * one.size, tip = [x + length * u, y - length * v], back = [x - 0.35 * length * u, y + 0.35 * length * v];
  const made = path(broadArrow(back, tip, Math.max(stroke, 0.5)), { fill: WARNING, opacity: 0.85, "data-mesh": mesh }, true);
  made.append(title);
  return made;
}
