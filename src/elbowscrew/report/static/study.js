"use strict";
// The table works without this: sorted by name, all trials shown.
(() => {
  const table = document.getElementById("trials");
  if (!table) return;
  const body = table.tBodies[0];
  const rows = [...body.rows];
  const tools = document.getElementById("tools");
  const filter = document.getElementById("filter");
  const count = document.getElementById("count");
  const onlyOutliers = document.getElementById("only-outliers");
  const onlyWarned = document.getElementById("only-warned");
  const factors = [...tools.querySelectorAll("select[data-factor]")];
  tools.hidden = false;
  tools.addEventListener("submit", (event) => event.preventDefault());

  // Words, not numbers: a 1 is in nearly every row.
  const words = (row) => [...row.querySelectorAll("th, td[data-factor], td[data-sort]")].map((cell) => cell.textContent);
  const texts = new Map(rows.map((row) => [row, words(row).join(" ").toLocaleLowerCase()]));
  const apply = () => {
    const wanted = filter.value.trim().toLocaleLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const row of rows) {
      const fits = wanted.every((word) => texts.get(row).includes(word))
        && (!onlyOutliers.checked || row.querySelector(".outlier"))
        && (!onlyWarned.checked || row.querySelector(".warned"))
        && factors.every((choice) => !choice.value
          || row.querySelector(`td[data-factor="${choice.dataset.factor}"]`).textContent === choice.value);
      row.hidden = !fits;
      shown += fits ? 1 : 0;
    }
    count.textContent = `${shown} of ${rows.length} trials`;
  };
  tools.addEventListener("input", apply);

  const names = new Intl.Collator(undefined, { numeric: true, sensitivity: "base" });
  const valueOf = (row, column, kind) => {
    const cell = row.cells[column];
    const text = cell.dataset.sort ?? cell.textContent;
    if (kind === "text") return text;
    const value = Number(text.replace("−", "-"));
    return text.trim() && Number.isFinite(value) ? value : null;
  };
  const sort = (header, column, kind) => {
    const downward = header.getAttribute("aria-sort") === "ascending";
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    header.setAttribute("aria-sort", downward ? "descending" : "ascending");
    const keyed = rows.map((row, place) => ({ row, place, value: valueOf(row, column, kind) }));
    keyed.sort((a, b) => {
      // What is not known stays at the end, whichever way round.
      if (a.value === null || b.value === null) return (a.value === null) - (b.value === null) || a.place - b.place;
      const order = kind === "text" ? names.compare(a.value, b.value) : a.value - b.value;
      return (downward ? -order : order) || a.place - b.place;
    });
    body.append(...keyed.map((one) => one.row));
  };
  [...table.tHead.rows[0].cells].forEach((header, column) => {
    if (!header.dataset.kind) return;
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = header.textContent;
    header.replaceChildren(button);
    button.addEventListener("click", () => sort(header, column, header.dataset.kind));
  });
})();
