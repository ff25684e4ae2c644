// Elements, numbers as text, tables and switches: what all sections of the report share.
"use strict";

const reportData = JSON.parse(document.getElementById("data").textContent);
const byId = id => document.getElementById(id);
const colour = name => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
const isNarrow = () => window.innerWidth < 600;

// An element with its attributes and children.
function make(tag, attributes, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) if (value !== undefined && value !== null) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

// Three digits of a number; thousands with commas.
function shortNumber(value) {
  if (value === null || value === undefined) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-4) {
    const [digits, power] = value.toExponential(1).split("e");
    return digits.replace(/\.0$/, "") + " · 10" + (power < 0 ? "⁻" : "") + [...String(Math.abs(power))].map(digit => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]).join("");
  }
  if (size >= 100) return Math.round(value).toLocaleString("en-US");
  return value.toFixed(Math.max(0, 2 - Math.floor(Math.log10(size))));
}
// Scores to thousandths below 1.
const scoreText = score => score === null ? "–" : score < 1 ? score.toFixed(3) : score.toFixed(2);
// Nanoseconds in the unit that suits them.
function timeText(ns) {
  if (ns === null || ns === undefined) return "–";
  if (ns < 1e3) return shortNumber(ns) + " ns";
  return ns < 1e6 ? shortNumber(ns / 1e3) + " µs" : shortNumber(ns / 1e6) + " ms";
}
const msText = ms => ms === null ? "–" : shortNumber(ms) + " ms";
function stepText(dt) {
  const rate = 1 / dt;
  return "1/" + Math.round(rate) + " s";
}

// A table with headings; a cell is text or an element, numbers in `numeric` columns stand on the right. `rows`: {cells, ours}.
function makeTable(caption, headings, rows, leftColumns = 1) {
  const side = index => index < leftColumns ? "left" : undefined;
  const head = make("tr", {}, ...headings.map((heading, i) => make("th", {scope: "col", class: side(i)}, heading)));
  const body = rows.map(row => make("tr", {class: row.ours ? "ours" : undefined},
    ...row.cells.map((cell, i) => i === 0 ? make("th", {scope: "row"}, cell) : make("td", {class: side(i)}, cell))));
  return make("table", {}, make("caption", {}, caption), make("thead", {}, head), make("tbody", {}, ...body));
}

// Buttons of which one is pressed.
function makeSwitch(element, names, choose) {
  const buttons = names.map((name, index) => {
    const button = make("button", {type: "button", "aria-pressed": String(index === 0)}, name);
    button.addEventListener("click", () => {
      buttons.forEach(other => other.setAttribute("aria-pressed", String(other === button)));
      choose(index);
    });
    return button;
  });
  element.replaceChildren(...buttons);
}
