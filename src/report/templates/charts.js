// Read-out under the pointer, the player's time in every time plot, table filters.
"use strict";
(() => {
  const plots = [...document.querySelectorAll("svg.plot")].map((svg) => {
    const numbers = (name) => svg.dataset[name].split(" ").map(Number);
    return { svg, x: numbers("x"), y: numbers("y"), lines: null, cursor: svg.querySelector(".cursor") };
  });
  const scale = (v, [v0, v1, p0, p1]) => p0 + ((v - v0) / (v1 - v0)) * (p1 - p0);
  const value = (p, [v0, v1, p0, p1]) => v0 + ((p - p0) / (p1 - p0)) * (v1 - v0);
  // As many digits as the drawing has: its lines are true to a tenth of a unit.
  const text = (v, [v0, v1, p0, p1]) => {
    const decimals = Math.floor(-Math.log10(Math.abs((0.1 * (v1 - v0)) / (p1 - p0))));
    const digits = decimals > 7 ? v.toPrecision(3) : v.toFixed(Math.max(0, decimals));
    return (Number(digits) === 0 ? digits.replace("-", "") : digits.replace("-", "\u2212"));
  };

  // A path as stretches of points: "M1 2L3 4L5 6M7 8h0".
  const parse = (path) => ({
    label: path.dataset.label,
    runs: path.getAttribute("d").split("M").slice(1).map((run) => run.replace("h0", "").split("L").map((p) => p.split(" ").map(Number))),
  });
  const height = (runs, x) => {
    for (const run of runs) {
      if (x < run[0][0] - 0.5 || x > run[run.length - 1][0] + 0.5) continue;
      let i = run.findIndex((p) => p[0] >= x);
      if (i < 0) i = run.length - 1;
      if (i === 0) return run[0][1];
      const [a, b] = [run[i - 1], run[i]];
      return b[0] > a[0] ? a[1] + ((b[1] - a[1]) * Math.min(x - a[0], b[0] - a[0])) / (b[0] - a[0]) : b[1];
    }
    return NaN;
  };

  let time = null;
  const place = (plot, v) => {
    const inside = v !== null && v >= plot.x[0] - 1e-9 && v <= plot.x[1] + 1e-9;
    plot.cursor.setAttribute("visibility", inside ? "visible" : "hidden");
    if (inside) {
      const p = scale(v, plot.x).toFixed(2);
      plot.cursor.setAttribute("x1", p);
      plot.cursor.setAttribute("x2", p);
    }
  };
  const rest = (plot) => place(plot, "time" in plot.svg.dataset ? time : null);
  document.addEventListener("fallwerk:time", (event) => {
    time = event.detail;
    plots.forEach(rest);
  });

  for (const plot of plots) {
    const { svg } = plot;
    const figure = svg.closest("figure");
    let box = null;
    const at = (event) => {
      const r = svg.getBoundingClientRect();
      const p = ((event.clientX - r.left) / r.width) * svg.viewBox.baseVal.width;
      return Math.min(Math.max(p, plot.x[2]), plot.x[3]);
    };
    svg.addEventListener("pointermove", (event) => {
      plot.lines ??= [...svg.querySelectorAll("path[data-label]")].map(parse);
      const p = at(event);
      const v = value(p, plot.x);
      place(plot, v);
      if (!box) {
        box = document.createElement("div");
        box.className = "readout";
        box.setAttribute("aria-hidden", "true");
        figure.append(box);
      }
      box.replaceChildren();
      const row = (label, content) => {
        const line = document.createElement("div");
        const b = document.createElement("b");
        b.textContent = content;
        line.append(b, label);
        box.append(line);
      };
      row(svg.dataset.xname, `${text(v, plot.x)} ${svg.dataset.xunit}`);
      const unit = svg.dataset.yunit === "\u2013" ? "" : ` ${svg.dataset.yunit}`;
      for (const line of plot.lines) {
        const y = height(line.runs, p);
        row(line.label, Number.isNaN(y) ? "\u2013" : text(value(y, plot.y), plot.y) + unit);
      }
      const f = figure.getBoundingClientRect();
      const left = event.clientX - f.left;
      box.style.top = `${Math.max(0, event.clientY - f.top - box.offsetHeight - 8)}px`;
      box.style.left = `${left + box.offsetWidth + 20 > f.width ? left - box.offsetWidth - 14 : left + 14}px`;
    });
    svg.addEventListener("pointerleave", () => {
      box?.remove();
      box = null;
      rest(plot);
    });
    if ("time" in svg.dataset) {
      svg.addEventListener("click", (event) => document.dispatchEvent(new CustomEvent("fallwerk:seek", { detail: value(at(event), plot.x) })));
    }
  }

  for (const input of document.querySelectorAll("[data-filter]")) {
    const rows = [...document.querySelectorAll(`#${input.dataset.filter} tbody tr`)];
    input.addEventListener("input", () => {
      const words = input.value.toLowerCase().split(/\s+/);
      for (const row of rows) row.hidden = !words.every((w) => row.textContent.toLowerCase().includes(w));
    });
  }
  // All results are on the printed page; the tables of the model, hundreds of pages of a large one, where they are open.
  let closed = [];
  addEventListener("beforeprint", () => {
    closed = [...document.querySelectorAll("main > section:not(#model) details:not([open])")];
    closed.forEach((d) => (d.open = true));
  });
  addEventListener("afterprint", () => closed.forEach((d) => (d.open = false)));
})();
