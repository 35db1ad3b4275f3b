"use strict";
(function () {
  const table = document.getElementById("all");
  if (!table) return;
  const body = table.tBodies[0];
  const heads = Array.from(table.tHead.rows[0].cells);
  const rows = Array.from(body.rows);
  const value = (row, column) => {
    const cell = row.cells[column];
    return cell.dataset.v === undefined ? cell.textContent.trim() : Number(cell.dataset.v);
  };

  /* Numbers before words, what is not known last, whatever the direction. */
  const order = (a, b, way) => {
    if (typeof a !== typeof b) return typeof a === "number" ? -1 : 1;
    if (typeof a === "number") return way * (a - b);
    if ((a === "–") !== (b === "–")) return a === "–" ? 1 : -1;
    return way * a.localeCompare(b, "en", { numeric: true });
  };
  heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => {
    /* Numbers begin with the largest. */
    const numeric = rows.some((row) => typeof value(row, column) === "number");
    const first = numeric && column > 0 ? "descending" : "ascending";
    const second = first === "ascending" ? "descending" : "ascending";
    const now = head.getAttribute("aria-sort") === first ? second : first;
    heads.forEach((each) => each.removeAttribute("aria-sort"));
    head.setAttribute("aria-sort", now);
    const way = now === "ascending" ? 1 : -1;
    rows.sort((a, b) => order(value(a, column), value(b, column), way) || value(a, 0) - value(b, 0));
    body.append(...rows);
  }));

  const tests = {
    "<": (a, b) => a < b, ">": (a, b) => a > b, "<=": (a, b) => a <= b, ">=": (a, b) => a >= b,
    "=": (a, b) => a === b, "!=": (a, b) => a !== b,
  };
  /* A word is a condition if a column is called what stands in front of <, > or =. */
  const condition = (word) => {
    const parts = /^(.+?)(<=|>=|!=|<|>|=)(.+)$/.exec(word);
    const column = parts ? heads.findIndex((head) => head.dataset.head.toLowerCase() === parts[1]) : -1;
    if (column < 0) return (row) => row.textContent.toLowerCase().includes(word);
    return (row) => {
      const found = value(row, column);
      if (typeof found === "number") return tests[parts[2]](found, Number(parts[3]));
      return found !== "–" && tests[parts[2]](found.toLowerCase(), parts[3]);
    };
  };
  const filter = document.getElementById("filter");
  const shown = document.getElementById("shown");
  filter.addEventListener("input", () => {
    const conditions = filter.value.toLowerCase().split(/\s+/).filter(Boolean).map(condition);
    let count = 0;
    for (const row of rows) {
      row.hidden = !conditions.every((holds) => holds(row));
      count += row.hidden ? 0 : 1;
    }
    shown.value = conditions.length ? count + " of " + rows.length + " points" : rows.length + " points";
  });

  /* A link to a machine opens it. */
  const open = () => {
    const target = location.hash && document.getElementById(location.hash.slice(1));
    if (target && target.tagName === "DETAILS") target.open = true;
  };
  window.addEventListener("hashchange", open);
  open();
})();
