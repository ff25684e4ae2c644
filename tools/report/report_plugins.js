// What Chart.js does not draw by itself: a band for the noise floor, whiskers, names beside lines.
"use strict";

// A horizontal band and its middle, behind the data: options {from, to, at, label}.
const bandPlugin = {
  id: "band",
  beforeDatasetsDraw(chart, _, options) {
    if (options.from === undefined) return;
    const {ctx, chartArea, scales} = chart, y = value => Math.min(chartArea.bottom, scales.y.getPixelForValue(Math.max(value, scales.y.min)));
    ctx.save();
    ctx.fillStyle = colour("band");
    ctx.fillRect(chartArea.left, y(options.to), chartArea.width, y(options.from) - y(options.to));
    ctx.strokeStyle = colour("good");
    ctx.setLineDash([5, 4]);
    ctx.beginPath();
    ctx.moveTo(chartArea.left, y(options.at));
    ctx.lineTo(chartArea.right, y(options.at));
    ctx.stroke();
    ctx.restore();
  },
  afterDatasetsDraw(chart, _, options) {
    if (options.from === undefined) return;
    const {ctx, chartArea, scales} = chart;
    ctx.save();
    ctx.fillStyle = colour("good");
    ctx.font = "italic 12px " + Chart.defaults.font.family;
    ctx.textBaseline = "bottom";
    ctx.fillText(options.label, chartArea.left + 6, Math.min(chartArea.bottom, scales.y.getPixelForValue(options.from)) - 4);
    ctx.restore();
  }
};

// 95 % intervals of points that have `from` and `to`.
const whiskerPlugin = {
  id: "whiskers",
  beforeDatasetsDraw(chart) {
    const {ctx, scales} = chart;
    ctx.save();
    chart.data.datasets.forEach((dataset, index) => {
      if (!chart.isDatasetVisible(index)) return;
      ctx.strokeStyle = dataset.borderColor;
      ctx.globalAlpha = dataset.emphasised ? 0.9 : 0.45;
      ctx.lineWidth = dataset.emphasised ? 1.6 : 1;
      chart.getDatasetMeta(index).data.forEach((point, i) => {
        const raw = dataset.data[i];
        if (raw.from === undefined) return;
        const top = scales.y.getPixelForValue(raw.to), bottom = scales.y.getPixelForValue(Math.max(raw.from, scales.y.min));
        ctx.beginPath();
        ctx.moveTo(point.x, top);
        ctx.lineTo(point.x, bottom);
        for (const end of raw.from < scales.y.min ? [top] : [top, bottom]) {  // no end where it goes on below the axis
          ctx.moveTo(point.x - 3, end);
          ctx.lineTo(point.x + 3, end);
        }
        ctx.stroke();
      });
    });
    ctx.restore();
  }
};

const overlap = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
const kHalfName = 8;  // of the height of a name, px

const isInside = (point, area) => point.x >= area.left - 1 && point.x <= area.right + 1 && Number.isFinite(point.y);

// Boxes about the points of lines, and about the lines themselves where `alongLines`, which names keep off.
function boxesOfLines(lines, area, alongLines) {
  const boxes = [], keepOff = (x, y) => boxes.push({left: x - 4, right: x + 4, top: y - 4, bottom: y + 4});
  for (const {dataset, points} of lines) {
    points.filter(point => isInside(point, area)).forEach(point => keepOff(point.x, point.y));
    if (!alongLines || !dataset.showLine) continue;
    points.slice(1).forEach((point, i) => {
      const before = points[i], pieces = Math.ceil(Math.hypot(point.x - before.x, point.y - before.y) / 8);
      for (let piece = 1; piece < pieces; ++piece) keepOff(before.x + (point.x - before.x) * piece / pieces, before.y + (point.y - before.y) * piece / pieces);
    });
  }
  return boxes;
}

