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
  const toggle = viewer.querySelector(".toggle");
  const show = () => {
    const run = choices.find((c) => c.getAttribute("aria-pressed") === "true").dataset.run;
    const error = toggle.getAttribute("aria-pressed") === "true";
    for (const part of viewer.querySelectorAll(".shot, .heat, .crops, .scale")) {
      const kind = part.matches(".heat") ? error : part.matches(".shot") ? !error : true;
      part.hidden = part.dataset.run !== run || !kind;
    }
    split.classList.toggle("error", error);
    toggle.textContent = error ? "Show the image" : "Show the error";
  };
  choices.forEach((choice) =>
    choice.addEventListener("click", () => {
      choices.forEach((c) => c.setAttribute("aria-pressed", String(c === choice)));
      show();
    }),
  );
  toggle.addEventListener("click", () => {
    toggle.setAttribute("aria-pressed", String(toggle.getAttribute("aria-pressed") !== "true"));
    show();
  });
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
