"use strict";
// Figures: each has its specification next to it.
const SMALLEST = 0.82; // of their size; what is still too wide scrolls in its own box

function wrapped(lines, letters) {
  const found = [];
  for (const line of [lines].flat()) {
    let rest = "";
    for (const word of line.split(" ")) {
      if (rest && rest.length + word.length >= letters) { found.push(rest); rest = word; }
      else rest = rest ? `${rest} ${word}` : word;
    }
    found.push(rest);
  }
  return found;
}
// As many panels in a row as there is room for, and titles of many lines rather than cut ones.
function fitted(spec, room, columns) {
  const { hconcat, ...rest } = structuredClone(spec);
  const made = hconcat ? { ...rest, concat: hconcat } : rest;
  if (made.concat) made.columns = columns;
  if (made.title && typeof made.title === "object") {
    made.title.text = wrapped(made.title.text, room / 7);
    made.title.subtitle = wrapped(made.title.subtitle || [], room / 5.5);
  }
  return made;
}
async function draw(place) {
  const spec = JSON.parse(place.parentElement.querySelector("script.spec").textContent);
  const room = place.closest(".pictures").clientWidth;
  const name = place.dataset.name || "figure";
  const actions = { export: { svg: true, png: true }, source: false, compiled: false, editor: false };
  // Expressions are interpreted: the page's policy lets nothing be compiled.
  const how = { renderer: "svg", ast: true, actions, downloadFileName: name };
  const panels = (spec.concat || spec.hconcat || [0]).length;
  let columns = Math.min(spec.columns || panels, panels);
  for (;;) {
    await vegaEmbed(place, fitted(spec, room - 20, columns), how);
    const svg = place.querySelector("svg.marks");
    const width = Number(svg.getAttribute("width"));
    svg.style.minWidth = `${Math.floor(SMALLEST * width)}px`;
    if (width <= room || columns === 1) break;
    columns = Math.max(1, Math.min(columns - 1, Math.floor((columns * room) / width)));
  }
  place.querySelector("summary").setAttribute("aria-label", `save the picture ${name}`);
  place.dataset.drawn = "yes";
}
for (const place of document.querySelectorAll(".figure")) draw(place).catch(console.error);

// Tables: a click on a header sorts by it, another one turns the order round.
function key(row, column) {
  const cell = row.cells[column];
  return "value" in cell.dataset ? Number(cell.dataset.value) : cell.textContent.trim();
}
function compare(a, b) {
  if (typeof a === "number" && typeof b === "number") return a - b;
  if (typeof a !== typeof b) return typeof a === "number" ? -1 : 1;
  return a.localeCompare(b, "en", { numeric: true });
}
for (const table of document.querySelectorAll("table.sortable")) {
  const headers = [...table.tHead.rows[0].cells];
  headers.forEach((header, column) => header.firstElementChild.addEventListener("click", () => {
    const falling = header.getAttribute("aria-sort") === "ascending";
    headers.forEach((other) => other.removeAttribute("aria-sort"));
    header.setAttribute("aria-sort", falling ? "descending" : "ascending");
    const rows = [...table.tBodies[0].rows];
    rows.sort((a, b) => compare(key(a, column), key(b, column)) * (falling ? -1 : 1));
    table.tBodies[0].append(...rows);
  }));
}

// Paper cannot be unfolded.
addEventListener("beforeprint", () => {
  for (const folded of document.querySelectorAll("article details:not(.vega-embed details)")) folded.open = true;
});
