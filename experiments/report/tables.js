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
  addEventListener("beforeprint", () => { shown = root.dataset.theme; root.dataset.theme = "light"; });
  addEventListener("afterprint", () => { if (shown) root.dataset.theme = shown; else delete root.dataset.theme; });

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
  };
  for (const filter of filters) filter.addEventListener("change", apply);
  apply(); // a reloaded page keeps what was chosen
})();
