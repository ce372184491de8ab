"use strict";
// Figures: each has its specification beside it.
for (const place of document.querySelectorAll(".figure")) {
  const spec = JSON.parse(place.parentElement.querySelector("script.spec").textContent);
  const name = place.dataset.name || "figure";
  const actions = { export: { svg: true, png: true }, source: false, compiled: false, editor: false };
  // Expressions are interpreted: the page's policy lets nothing be compiled.
  const how = { renderer: "svg", ast: true, actions, downloadFileName: name };
  vegaEmbed(place, spec, how).catch(console.error);
}

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
