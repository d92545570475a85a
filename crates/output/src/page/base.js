"use strict";
// The data of the run, from the element `data`, and how numbers, units and tables are read.
const { units: known, quantities, probes, contacts, files, pictures, body, ...rest } = JSON.parse(document.getElementById("data").textContent);
const ended = Boolean(rest.report), report = rest.report || {};
const $ = (selector, inside = document) => inside.querySelector(selector);
const element = (name, text = "", className = "") =>
  Object.assign(document.createElement(name), { textContent: text, className });

// The units of the run: those of the scene, or SI, where numbers get a prefix. They may be unknown if the run did not end.
const SI = { length: "m", stress: "Pa", force: "N", moment: "N m", energy: "J", area: "m2", energy_per_area: "J/m2" };
const unit = (quantity) => (!known ? "" : known[quantity] ? known[quantity].name : SI[quantity]) || "";
const factor = (quantity) => (known && known[quantity] ? known[quantity].si : 1);
const unitOf = (column) => (column === "time" ? "s" : unit(quantities[column]));
const LENGTH = unit("length"), STRESS = unit("stress"), FORCE = unit("force"), ENERGY = unit("energy");

const PREFIXES = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]];
const LARGEST = { m: 1 };
for (const name of ["Pa", "N", "J", "N m", "N/m", "J/m", "N m/m", "J/m2"]) LARGEST[name] = Infinity;
function prefix(size, unit) {
  const isSi = known && (!known.length || (LENGTH === "m" && STRESS === "Pa"));
  const found = isSi && size > 0 && LARGEST[unit] ? PREFIXES.filter(([s]) => s <= LARGEST[unit]) : [[1, ""]];
  return found.find(([s]) => size >= s) || found[found.length - 1];
}
function rounded(x, unit, digits = 4) {
  const [size, name] = prefix(Math.abs(x), unit);
  return `${plain(x / size, digits)} ${name}${unit}`.trim();
}
const scaled = (values, unit) => {
  const [size, name] = prefix(values.reduce((most, x) => (Number.isFinite(x) ? Math.max(most, Math.abs(x)) : most), 0), unit);
  return [values.map((x) => x / size), name + unit];
};
const percent = (x) => `${100 * x < 0.05 ? 0 : plain(100 * x, 2)} %`;
const titled = (name, unit) => (unit ? `${name}, ${unit}` : name);
const number = (cell) => (cell === undefined || cell === "" ? NaN : Number(cell));

function parse(text) {
  // A cell in quotes may hold commas, and a quote twice.
  const cells = (line) => (line.match(/("([^"]|"")*"|[^,]*)(,|$)/g) || []).slice(0, line.endsWith(",") ? undefined : -1)
    .map((cell) => cell.replace(/,$/, "")).map((cell) => (cell.startsWith('"') ? cell.slice(1, -1).replaceAll('""', '"') : cell));
  const [head, ...lines] = text.trimEnd().split("\n").map(cells);
  return { head, rows: lines.map((line) => Object.fromEntries(head.map((name, k) => [name, line[k]]))) };
}
const increments = files["increments.csv"] ? parse(files["increments.csv"]).rows : [];
const times = new Map(increments.map((row) => [Number(row.index), Number(row.time)]));
const failed = new Set(increments.filter((row) => row.status !== "converged").map((row) => Number(row.index)));
