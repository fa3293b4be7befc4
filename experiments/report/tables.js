"use strict";
// Theme, sorting and filtering.
(() => {
  const root = document.documentElement;
  const stored = () => { try { return localStorage.getItem("conelane-theme"); } catch { return null; } };
  const system = matchMedia("(prefers-color-scheme: dark)");
  const announce = () => document.dispatchEvent(new Event("themechange"));
  if (stored()) root.dataset.theme = stored();
  system.addEventListener("change", announce);
  document.getElementById("theme").addEventListener("click", () => {
    const dark = root.dataset.theme ? root.dataset.theme === "dark" : system.matches;
    root.dataset.theme = dark ? "light" : "dark";
    try { localStorage.setItem("conelane-theme", root.dataset.theme); } catch { /* a file may have no storage */ }
    announce();
  });
  // Ink on a dark ground does not print.
  let shown;
  addEventListener("beforeprint", () => { shown = root.dataset.theme; root.dataset.theme = "light"; announce(); });
  addEventListener("afterprint", () => { if (shown) root.dataset.theme = shown; else delete root.dataset.theme; announce(); });

  const compare = (a, b) => {
    if (a === undefined || b === undefined) return (a === undefined) - (b === undefined); // unknown last
    const difference = Number(a) - Number(b);
    return Number.isNaN(difference) ? a.localeCompare(b) : difference;
  };
  for (const table of document.querySelectorAll("table.sortable")) {
    const headers = [...table.tHead.rows[0].cells];
    headers.forEach((header, column) => header.addEventListener("click", () => {
      const numeric = header.classList.contains("number");
      const next = header.ariaSort === (numeric ? "descending" : "ascending") ? !numeric : numeric;
      for (const other of headers) other.setAttribute("aria-sort", "none");
      header.setAttribute("aria-sort", next ? "descending" : "ascending");
      const key = (row) => row.cells[column].dataset.value;
      for (const body of table.tBodies) { // each block for itself, below its title
        const rows = [...body.rows].filter((row) => !row.classList.contains("block")).sort((a, b) => {
          const order = compare(key(a), key(b));
          return next && key(a) !== undefined && key(b) !== undefined ? -order : order;
        });
        body.append(...rows);
      }
    }));
  }

  // What is not seen of a table: a line at its edge says that there is more, and which way.
  const boxes = [...document.querySelectorAll(".table .scroll")];
  const cueOf = new Map(boxes.map((box) => {
    const cue = document.createElement("div");
    cue.className = "cue";
    cue.setAttribute("aria-hidden", "true"); // a reader of the screen has the whole table
    cue.hidden = true;
    box.append(cue);
    return [box, cue];
  }));
  const hint = (box) => {
    const cue = cueOf.get(box), edge = box.getBoundingClientRect().bottom - (cue.hidden ? 0 : cue.offsetHeight);
    const visible = [...box.querySelectorAll("tbody tr")].filter((row) => !row.hidden);
    const below = visible.filter((row) => row.getBoundingClientRect().bottom > edge + 2).length;
    const right = box.scrollWidth - box.clientWidth - box.scrollLeft > 2;
    const words = [below > 0 ? `↓ ${below} more row${below > 1 ? "s" : ""}` : "", right ? "→ more columns" : ""];
    cue.textContent = words.filter(Boolean).join("   ");
    cue.hidden = cue.textContent === "";
  };
  const hintAll = () => boxes.forEach(hint);
  for (const box of boxes) box.addEventListener("scroll", () => hint(box), { passive: true });
  addEventListener("resize", hintAll);
  addEventListener("load", hintAll);

  const filters = [...document.querySelectorAll("[data-filter]")];
  const apply = () => {
    const filtered = "main tr[data-condition], main figure[data-condition], main details[data-condition]";
    for (const item of document.querySelectorAll(filtered)) {
      item.hidden = filters.some((filter) => filter.value && filter.dataset.filter in item.dataset &&
                                             item.dataset[filter.dataset.filter] !== filter.value);
    }
    const method = filters.find((filter) => filter.dataset.filter === "method");
    const wanted = method ? method.value : "";
    for (const curve of document.querySelectorAll("main g[data-curve]")) { // of a method, whatever its cone set
      const name = curve.dataset.curve;
      curve.style.display = !wanted || wanted === name || wanted.startsWith(name + " n=") ? "" : "none";
    }
    for (const title of document.querySelectorAll("tr.block")) {
      title.hidden = [...title.parentElement.rows].every((row) => row === title || row.hidden);
    }
    hintAll();
  };
  for (const filter of filters) filter.addEventListener("change", apply);
  apply(); // a reloaded page keeps what was chosen
})();
