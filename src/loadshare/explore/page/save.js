// The view as a link and as a picture; the setting as a case file.
import { byId, shape } from "./dom.js";
import { failed, post } from "./ask.js";

const NAMES = 200;

const done = (text) => { byId("done").textContent = text; };

// What a link says; what is not of its form is left out, and the server checks the rest.
export function linked(inputs) {
  const nothing = { changes: {}, names: [], position: 1 };
  if (location.hash.length < 2) return nothing;
  try {
    const found = JSON.parse(decodeURIComponent(location.hash.slice(1)));
    const usable = ([key, value]) => inputs.has(key) && (typeof value === "string" || typeof value === "number");
    const all = Object.entries(found.changes || {}), changes = Object.fromEntries(all.filter(usable));
    const names = (Array.isArray(found.names) ? found.names : []).filter((name) => typeof name === "string").slice(0, NAMES);
    const left = all.length - Object.keys(changes).length;
    if (left) done(`${left} changes of the link are no inputs of this case, and were left out.`);
    return { changes, names, position: Number.isInteger(found.position) && found.position > 0 ? found.position : 1 };
  } catch {
    done("The link could not be read; this is the case as it stands.");
    return nothing;
  }
}

export async function copyLink(view) {
  const url = new URL(location.href);
  url.hash = encodeURIComponent(JSON.stringify(view));
  history.replaceState(null, "", url);
  try {
    await navigator.clipboard.writeText(url.href);
    done("The link is copied; it also stands in the address bar.");
  } catch {
    done("The link stands in the address bar.");
  }
}

function download(content, kind, name) {
  const url = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type: kind }));
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
  done(`${name} is saved among your downloads.`);
}

export async function saveText(view) {
  const found = await post("toml", { changes: view.changes }).catch(failed);
  if (!found.text) { done((found.messages || []).join(" ")); return; }
  download(found.text, "application/toml", found.name);
  if (found.note) done(`${found.name} is saved among your downloads. ${found.note}`);
}

const GAP = 16, WIDE = 1000, HEAD = 58;

// All pictures of the view on one sheet, with what it is of.
function sheet(page, describe) {
  const made = shape("svg", { xmlns: "http://www.w3.org/2000/svg", "font-family": "Helvetica, Arial, sans-serif" });
  let x = GAP, y = HEAD, tall = 0, wide = 0;
  for (const svg of document.querySelectorAll("#answer figure:not([hidden]) > svg")) {
    const width = Number(svg.getAttribute("width")), height = Number(svg.getAttribute("height"));
    if (x > GAP && x + width > WIDE) { x = GAP; y += tall + GAP; tall = 0; }
    const copy = svg.cloneNode(true);
    copy.setAttribute("x", x); copy.setAttribute("y", y);
    made.append(copy);
    x += width + GAP; tall = Math.max(tall, height); wide = Math.max(wide, x);
  }
  const width = Math.max(wide, 420), height = y + tall + GAP;
  for (const [name, value] of [["width", width], ["height", height], ["viewBox", `0 0 ${width} ${height}`]]) made.setAttribute(name, value);
  const letters = Math.floor(width / 7);
  const lines = [page.case.title, describe(page.shown), byId("note").textContent].map((t) => (t.length > letters ? `${t.slice(0, letters - 1)}…` : t));
  made.prepend(shape("rect", { width, height, fill: "#fff" }));
  lines.forEach((line, k) => made.append(shape("text", { x: GAP, y: 18 + 15 * k, "font-size": k ? 11 : 13, "font-weight": k ? 400 : 600, fill: "#1f2933" }, line)));
  return made;
}

export async function savePicture(kind, page, describe) {
  if (document.body.dataset.state !== "present") { done("There is no answer for this setting to be drawn."); return; }
  const svg = sheet(page, describe), text = new XMLSerializer().serializeToString(svg);
  const name = `${page.case.name || "case"}.${kind}`.replace(/[^\w.-]+/g, "_");
  if (kind === "svg") { download(text, "image/svg+xml", name); return; }
  const image = new Image(), url = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
  image.src = url;
  await image.decode();
  const canvas = document.createElement("canvas"), scale = 2;
  canvas.width = scale * svg.getAttribute("width"); canvas.height = scale * svg.getAttribute("height");
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  URL.revokeObjectURL(url);
  canvas.toBlob((blob) => download(blob, "image/png", name), "image/png");
}
