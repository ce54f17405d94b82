"use strict";
// The table's rows are drawn from the page's data, some at a time, as they come into view.
// Without this its first rows stand there as text, sorted by name.
(() => {
  const table = document.getElementById("trials");
  if (!table) return;
  const data = JSON.parse(document.getElementById("data").textContent);
  const count = data.folders.length;
  const tools = document.getElementById("tools");
  const filter = document.getElementById("filter");
  const told = document.getElementById("count");
  const onlyOutliers = document.getElementById("only-outliers");
  const onlyWarned = document.getElementById("only-warned");
  const choices = [...tools.querySelectorAll("select[data-factor]")];
  const area = table.parentNode;
  const headers = [...table.tHead.rows[0].cells];
  const AT_ONCE = 50; // rows
  const AHEAD = "600px"; // drawn before they come into view
  tools.hidden = false;
  tools.addEventListener("submit", (event) => event.preventDefault());

  const withoutPage = new Set(data.without_page);
  const wordOf = (factor, k) => factor.words[factor.of[k]];
  const markOf = (k) => data.marks[data.mark[k]];
  const shown = (value, decimals) => (value === null ? "–" : value.toFixed(decimals).replace("-", "−"));

  const make = (name, attributes, ...inside) => {
    const made = document.createElement(name);
    Object.entries(attributes).forEach(([key, value]) => made.setAttribute(key, value));
    made.append(...inside);
    return made;
  };
  const LENGTH = data.thumbs.length / (count || 1);
  const GAP = ".";
  const [WIDE, TALL] = [100, 34];
  const thumbnail = (k) => {
    const code = data.thumbs.slice(k * LENGTH, (k + 1) * LENGTH);
    const shape = [...code].map((letter, j) => {
      if (letter === GAP) return "";
      const up = TALL - 2 - ((TALL - 4) * data.levels.indexOf(letter)) / (data.levels.length - 1);
      return `${j > 0 && code[j - 1] !== GAP ? "L" : "M"}${1 + 1.5 * j} ${up.toFixed(1)}`;
    });
    const svg = page.element("svg", { class: "thumb", width: WIDE, height: TALL, "aria-hidden": "true", focusable: "false" });
    svg.append(page.element("path", { d: shape.join("") }));
    return svg;
  };
  const quoted = (name) => encodeURIComponent(name).replace(/[!'()*]/g, (sign) => `%${sign.charCodeAt(0).toString(16).toUpperCase()}`);
  const nameOf = (k) => {
    const folder = data.folders[k];
    return withoutPage.has(k) ? folder : make("a", { href: `${folder.split("/").map(quoted).join("/")}/report.html` }, folder);
  };
  const row = (k, place) => {
    const [outliers, warnings] = markOf(k);
    const marks = [
      ...outliers.map((text) => make("span", { class: "badge outlier" }, text)),
      ...warnings.map((code) => make("code", { class: "warned" }, code)),
    ];
    return make("tr", { "aria-rowindex": place + 2 },
      make("th", { scope: "row" }, nameOf(k)),
      make("td", {}, thumbnail(k)),
      ...data.factors.map((factor, j) => make("td", { "data-factor": j }, wordOf(factor, k))),
      make("td", { class: "look" }, ...marks.flatMap((mark) => [mark, " "])),
      ...data.values.map((values, j) => make("td", { class: "n" }, shown(values[k], data.decimals[j]))));
  };

  // The table in parts, each as high as its rows will be until these are drawn.
  let order = data.folders.map((_, k) => k);
  let fits = order;
  let rowHeight = 40;
  const firstOf = new Map();
  const draw = (part) => {
    const first = firstOf.get(part);
    if (first === undefined) return;
    firstOf.delete(part);
    coming.unobserve(part);
    part.replaceChildren(...fits.slice(first, first + AT_ONCE).map((k, j) => row(k, first + j)));
  };
  const coming = new IntersectionObserver((seen) => {
    seen.filter((one) => one.isIntersecting).forEach((one) => draw(one.target));
  }, { root: area, rootMargin: AHEAD });
  const lay = () => {
    coming.disconnect();
    firstOf.clear();
    const parts = [];
    for (let first = 0; first < fits.length; first += AT_ONCE) {
      const part = make("tbody", {});
      firstOf.set(part, first);
      parts.push(part);
    }
    [...table.tBodies].forEach((part) => part.remove());
    if (parts.length) draw(parts[0]);
    table.append(...parts);
    table.setAttribute("aria-rowcount", fits.length + 1);
    told.textContent = `${fits.length} of ${count} trials`;
    area.scrollTop = 0;
    if (parts.length > 1) rowHeight = parts[0].offsetHeight / AT_ONCE;
    parts.slice(1).forEach((part) => {
      const ahead = make("tr", { "aria-hidden": "true" }, make("td", { colspan: headers.length }));
      ahead.style.height = `${rowHeight * Math.min(AT_ONCE, fits.length - firstOf.get(part))}px`;
      part.append(ahead);
      coming.observe(part);
    });
  };
  window.addEventListener("beforeprint", () => [...firstOf.keys()].forEach(draw));

  // Words, not numbers: a 1 is in nearly every row.
  const words = (k) => [data.folders[k], ...data.factors.map((factor) => wordOf(factor, k)), ...markOf(k).flat()];
  const texts = data.folders.map((_, k) => words(k).join(" ").toLocaleLowerCase());
  const apply = () => {
    const wanted = filter.value.trim().toLocaleLowerCase().split(/\s+/).filter(Boolean);
    fits = order.filter((k) => wanted.every((word) => texts[k].includes(word))
      && (!onlyOutliers.checked || markOf(k)[0].length)
      && (!onlyWarned.checked || markOf(k)[1].length)
      && choices.every((choice) => !choice.value || wordOf(data.factors[choice.dataset.factor], k) === choice.value));
    lay();
  };
  tools.addEventListener("input", apply);

  // What each column is sorted by, in their order; of the second, nothing.
  const names = new Intl.Collator(undefined, { numeric: true, sensitivity: "base" });
  const keys = [
    (k) => data.folders[k],
    null,
    ...data.factors.map((factor) => (k) => wordOf(factor, k)),
    (k) => markOf(k)[0].length + markOf(k)[1].length,
    ...data.values.map((values) => (k) => values[k]),
  ];
  const sort = (header, key) => {
    const downward = header.getAttribute("aria-sort") === "ascending";
    headers.forEach((other) => other.removeAttribute("aria-sort"));
    header.setAttribute("aria-sort", downward ? "descending" : "ascending");
    order = data.folders.map((_, k) => k).sort((one, other) => {
      const [a, b] = [key(one), key(other)];
      // What is not known stays at the end, whichever way round.
      if (a === null || b === null) return (a === null) - (b === null) || one - other;
      const between = typeof a === "string" ? names.compare(a, b) : a - b;
      return (downward ? -between : between) || one - other;
    });
    apply();
  };
  headers.forEach((header, column) => {
    if (!keys[column]) return;
    const button = make("button", { type: "button" }, header.textContent);
    header.replaceChildren(button);
    button.addEventListener("click", () => sort(header, keys[column]));
  });
  lay();
})();
