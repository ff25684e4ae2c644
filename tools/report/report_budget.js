// What a budget does: of each run the bodies on each rung, and below them the milliseconds of its steps.
"use strict";

const rungNames = ["full", "support", "tables"];
const kNoBodies = 0.3;  // where 0 stands on an axis of logarithms

const budgetRuns = [...reportData.budget.runs].sort((a, b) => (a.budget_ms === null) - (b.budget_ms === null));  // those under a budget first

function runTitle(run) { return run.scene.replace(".yaml", "") + (run.budget_ms === null ? ", no budget of time" : ", " + run.budget_ms + " ms a step"); }
const timeOf = (run, index) => Math.round(1000 * (index + 1) * run.dt_s) / 1000;

function rungConfig(run) {
  const most = [...rungNames, "asleep"].flatMap(name => run[name]).reduce((a, b) => Math.max(a, b), 0);  // too many for arguments
  const line = (name, values, more) => ({label: name, data: values.map((value, i) => ({x: timeOf(run, i), y: Math.max(value, kNoBodies), bodies: value})), borderWidth: 1.8, pointRadius: 0, pointHitRadius: 4, direct: true, showLine: true, ...more});
  const datasets = rungNames.map(rung => line(rung, run[rung], {borderColor: colour(rung), backgroundColor: colour(rung), emphasised: true, priority: rung === "full" ? 3 : 2}));
  datasets.push(line("asleep", run.asleep, {borderColor: colour("asleep"), backgroundColor: colour("asleep"), borderDash: [4, 3], borderWidth: 1.2, priority: 1}));
  return {
    type: "scatter", data: {datasets},
    options: {
      layout: {padding: {right: 78}},
      interaction: {mode: "nearest", axis: "x", intersect: false},
      scales: {
        x: axis("", {type: "linear", min: 0, max: timeOf(run, run.full.length - 1), ticks: {display: false}}),
        y: axis("bodies", {type: "logarithmic", min: kNoBodies, max: most * 1.5, afterFit: scale => { scale.width = 64; }}, [kNoBodies, 1, 10, 100, 1000, 10000], value => value < 1 ? "0" : value.toLocaleString("en-US"))
      },
      plugins: {
        lineLabels: {show: true, beside: true},
        tooltip: {callbacks: {title: items => items.length ? items[0].raw.x.toFixed(2) + " s" : "", label: item => item.dataset.label + ": " + item.raw.bodies.toLocaleString("en-US") + " bodies"}}
      }
    }
  };
}

function stepConfig(run) {
  const budget = run.budget_ms, sorted = [...run.processor_ms.slice(Math.min(9, run.processor_ms.length - 1))].sort((a, b) => a - b);
  const high = Math.max(budget ? budget * 1.35 : 0, 1.1 * sorted[Math.floor(0.995 * sorted.length)]);
  const datasets = [{
    label: "step", data: run.processor_ms.map((ms, i) => ({x: timeOf(run, i), y: Math.min(ms, high), ms})), borderColor: colour("ink"), backgroundColor: colour("ink"), borderWidth: 1, showLine: true, clip: 8,
    pointRadius: run.processor_ms.map(ms => ms > high ? 5 : 0), pointStyle: "triangle", pointBackgroundColor: colour("bad"), pointBorderColor: colour("bad"), pointHitRadius: 4
  }];
  if (budget) datasets.push({label: "budget", silent: true, direct: true, emphasised: true, data: [{x: 0, y: budget}, {x: timeOf(run, run.full.length - 1), y: budget}], borderColor: colour("bad"), borderDash: [6, 4], borderWidth: 2, pointRadius: 0, showLine: true});
  return {
    type: "scatter", data: {datasets},
    options: {
      layout: {padding: {right: 78}},
      interaction: {mode: "nearest", axis: "x", intersect: false},
      scales: {x: axis("seconds", {type: "linear", min: 0, max: timeOf(run, run.full.length - 1)}), y: axis("ms a step", {type: "linear", min: 0, max: high, afterFit: scale => { scale.width = 64; }})},
      plugins: {
        lineLabels: {show: true, beside: true},
        tooltip: {displayColors: false, filter: item => item.dataset.label === "step", callbacks: {title: items => items.length ? items[0].raw.x.toFixed(2) + " s" : "", label: item => msText(item.raw.ms) + " of processor time"}}
      }
    }
  };
}

// From the tenth step on, as the program counts; null where there is none.
function meanOf(values) {
  const counted = values.slice(9);
  return counted.length ? counted.reduce((sum, value) => sum + value, 0) / counted.length : null;
}

function budgetSummary(run) {
  if (run.counted_steps === 0) return "Over before its tenth step, from which on steps are counted.";
  const bodies = rungNames.map(rung => shortNumber(meanOf(run[rung])) + " " + rung).join(", ");
  const kept = run.budget_ms === null ? "No budget of time: the scene's policy alone decides. " : run.over + " of " + run.counted_steps + " steps took longer than " + run.budget_ms + " ms, from the tenth on" + (run.over ? " (longest " + msText(run.max_ms) + ")" : "") + ". ";
  return kept + "Median step " + msText(run.p50_ms) + ", 99 % below " + msText(run.p99_ms) + "; on average " + bodies + ".";
}

function startBudget() {
  const {levels} = reportData.budget, runs = budgetRuns;
  byId("budget_heap").hidden = !runs.some(run => run.scene === "heap.yaml");
  runs.forEach((run, index) => {
    const [rungs, steps] = ["rungs_chart_" + index, "steps_chart_" + index];
    byId("budget_runs").append(make("div", {}, make("h3", {}, runTitle(run)), make("p", {class: "note"}, budgetSummary(run)),
      make("div", {class: "chart low"}, make("canvas", {id: rungs})), make("div", {class: "chart low"}, make("canvas", {id: steps}))));
    drawChart(rungs, () => rungConfig(run), "Bodies on each rung over time, " + runTitle(run) + ": " + budgetSummary(run));
    drawChart(steps, () => stepConfig(run), "Time of each step, " + runTitle(run) + ": " + budgetSummary(run));
  });
  byId("budget_table").append(makeTable("Each run; processor time and means from the tenth step on", ["run", "median", "99 %", "longest", "steps over", "mean full", "mean support", "mean tables"],
    runs.map(run => ({cells: [runTitle(run), msText(run.p50_ms), msText(run.p99_ms), msText(run.max_ms), run.over === null ? "–" : run.over + " of " + run.counted_steps, ...rungNames.map(rung => shortNumber(meanOf(run[rung])))]}))));
  for (const run of runs) {
    const every = Math.round(0.5 / run.dt_s), indices = run.full.map((_, i) => i).filter(i => (i + 1) % every === 0);
    byId("budget_table").append(makeTable(runTitle(run) + ": every half second", ["s", ...rungNames, "asleep", "ms"],
      indices.map(i => ({cells: [timeOf(run, i).toFixed(1), ...rungNames.map(rung => run[rung][i].toLocaleString("en-US")), run.asleep[i].toLocaleString("en-US"), shortNumber(run.processor_ms[i])]}))));
  }
  if (levels) byId("budget_runs").after(make("div", {class: "scroll"}, makeTable(reportData.budget.runs[0].scene.replace(".yaml", "") + " at one level throughout, measured just now; full over its busiest steps only", ["level", "median step", "99 %", "median of the busiest steps", "most full at once"],
    levels.map(row => ({cells: [row.level, msText(row.p50_ms), msText(row.p99_ms), msText(row.busy_p50_ms), String(row.most_full)]})))));
}
