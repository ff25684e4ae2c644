// Speed against error: one chart, a switch for the shape.
"use strict";

const methodOf = {
  "statistical/support": {name: "support", colour: "support", ours: true, priority: 12, what: "Lodestone's better stand-in: the convex hull, impacts at their exact time, settling as ODE's was recorded."},
  "statistical/tables": {name: "tables", colour: "tables", ours: true, priority: 12, what: "Lodestone's cheapest: a body alone moves on its hull; among others it meets each in one point."},
  "statistical/tables_published": {name: "tables, published", colour: "tables", ours: true, priority: 11, what: "The paper's idea: a sphere whose bounces and rest poses are drawn from what was measured of the shape."},
  "full": {name: "full", colour: "full", ours: true, priority: 10, what: "Lodestone's full level: the mesh in ODE, four substeps in each step, contacts with planes of its own."},
  "full_1": {name: "ODE single steps", colour: "ode", priority: 9, what: "The same mesh and contacts in ODE without substeps."},
  "full_plain": {name: "ODE mesh", colour: "ode", priority: 8, what: "The mesh in ODE as anyone would first write it."},
  "hull": {name: "ODE hull", colour: "ode", priority: 5, what: "The convex hull in ODE."},
  "low": {name: "ODE 194 faces", colour: "ode", priority: 3, what: "A mesh simplified to 194 faces in ODE: the paper's low resolution."},
  "spheres7": {name: "ODE 7 spheres", colour: "ode", priority: 6, what: "Seven spheres for the shape in ODE, as in the paper."},
  "sphere": {name: "ODE 1 sphere", colour: "ode", priority: 4, what: "One sphere for the shape in ODE."},
  "bullet_hull": {name: "Bullet hull", colour: "bullet", priority: 7, what: "The convex hull in Bullet, another engine."},
  "bullet_sphere": {name: "Bullet sphere", colour: "bullet", priority: 2, what: "One sphere in Bullet."}
};
const kNarrowPriority = 7;  // where there is little room, only names from this on stand beside their lines
const methodKey = row => row.model ? row.method + "/" + row.model : row.method;
const describeMethod = row => methodOf[methodKey(row)] || {name: methodKey(row), colour: "ode", priority: 0, what: ""};
const pointStyles = {full_1: "rect", full_plain: "circle", hull: "triangle", low: "rectRot", spheres7: "star", sphere: "crossRot", bullet_hull: "triangle", bullet_sphere: "crossRot"};

const scoreParts = [["w_bounces", "number of bounces", "bounces"], ["w_rest_time", "time to rest", "rest time"], ["w_distance", "distance", "distance"], ["w_peak", "first rebound", "rebound"],
  ["ke_w", "energy over time", "energy"], ["tv", "which side it rests on", "side"]];
const isFrameStep = row => Math.abs(row.dt_s - 1 / 60) < 1e-4;
const curveShapes = reportData.curve.shapes;
let curveShape = curveShapes[0];

// One dataset for each method that was measured, its points by step, the largest first.
function curveDatasets(shape) {
  const lines = new Map();
  for (const row of shape.rows) {
    if (row.score === null || row.ns_per_frame === null) continue;
    if (!lines.has(methodKey(row))) lines.set(methodKey(row), []);
    lines.get(methodKey(row)).push(row);
  }
  return [...lines.values()].map(rows => {
    const method = describeMethod(rows[0]), line = colour(method.colour);
    rows.sort((a, b) => b.dt_s - a.dt_s);
    return {
      label: method.name, emphasised: method.ours, priority: method.priority, direct: !isNarrow() || method.priority >= kNarrowPriority, labelAt: 0,
      data: rows.map(row => ({x: row.ns_per_frame, y: row.score, from: row.score_from, to: row.score_to, row})),
      borderColor: line, backgroundColor: method.ours ? line : colour("paper"), borderWidth: method.ours ? 3 : 1.2, showLine: true,
      pointStyle: method.ours ? "circle" : pointStyles[rows[0].method] || "circle", pointBorderWidth: method.ours ? 1 : 1.6,
      pointRadius: rows.map(row => (method.ours ? 2 : 0) + (isFrameStep(row) ? 6 : 3)), pointHoverRadius: 9
    };
  }).sort((a, b) => b.priority - a.priority);  // the first are drawn over the others
}

function curveTooltip(item) {
  const {row} = item.raw;
  const lines = ["score " + scoreText(row.score) + ", 95 % sure between " + scoreText(Math.max(0, row.score_from)) + " and " + scoreText(row.score_to),
    timeText(row.ns_per_frame) + " in 1/60 s, " + timeText(row.ns_per_body_step) + " in a step"];
  for (const [key, name] of scoreParts) lines.push("   " + name + " " + (row[key] === null ? "–" : scoreText(row[key])));
  return lines;
}

