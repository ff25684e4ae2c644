// Charts that follow the page's colours, answer to arrow keys and say what they show.
"use strict";

Chart.defaults.font.family = "system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', sans-serif";
Chart.defaults.animation = false;  // nothing moves: no need to ask whether that is wanted
Chart.defaults.maintainAspectRatio = false;
Chart.defaults.plugins.legend.display = false;

// An axis with a title and, where `ticks` is given, these ticks.
function axis(title, more = {}, ticks, text) {
  const scale = {title: {display: Boolean(title), text: title, color: colour("faint")}, grid: {color: colour("line"), borderColor: colour("line")}, ticks: {color: colour("faint"), maxRotation: 0}, ...more};
  if (ticks) scale.afterBuildTicks = axis => { axis.ticks = ticks.filter(value => value >= axis.min * 0.999 && value <= axis.max * 1.001).map(value => ({value})); };
  if (text) scale.ticks = {...scale.ticks, callback: value => text(value)};
  return scale;
}

const reportCharts = new Map();  // by the canvas's id: {config, finding, chart}

// Draws on the canvas what `config()` says, and again where the page's colours change. `finding(…)` is what a reader without eyes for it is told.
function drawChart(id, config, finding) {
  const known = reportCharts.get(id);
  if (known) known.chart.destroy();
  const canvas = byId(id);
  const chart = new Chart(canvas, config());
  canvas.setAttribute("role", "img");
  canvas.setAttribute("tabindex", "0");
  canvas.setAttribute("aria-label", finding + " Arrow keys go from point to point; the table below has the same figures.");
  if (!known) canvas.addEventListener("keydown", event => moveWithKeys(reportCharts.get(id), event));
  if (!known) canvas.addEventListener("blur", () => showPoint(reportCharts.get(id), null));
  reportCharts.set(id, {config, finding, chart, at: null});
  return chart;
}

function redrawCharts() {
  for (const [id, {config, finding}] of reportCharts) drawChart(id, config, finding);
}

// Shows the tooltip of a point {dataset, index} and says what it says.
function showPoint(entry, at) {
  const {chart} = entry;
  entry.at = at;
  const active = at ? [{datasetIndex: at.dataset, index: at.index}] : [];
  chart.setActiveElements(active);
  const point = at && chart.getDatasetMeta(at.dataset).data[at.index];
  chart.tooltip.setActiveElements(active, point ? {x: point.x, y: point.y} : {x: 0, y: 0});
  chart.update("none");
  if (at && chart.tooltip.title) byId("said").textContent = [...chart.tooltip.title, ...chart.tooltip.body.flatMap(item => item.lines)].join(", ");
}

// Left and right along a line, by tenths of it where it has hundreds of points; up and down from line to line; Escape ends.
function moveWithKeys(entry, event) {
  const moves = {ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowDown: [1, 0], ArrowUp: [-1, 0]};
  if (event.key === "Escape") return showPoint(entry, null);
  const move = moves[event.key];
  if (!move) return;
  event.preventDefault();
  const lines = entry.chart.data.datasets.map((dataset, index) => ({dataset, index})).filter(({dataset, index}) => !dataset.silent && dataset.data.length && entry.chart.isDatasetVisible(index));
  if (!lines.length) return;
  const now = entry.at || {dataset: lines[0].index, index: -1};
  const line = entry.at ? lines.findIndex(({index}) => index === now.dataset) : 0;
  const next = lines[(line + (entry.at ? move[0] : 0) + lines.length) % lines.length];
  const count = next.dataset.data.length, stride = count > 60 ? Math.round(count / 60) : 1;
  showPoint(entry, {dataset: next.index, index: Math.min(count - 1, Math.max(0, entry.at ? now.index + move[1] * stride : 0))});
}

window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redrawCharts);
window.addEventListener("beforeprint", redrawCharts);
window.addEventListener("afterprint", redrawCharts);
