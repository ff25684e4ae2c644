// Machine, commit, commands.
"use strict";

function madeOf() {
  const {curve, budget, table1, hard_cases: hard} = reportData;
  return [...curve.shapes.map(shape => ["Speed against error, " + shape.title, shape.made]), ["Budgets", budget.made], ["Table 1 and growth", table1.made], ["Hard cases", hard.made]];
}

function startMachine() {
  const machine = reportData.machine;
  const rows = [["this page was written", machine.date], ["by the program of commit", machine.commit], ["processor", machine.processor], ["cores", String(machine.cores)], ["system", machine.system], ["compiler", machine.compiler], ["ODE", machine.ode]];
  byId("machine_table").append(makeTable("This machine and this program, by which signatures and all that is marked as measured just now were made", ["what", "here"], rows.map(([name, value]) => ({cells: [name, value]})), 2));
  for (const [what, made] of madeOf())
    byId("machine_commands").append(make("h3", {}, what), make("p", {class: "note"}, made.fresh ? "Measured just now, on this machine." : "Measured on " + made.date + " at commit " + made.commit + ", on " + made.machine + "."),
      make("pre", {tabindex: "0"}, made.commands.join("\n")));
}