function curveConfig() {
  const datasets = curveDatasets(curveShape), floor = curveShape.floor;
  const scores = curveShape.rows.filter(row => row.score !== null);
  const least = Math.min(floor.score, ...scores.map(row => row.score)), greatest = Math.max(...scores.map(row => row.score_to));
  const costs = scores.map(row => row.ns_per_frame).filter(cost => cost !== null);
  return {
    type: "scatter", data: {datasets},
    options: {
      layout: {padding: {right: 12, top: 8}},
      scales: {
        x: axis(isNarrow() ? "processor time of a body in 1/60 s" : "processor time of one body in 1/60 s (each line ten times the one before)", {type: "logarithmic", min: Math.min(...costs) * 0.6, max: Math.max(...costs) * 1.8}, [1e2, 1e3, 1e4, 1e5, 1e6, 1e7], ns => timeText(ns).replace(/\.0+ /, " ")),
        y: axis(isNarrow() ? "score (0: the truth)" : "score: how far from the truth (lower is better)", {type: "logarithmic", min: least * 0.55, max: greatest * 1.4}, [0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30], String)
      },
      plugins: {
        band: {from: floor.score_from, to: floor.score_to, at: floor.score, label: "noise floor"},
        lineLabels: {show: true, avoidPoints: true},
        tooltip: {displayColors: false, callbacks: {title: items => items.length ? items[0].dataset.label + ", step " + stepText(items[0].raw.row.dt_s) : "", label: curveTooltip}}
      }
    }
  };
}

function curveFinding() {
  const best = key => curveShape.rows.find(row => methodKey(row) === key && isFrameStep(row));
  const parts = Object.keys(methodOf).map(best).filter(row => row && row.score !== null).slice(0, 4);
  return "Speed against error of the " + curveShape.title + ": at steps of 1/60 s " + parts.map(row => describeMethod(row).name + " scores " + scoreText(row.score) + " for " + timeText(row.ns_per_body_step)).join(", ") +
    "; the noise floor is " + scoreText(curveShape.floor.score) + ".";
}

function showCurve(index) {
  curveShape = curveShapes[index];
  drawChart("curve_chart", curveConfig, curveFinding());
  const drops = curveShape.trials, made = curveShape.made;
  byId("curve_note").textContent = "The " + curveShape.title + ", " + curveShape.material + "; " + drops + " drops of each method" + (made.fresh ? ", on this machine just now" : "") + ". Both axes are logarithmic. Whiskers: 95 % intervals; green band: where the noise floor lies, 95 % sure. " +
    "Point or focus on a point for the six parts of its score.";
}

// Scores, times and the six parts, as text.
function scoreCells(row) {
  return [scoreText(row.score), scoreText(Math.max(0, row.score_from)) + " – " + scoreText(row.score_to), timeText(row.ns_per_frame), timeText(row.ns_per_body_step), ...scoreParts.map(([key]) => row[key] === null ? "–" : scoreText(row[key]))];
}

// The best known first, of each method the longest step first.
function curveTable(shape) {
  const measured = shape.rows.filter(row => row.score !== null).sort((a, b) => describeMethod(b).priority - describeMethod(a).priority || b.dt_s - a.dt_s);
  const rows = [{cells: ["noise floor", "–", ...scoreCells({...shape.floor, ns_per_frame: null})]}, ...measured.map(row => ({ours: describeMethod(row).ours, cells: [describeMethod(row).name, stepText(row.dt_s), ...scoreCells(row)]}))];
  const leftOut = new Map(shape.rows.filter(row => row.score === null).map(row => [describeMethod(row).name, row.reason]));
  const caption = shape.title + ", " + shape.trials + " drops" + [...leftOut].map(([name, reason]) => "; " + name + " left out: " + shape.name + " " + reason).join("");
  return makeTable(caption, ["method", "step", "score", "95 % interval", "in 1/60 s", "in a step", ...scoreParts.map(([, , short]) => short)], rows);
}

function methodTable() {
  const table = makeTable("Every way to simulate a body that is compared here", ["method", "in commands", "what it is"],
    Object.entries(methodOf).map(([key, method]) => ({cells: [method.name, make("code", {}, key.replace("/", ", ")), method.what]})), 3);
  for (const line of table.tBodies[0].rows) line.cells[2].className = "wrap";
  return table;
}

function curveTables() {
  byId("curve_table").append(...curveShapes.map(curveTable));
  byId("curve_methods").append(methodTable());
}

function startCurve() {
  makeSwitch(byId("curve_switch"), curveShapes.map(shape => shape.name), showCurve);
  showCurve(0);
  curveTables();
}
