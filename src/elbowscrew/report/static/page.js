"use strict";
// What charts and folded parts of a page do where there is JavaScript; all is readable without.
const page = (() => {
  const root = document.documentElement;
  const dark = window.matchMedia("screen and (prefers-color-scheme: dark)");
  const rules = [...document.styleSheets].flatMap((sheet) => [...sheet.cssRules]).filter((rule) => rule instanceof CSSStyleRule);
  const light = rules.find((rule) => rule.selectorText === ":root").style;
  const state = { printing: false };
  // A color by its name, that of paper while it is printed.
  const color = (name) => (state.printing ? light : getComputedStyle(root)).getPropertyValue(name).trim();
  const isDark = () => dark.matches && !state.printing;

  let folded = [];
  window.addEventListener("beforeprint", () => {
    state.printing = true;
    folded = [...document.querySelectorAll("details:not([open])")];
    folded.forEach((part) => { part.open = true; });
  });
  window.addEventListener("afterprint", () => {
    state.printing = false;
    folded.forEach((part) => { part.open = false; });
  });

  const onPaper = (draw) => {
    state.printing = true;
    draw();
    state.printing = false;
  };

  const save = (name, blob) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    window.setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const SVG = document.querySelector("svg").namespaceURI;
  const element = (name, attributes, text) => {
    const made = document.createElementNS(SVG, name);
    Object.entries(attributes).forEach(([key, value]) => made.setAttribute(key, value));
    if (text !== undefined) made.textContent = text;
    return made;
  };

  // The picture alone, in the colors of paper and with its keys below: no variable of this page is left in it.
  const standalone = (svg) => {
    const css = rules
      .filter((rule) => svg.matches(rule.selectorText) || svg.querySelector(rule.selectorText))
      .map((rule) => rule.cssText.replace(/var\((--[\w-]+)\)/g, (_, name) => light.getPropertyValue(name).trim()))
      .join("\n");
    const { width, height } = svg.viewBox.baseVal;
    const copy = svg.cloneNode(true);
    copy.querySelectorAll("metadata, .cursor").forEach((part) => part.remove());
    const keys = element("g", {});
    let [x, y] = [16, height + 18];
    svg.parentNode.querySelectorAll(".keys span").forEach((key) => {
      const words = key.textContent.trim();
      const wide = 52 + 8 * words.length;
      if (x > 16 && x + wide > width) [x, y] = [16, y + 22];
      const place = element("g", { transform: `translate(${x} ${y})` });
      const swatch = key.querySelector("svg"); // none beside what is said of something not drawn
      place.append(...(swatch ? swatch.cloneNode(true).childNodes : []), element("text", { x: swatch ? 36 : 0, y: 12 }, words));
      keys.append(place);
      x += wide;
    });
    const bottom = y + 24;
    Object.entries({ width, height: bottom, viewBox: `0 0 ${width} ${bottom}` }).forEach(([key, value]) => copy.setAttribute(key, value));
    copy.prepend(
      element("style", {}, css),
      document.querySelector(".defs defs").cloneNode(true),
      element("rect", { width, height: bottom, fill: light.getPropertyValue("--paper").trim() }),
    );
    copy.append(keys);
    return new XMLSerializer().serializeToString(copy);
  };

  const cell = (value) => (typeof value === "string" ? `"${value.replaceAll('"', '""')}"` : String(value ?? ""));
  const table = (panels) => [
    [panels[0].told.along[0], "quantity", "series", "value"],
    ...panels.flatMap(({ told }) => told.series.flatMap(([name, x, y]) => x.map((at, k) => [at, told.up[0], name, y[k]]))),
  ].map((row) => row.map(cell).join(",")).join("\n");

  const nearest = (values, wanted) => {
    let [low, high] = [0, values.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (values[middle] < wanted) low = middle; else high = middle;
    }
    return wanted - values[low] < values[high] - wanted ? low : high;
  };
  const brief = (value) => String(Number(value.toPrecision(5))).replace("-", "−");
  const NEAR = 4; // pixels of the chart
  const MOST_VALUES = 10;
  const valuesAt = (told, wanted) => {
    const [, low, high] = told.along;
    const near = (NEAR * (high - low)) / (told.box[2] - told.box[0]);
    const found = told.series.flatMap(([name, x, y]) => {
      const k = x.length ? nearest(x, wanted) : -1;
      const known = k >= 0 && y[k] !== null && Math.abs(x[k] - wanted) <= near;
      return known ? [`${name} ${brief(y[k])}`] : [];
    });
    // Of many the one that lies on top, a mean, comes first.
    return found.length > MOST_VALUES ? [found.at(-1), ...found.slice(0, MOST_VALUES - 1), "…"] : found;
  };

  document.querySelectorAll("figure").forEach((figure) => {
    const svg = figure.querySelector("svg.chart");
    if (!svg) return;
    const title = svg.querySelector("title").textContent;
    const panels = [...svg.querySelectorAll("metadata")].map((note) => ({ group: note.parentNode, told: JSON.parse(note.textContent) }));
    const tools = document.createElement("div");
    tools.className = "tools";
    const offer = (kind, type, text) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = kind;
      button.setAttribute("aria-label", `Download the chart ${title} as ${kind}`);
      const name = `${title.toLowerCase().replace(/[^a-z0-9]+/g, "-")}.${kind.toLowerCase()}`;
      button.addEventListener("click", () => save(name, new Blob([text()], { type })));
      tools.append(button);
    };
    offer("SVG", "image/svg+xml", () => standalone(svg));
    svg.parentNode.after(tools);
    if (!panels.length) return;
    offer("CSV", "text/csv;charset=utf-8", () => `\ufeff${table(panels)}\n`);
    const values = document.createElement("p");
    values.className = "values";
    tools.prepend(values);
    const cursor = element("path", { class: "cursor" });
    const forget = () => { cursor.remove(); values.textContent = ""; };
    svg.addEventListener("pointerleave", forget);
    svg.addEventListener("pointermove", (event) => {
      for (const { group, told } of panels) {
        const [left, top, right, bottom] = told.box;
        const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(group.getScreenCTM().inverse());
        if (at.x < left || at.x > right || at.y < top || at.y > bottom) continue;
        const [name, low, high] = told.along;
        const wanted = low + ((at.x - left) * (high - low)) / (right - left);
        cursor.setAttribute("d", `M${at.x} ${top}V${bottom}`);
        group.append(cursor);
        values.textContent = [`${name} ${brief(wanted)}`, `${told.up[0]}: ${valuesAt(told, wanted).join(", ") || "–"}`].join(" · ");
        return;
      }
      forget();
    });
  });

  return { color, isDark, dark, onPaper, save, element };
})();
