// Hard cases: those that fail first, then all, case by case.
"use strict";

const verdictOf = row => row.pass ? ["pass", "✓ pass"] : row.reason ? ["own", "≈ ODE's own"] : ["fail", "✗ FAIL"];
function verdictCell(row) {
  const [kind, text] = verdictOf(row);
  return make("span", {class: "verdict " + kind}, text);
}
const unitText = row => row.unit ? " " + row.unit.replace(/2/g, "²") : "";
const boundText = row => (row.op === "<=" ? "at most " : "at least ") + shortNumber(row.bound).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "") + unitText(row);

function casesTable(caption, rows) {
  const table = makeTable(caption, ["case", "what", "figure", "bound", "result"],
    rows.map(row => ({cells: [row.id, make("span", {}, row.what, ...(row.reason ? [make("small", {}, row.reason)] : [])), shortNumber(row.value) + unitText(row), boundText(row), verdictCell(row)]})), 2);
  for (const line of table.tBodies[0].rows) line.cells[1].className = "wrap";
  return make("div", {class: "scroll"}, table);
}

function startHardCases() {
  const {rows, figures, kept, odes_own: own, failed} = reportData.hard_cases;
  byId("hard_cases_summary").textContent = "Set-ups on which physics engines are known to fail, from stacks and slender bodies to speeds that tunnel. Each figure stands beside the bound that it must keep: " + kept + " of " + figures + " do, " + own +
    " fail because ODE itself does (≈), " + failed + " fail for a reason of ours (✗).";
  const failing = rows.filter(row => !row.pass);
  if (failing.length) byId("hard_cases_failing").append(casesTable("What does not keep its bound", failing));
  const ids = [...new Set(rows.map(row => row.id))];
  const list = make("div", {class: "cases"});
  for (const id of ids) {
    const ofCase = rows.filter(row => row.id === id), good = ofCase.filter(row => row.pass).length;
    const worst = ofCase.find(row => !row.pass && !row.reason) || ofCase.find(row => !row.pass) || ofCase[0], [kind, text] = verdictOf(worst);
    const about = ofCase[0].what.split(/[:,(]/)[0];
    list.append(make("details", {}, make("summary", {}, id + ", " + about + ": ", make("span", {class: "verdict " + kind}, text[0] + " " + good + " of " + ofCase.length + " kept")), casesTable(id, ofCase)));
  }
  byId("hard_cases_all").append(make("h3", {}, "All cases"), list);
}