// Places {left, middle, away} of a name to the right of the end of its line: beside it, else a little up or down; where another's name lies, first to the side on which its own line is.
function placesBeside(point, width, taken) {
  const box = {left: point.x + 5, right: point.x + 9 + width, top: point.y - kHalfName, bottom: point.y + kHalfName};
  const other = taken.find(one => overlap(box, one)), side = other && other.pointY > point.y ? -1 : 1;
  return [0, 14, -14, 28, -28, 42, -42, 56, -56].map(shift => ({left: point.x + 7, middle: point.y + side * shift, away: 0}));
}

// Places of a name about its point, the nearest first.
function placesAbout(point, width) {
  return [0, 12, 24, 38, 54].flatMap(away => [[10 + away, 0], [-10 - away - width, 0], [-width / 2, 17 + away], [-width / 2, -17 - away], [8 + away, -13 - away], [8 + away, 13 + away],
    [-8 - away - width, -13 - away], [-8 - away - width, 13 + away]].map(([right, down]) => ({left: point.x + right, middle: point.y + down, away})));
}

// The first of these that lies on the chart and on nothing else, with its box.
function findPlace(places, width, taken, limits) {
  for (const place of places) {
    const box = {left: place.left - 2, right: place.left + width + 2, top: place.middle - kHalfName, bottom: place.middle + kHalfName};
    const within = box.left >= limits.left && box.right <= limits.right && box.top >= limits.top && box.bottom <= limits.bottom;
    if (within && !taken.some(other => overlap(box, other))) return {...place, box};
  }
  return null;
}

function drawName(ctx, dataset, point, place) {
  if (place.away > 0) {
    ctx.strokeStyle = dataset.borderColor;
    ctx.globalAlpha = 0.5;
    ctx.lineWidth = 1;
    ctx.beginPath();
    ctx.moveTo(point.x, point.y);
    ctx.lineTo(Math.min(Math.max(point.x, place.box.left), place.box.right), Math.min(Math.max(point.y, place.box.top), place.box.bottom));
    ctx.stroke();
    ctx.globalAlpha = 1;
  }
  ctx.lineWidth = 4;
  ctx.lineJoin = "round";
  ctx.strokeStyle = colour("paper");
  ctx.strokeText(dataset.label, place.left, place.middle);
  ctx.fillStyle = dataset.borderColor;
  ctx.fillText(dataset.label, place.left, place.middle);
}

// The names of lines with `direct`, beside the point `labelAt` (else the last), where they cover neither another name nor a point: those with a higher `priority` first; a name that finds no room
// is left to the table and the tooltip. Options: `beside`: to the right of the lines' ends; `avoidPoints`, `avoidLines`. `chart.placedLabels` are those that found room.
const labelPlugin = {
  id: "lineLabels",
  afterDatasetsDraw(chart, _, options) {
    if (!options.show) return;
    const {ctx, chartArea: area} = chart, limits = options.beside ? {left: area.left, right: chart.width - 2, top: area.top - 12, bottom: area.bottom + 4} : {...area, top: area.top - 4, bottom: area.bottom + 4};
    const lines = chart.data.datasets.map((dataset, index) => ({dataset, points: chart.getDatasetMeta(index).data})).filter(({dataset, points}) => dataset.direct && points.length);
    const taken = options.avoidPoints || options.avoidLines ? boxesOfLines(lines, area, options.avoidLines) : [];
    chart.placedLabels = [];
    ctx.save();
    ctx.textBaseline = "middle";
    for (const {dataset, points} of lines.sort((a, b) => (b.dataset.priority || 0) - (a.dataset.priority || 0))) {
      const point = points[dataset.labelAt] || points.filter(one => isInside(one, area)).pop();
      if (!point) continue;
      ctx.font = (dataset.emphasised ? "bold 13px " : "12px ") + Chart.defaults.font.family;
      const width = ctx.measureText(dataset.label).width;
      const place = findPlace(options.beside ? placesBeside(point, width, taken) : placesAbout(point, width), width, taken, limits);
      if (!place) continue;
      taken.push({...place.box, pointY: point.y});
      chart.placedLabels.push(dataset.label);
      drawName(ctx, dataset, point, place);
    }
    ctx.restore();
  }
};

Chart.register(bandPlugin, whiskerPlugin, labelPlugin);
