// A tolerance study of one setting, as it grows; every figure comes from the server.
import { INK, FAINT, SOFT, WARNING, Labels, byId, element, path, picture, shape, table, ticks } from "./dom.js";
import { Lines } from "./ask.js";
import { why } from "./studies.js";

const asking = new Lines("study/tolerance"), SHOWN = "";
const FIELDS = [["samples", 4096], ["seed", 0], ["limit", ""]];
let of = null; // the setting of the study that is shown

const setting = ({ changes, position }) => JSON.stringify([changes, position]);

// The studies of the case, and one of what the page shows.
export function offer(studies) {
  const list = byId("scatter"), fill = () => {
    for (const [name, plain] of FIELDS) byId(name).value = studies[list.value]?.[name] ?? plain;
  };
  const own = Object.keys(studies).map((name) => element("option", { value: name }, `study ${name} of the case`));
  list.replaceChildren(...own, element("option", { value: SHOWN }, "the inputs that are shown"));
  list.addEventListener("change", fill);
  byId("stop").addEventListener("click", () => stop("stopped"));
  fill();
}

const numbers = () => Object.fromEntries(FIELDS.map(([name]) => [name, byId(name).value.trim()]).filter(([, text]) => text !== "").map(([name, text]) => [name, Number(text)]));

export async function begin(view, controls, describe) {
  const study = byId("scatter").value, status = byId("sampled");
  const ranges = Object.fromEntries(controls.map((one) => [one.name, [one.input.low, one.input.high]]));
  of = setting(view);
  byId("stop").disabled = false;
  byId("growing").hidden = true;
  byId("statistics").replaceChildren();
  byId("histogram").replaceChildren();
  status.textContent = "the study begins …";
  let samples = 0, limit = null;
  const whole = await asking.ask({ ...view, ...numbers(), ...(study === SHOWN ? { ranges } : { study }) }, (found) => {
    if (found.begun) {
      ({ samples, limit } = found.begun);
      about(found.begun, describe(view));
    } else if (found.done) {
      status.textContent = `${found.done} of ${samples} samples${found.done < samples ? " …" : ""}`;
      show(found, limit);
    } else status.textContent = `${status.textContent} ${why(found)}`;
  });
  if (whole) byId("stop").disabled = true;
}

function stop(word) {
  if (byId("stop").disabled) return;
  asking.stop();
  byId("stop").disabled = true;
  byId("sampled").textContent = `${word}: ${byId("sampled").textContent.replace(/ …$/, "")}`;
}

// With another setting a study ends; what it found stays, and says of what it is.
export function forget(view) {
  if (of === null) return;
  const other = setting(view) !== of;
  if (other) stop("stopped, as the setting has changed");
  byId("growing").dataset.earlier = other;
  byId("earlier").hidden = !other;
}

function about(study, text) {
  byId("growing").hidden = false;
  byId("growing").dataset.earlier = false;
  byId("earlier").hidden = true;
  byId("sampled-of").textContent = text;
  const where = study.positions.length === 1 ? `position ${study.positions[0]}` : `${study.positions.length} positions`;
  const slow = study.engine === "compiled" ? "" : " Solved by NumPy, which is slow: “loadshare warm” compiles what is fast.";
  const left = study.left.length ? ` Counts and geometry do not scatter: ${study.left.join(", ")}.` : "";
  byId("drawn").textContent = `${study.samples} ${study.sampling} samples, seed ${study.seed}, ${where}.${left}${slow}`;
  byId("scattering").replaceChildren(...table({ columns: [["input", false], ["scatters", false]], rows: study.inputs }));
  byId("scatter-toml").textContent = study.toml;
}

function show(found, limit) {
  const refused = found.refused ? element("p", { class: "problems" }, `${found.refused} of ${found.done} samples have no certified answer and are in no figure: ${found.reasons.join("; ")}`) : "";
  byId("statistics").replaceChildren(refused, ...(found.table ? table(found.table) : []),
    element("p", { class: "note" }, `Largest residual of all certificates: ${found.residual}.`));
  if (found.histogram) drawHistogram(found.histogram, limit);
}

const WIDTH = 460, FOOT = 204, TOP = 40, LEFT = 46, RIGHT = 14;

function drawHistogram({ edges, counts, marks }, limit) {
  const low = edges[0], high = edges.at(-1), most = Math.max(...counts), right = WIDTH - RIGHT;
  const at = (value) => LEFT + ((right - LEFT) * (value - low)) / (high - low), up = (count) => FOOT - ((FOOT - TOP) * count) / most;
  const svg = picture(WIDTH, FOOT + 42, "how the largest Ω of a sample scatters");
  svg.setAttribute("data-name", "histogram");
  for (const [value, text] of ticks(0, most, 4))
    svg.append(path([[LEFT, up(value)], [right, up(value)]], { stroke: FAINT }), shape("text", { x: LEFT - 5, y: up(value) + 3.5, "text-anchor": "end", "font-size": 10 }, text));
  counts.forEach((count, k) => count && svg.append(shape("rect", { x: at(edges[k]), width: Math.max(at(edges[k + 1]) - at(edges[k]) - 0.6, 0.6), y: up(count), height: FOOT - up(count),
    fill: "#1b4f8f" }, shape("title", {}, `${count} samples from ${edges[k].toFixed(5)} to ${edges[k + 1].toFixed(5)}`))));
  svg.append(path([[LEFT, FOOT], [right, FOOT]], { stroke: INK }));
  const labels = new Labels(WIDTH, FOOT);
  const lines = [...(limit > low && limit < high ? [["limit", limit, WARNING]] : []), ...marks.map(([name, value]) => [name, value, SOFT])];
  for (const [name, value, colour] of lines) {
    const x = at(value), word = labels.place(name, [[x, 26], [x, 12]], { fill: colour, "font-size": 10 });
    svg.append(path([[x, TOP], [x, FOOT]], { stroke: colour, "stroke-dasharray": "4 3" }));
    if (word) svg.append(word);
  }
  for (const [value, text] of ticks(low, high, 5)) {
    svg.append(path([[at(value), FOOT], [at(value), FOOT + 4]], { stroke: SOFT }));
    svg.append(shape("text", { x: Math.min(Math.max(at(value), 20), WIDTH - 20), y: FOOT + 16, "text-anchor": "middle", "font-size": 10 }, text));
  }
  svg.append(shape("text", { x: (LEFT + right) / 2, y: FOOT + 34, "text-anchor": "middle" }, "largest Ω of a sample, of the system"));
  byId("histogram").replaceChildren(svg);
}
