// The paper's table 1 beside ours, and how the cost grows with the number of bodies.
"use strict";

const heapRows = reportData.table1.rows;
const heapBodies = [...new Set(heapRows.map(row => row.bodies))].sort((a, b) => a - b);
const heapKeys = [...new Map(heapRows.map(row => [methodKey(row), describeMethod(row).priority]))].sort((a, b) => b[1] - a[1]).map(([key]) => key);
const heapCell = (key, bodies) => heapRows.find(row => methodKey(row) === key && row.bodies === bodies);
const paperNames = {full_plain: "the paper's meshes", low: "the paper's 194 faces", spheres7: "the paper's 7 spheres", "statistical/tables_published": "the paper's statistical"};

function growthConfig() {
  const line = (label, points, line, more) => ({label, data: points, borderColor: line, backgroundColor: line, borderWidth: 1.3, pointRadius: 3, direct: !isNarrow() || more.priority >= kNarrowPriority, showLine: true, ...more});
  const points = (key, field) => heapBodies.map(bodies => heapCell(key, bodies)).filter(row => row && row[field] !== null).map(row => ({x: row.bodies, y: row[field], row}));
  const datasets = heapKeys.map(key => {
    const method = describeMethod(heapRows.find(row => methodKey(row) === key));
    return line(method.name, points(key, "step_ms"), colour(method.colour), {emphasised: method.ours, borderWidth: method.ours ? 3 : 1.3, priority: method.priority, pointRadius: method.ours ? 5 : 3});
  });
  for (const key of ["full_plain", "statistical/tables_published"])
    datasets.push(line(paperNames[key] + ", 2009", points(key, "paper_step_ms"), colour("paper_line"), {borderDash: [5, 4], priority: 3}));
  const values = datasets.flatMap(dataset => dataset.data.map(point => point.y));
  return {
    type: "scatter", data: {datasets: datasets.filter(dataset => dataset.data.length)},
    options: {
      layout: {padding: {right: isNarrow() ? 95 : 170}},
      scales: {
        x: axis("bodies, all awake", {type: "logarithmic", min: heapBodies[0] * 0.9, max: heapBodies[heapBodies.length - 1] * 1.1}, heapBodies, value => value.toLocaleString("en-US")),
        y: axis("ms a step", {type: "logarithmic", min: Math.min(...values) * 0.6, max: Math.max(...values) * 1.6}, [0.001, 0.01, 0.1, 1, 10, 100, 1000, 10000], value => value.toLocaleString("en-US"))
      },
      plugins: {
        lineLabels: {show: true, beside: true},
        tooltip: {displayColors: false, callbacks: {title: items => items.length ? items[0].dataset.label + ", " + items[0].raw.x.toLocaleString("en-US") + " bodies" : "", label: item => msText(item.raw.y) + " a step, " + timeText(1e6 * item.raw.y / item.raw.x) + " a body"}}
      }
    }
  };
}

function growthFinding() {
  const ours = heapBodies.map(bodies => heapCell("statistical/support", bodies)).filter(row => row && row.step_ms !== null), last = ours[ours.length - 1];
  const others = last ? ["bullet_hull", "spheres7", "statistical/tables_published"].map(key => heapCell(key, last.bodies)).filter(row => row && row.step_ms !== null) : [];
  return "Milliseconds of a step against the number of bodies" + (last ? ": with " + last.bodies.toLocaleString("en-US") + " support takes " + msText(last.step_ms) + others.map(row => ", " + describeMethod(row).name + " " + msText(row.step_ms)).join("") : "") + ".";
}

// "7.28" and, smaller, how many times less, or more, than meshes.
function heapCellText(key, bodies, field) {
  const row = heapCell(key, bodies), meshes = heapCell("full_plain", bodies);
  if (!row || row[field] === null) return "–";
  const ratio = key !== "full_plain" && meshes && meshes[field] ? meshes[field] / row[field] : null;
  const times = ratio === null ? [] : [make("small", {}, ratio >= 1 ? shortNumber(ratio) + " × less" : shortNumber(1 / ratio) + " × more")];
  return make("span", {}, shortNumber(row[field]), ...times);
}

function startTable1() {
  drawChart("table1_chart", growthConfig, growthFinding());
  byId("table1_note").textContent = growthFinding() + " Dashed: what the paper measured on the machine of its time. A line that climbs by more than ten for ten times the bodies says that crowding costs more than the bodies themselves.";
  const rows = [];
  for (const key of heapKeys) {
    const method = describeMethod(heapRows.find(row => methodKey(row) === key));
    rows.push({ours: method.ours, cells: [method.name, ...heapBodies.map(bodies => heapCellText(key, bodies, "step_ms"))]});
    if (paperNames[key]) rows.push({cells: [make("em", {}, paperNames[key]), ...heapBodies.map(bodies => heapCellText(key, bodies, "paper_step_ms"))]});
  }
  byId("table1_table").append(makeTable("Milliseconds of a step; below, how many times less than ODE's meshes (in the paper's rows: than its own). –: left out, as it would take too long, or not in the paper.",
    ["method", ...heapBodies.map(bodies => bodies.toLocaleString("en-US") + " bodies")], rows));
}
