"use strict";
// Sort a table by a column: numbers by value, text by the alphabet, what was not measured last.
for (const table of document.querySelectorAll("table.runs")) {
  const headings = [...table.tHead.rows[0].cells];
  headings.forEach((heading, column) => {
    heading.querySelector("button").addEventListener("click", () => {
      const down = heading.getAttribute("aria-sort") === "ascending";
      headings.forEach((h) => h.setAttribute("aria-sort", "none"));
      heading.setAttribute("aria-sort", down ? "descending" : "ascending");
      const key = (row) => row.cells[column]?.dataset.v;
      const rows = [...table.tBodies[0].rows].sort((a, b) => {
        const [x, y] = [key(a), key(b)];
        if (x === undefined || y === undefined) return (x === undefined) - (y === undefined);
        const order = isNaN(x) || isNaN(y) ? x.localeCompare(y) : x - y;
        return down ? -order : order;
      });
      table.tBodies[0].append(...rows);
    });
  });
}
// The slider, the choice of run, and the error.
for (const viewer of document.querySelectorAll(".viewer")) {
  const split = viewer.querySelector(".split");
  const choices = [...viewer.querySelectorAll(".choices button")];
  const views = [...viewer.querySelectorAll(".views button")];
  const pressed = (buttons) => buttons.find((b) => b.getAttribute("aria-pressed") === "true").dataset;
  const show = () => {
    const run = pressed(choices).run;
    const view = pressed(views).view;
    for (const part of viewer.querySelectorAll(".under, .shot, .crops, .films, .scale")) {
      const otherRun = part.dataset.run !== undefined && part.dataset.run !== run;
      const otherView = part.dataset.view !== undefined && !part.dataset.view.split(" ").includes(view);
      part.hidden = otherRun || otherView;
    }
  };
  for (const buttons of [choices, views])
    buttons.forEach((button) =>
      button.addEventListener("click", () => {
        buttons.forEach((b) => b.setAttribute("aria-pressed", String(b === button)));
        show();
      }),
    );
  split.querySelector("input").addEventListener("input", (e) => split.style.setProperty("--at", e.target.value + "%"));
}
// Copy the command; without permission, select it.
document.getElementById("copy").addEventListener("click", async (e) => {
  const command = document.getElementById("command");
  try {
    await navigator.clipboard.writeText(command.textContent);
    e.target.textContent = "Copied";
  } catch {
    getSelection().selectAllChildren(command);
    e.target.textContent = "Selected";
  }
});
