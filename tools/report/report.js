// The page from its data, section by section.
"use strict";

for (const {figure, text} of reportData.headline) byId("headline").append(make("p", {}, make("strong", {}, figure), text));

// report.html#only=curve shows one section's chart alone, for pictures; with &shape=bunny the curve of that shape.
function followHash() {
  const hash = new URLSearchParams(location.hash.slice(1)), chosen = hash.get("only") && byId(hash.get("only"));
  document.body.classList.toggle("only", Boolean(chosen));
  for (const section of document.querySelectorAll("section")) section.classList.toggle("chosen", section === chosen);
  const shape = curveShapes.findIndex(shape => shape.name === hash.get("shape"));
  if (shape >= 0) byId("curve_switch").children[shape].click();
}

startCurve();
startBudget();
startTable1();
startHardCases();
startSignature();
startMachine();
followHash();
window.addEventListener("hashchange", followHash);
document.body.dataset.ready = "yes";
