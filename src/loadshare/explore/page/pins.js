// Pinned settings next to the present one, figure by figure.
import { element, table } from "./dom.js";

export const pinnedBars = (pins) => pins.map((pin) => [pin.name, new Map(pin.answer.bars.map((bar) => [bar.mesh, bar.most]))]);

// Figures of an answer by what they are of: text and value.
function figures(answer) {
  const found = new Map();
  for (const one of answer.tables) {
    const words = one.columns.flatMap(([, figure], k) => (figure ? [] : [k]));
    one.rows.forEach((row, r) => one.columns.forEach(([title, figure], k) => {
      const of = one.title === "Largest forces" || one.title === "Where the floats rest" ? row[words[0]] : `stage ${row[words[0]]}`;
      if (figure) found.set(`${of}: ${title}`, [row[k], one.values[r][k]]);
      else if (title === "rests") found.set(`gear ${row[words[0]]}: ${title}`, [row[k], null]);
    }));
  }
  return found;
}

function changed(from, to) {
  if (from === null || to === null || from === undefined || to === undefined) return "";
  if (from === to) return "0 %";
  if (!from) return "from 0";
  return `${((100 * (to - from)) / Math.abs(from)).toPrecision(3)} %`.replace("-", "−");
}

export function comparison(pins, shown, describe, unpin) {
  if (!pins.length) return [];
  const settings = [...pins.map((pin) => [pin.name, pin]), ["now", shown]];
  const known = settings.map(([, one]) => figures(one.answer));
  const keys = [...new Set(known.flatMap((one) => [...one.keys()]))];
  const columns = [["figure", false], ...settings.map(([name]) => [name, true]), [`change, ${settings[0][0]} to now`, true]];
  const rows = keys.map((key) => {
    const cells = known.map((one) => one.get(key) || ["–", null]);
    return [key, ...cells.map(([text]) => text), changed(cells[0][1], cells.at(-1)[1])];
  });
  const notes = pins.map((pin) => element("li", {}, `${pin.name}: ${describe(pin)} `,
    element("button", { type: "button", "aria-label": `unpin ${pin.name}`, onclick: () => unpin(pin.name) }, "unpin")));
  return [element("ul", {}, ...notes), ...table({ columns, rows, notes: [] })];
}
