// Long plots that can be looked into: each .plot holds a still picture, which stays for print and for whoever runs no
// scripts, and its numbers in data attributes. When it is first seen, uPlot draws them in its place.
document.addEventListener("DOMContentLoaded", () => {
  "use strict";
  const groups = {};  // plots of one run move together
  // "step:first,difference,...": whole steps; empty is a gap.
  const row = text => {
    const [step, differences] = text.split(":");
    if (differences === "") return [];
    let sum = 0;
    return differences.split(",").map(each => (each === "" ? null : (sum += +each) * step));
  };

  const show = (plot, from, to) => {
    const all = plot.data[0], first = all[0], last = all[all.length - 1];
    const width = Math.min(to - from, last - first);
    from = Math.max(first, Math.min(from, last - width));
    for (const other of groups[plot.group]) other.setScale("x", {min: from, max: from + width});
  };
  const button = (nav, text, says, act) => {
    const made = nav.appendChild(document.createElement("button"));
    made.type = "button";
    made.textContent = text;
    made.title = says;
    made.setAttribute("aria-label", says);
    made.onclick = act;
  };

  const build = box => {
    const names = box.dataset.names.split("|"), colours = box.dataset.colours.split("|");
    const data = [row(box.dataset.t), ...box.dataset.y.split(";").map(row)];
    const marks = row(box.dataset.marks);
    const limit = (text, without) => (text === "" ? without : +text);
    const floor = limit(box.dataset.floor, -Infinity), ceiling = limit(box.dataset.ceiling, Infinity);
    const height = () => Math.max(170, Math.min(280, Math.round(0.4 * box.clientWidth)));
    const group = box.dataset.group;
    let plot = null;
    const options = {
      width: box.clientWidth, height: height(), title: box.dataset.title,
      scales: {x: {time: false}, y: {range: (u, low, high) => {
        low = Math.max(low, floor);
        high = Math.min(high, ceiling);
        const margin = 0.04 * (high - low) || 1e-9;
        return [low - margin, high + margin];
      }}},
      series: [{label: "t [s]", value: (u, v) => (v === null ? "-" : v.toFixed(2))},
               ...names.map((label, i) => ({label, stroke: colours[i], width: 1.5, spanGaps: false,
                                            value: (u, v) => (v === null ? "-" : v.toPrecision(4))}))],
      axes: [{label: "time [s]", labelSize: 20, size: 34, grid: {show: false}}, {size: 58}],
      legend: {markers: {fill: (u, i) => colours[i - 1]}},
      cursor: {sync: {key: group}, drag: {x: true, y: false, setScale: false}},
      hooks: {
        setSelect: [u => {
          if (u.select.width < 4) return;
          show(plot, u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x"));
          u.setSelect({left: 0, width: 0, top: 0, height: 0}, false);
        }],
        drawClear: [u => {
          u.ctx.save();
          u.ctx.strokeStyle = "#d3d8de";
          u.ctx.beginPath();
          for (const at of marks) {
            if (at === null || at < u.scales.x.min || at > u.scales.x.max) continue;
            const x = Math.round(u.valToPos(at, "x", true));
            u.ctx.moveTo(x, u.bbox.top);
            u.ctx.lineTo(x, u.bbox.top + u.bbox.height);
          }
          u.ctx.stroke();
          u.ctx.restore();
        }],
      },
    };
    const live = box.appendChild(document.createElement("div"));
    live.className = "live";
    plot = new uPlot(options, data, live);
    plot.group = group;
    (groups[group] = groups[group] || []).push(plot);
    const nav = live.appendChild(document.createElement("nav"));
    const by = (left, right) => () => {
      const {min, max} = plot.scales.x, width = max - min;
      show(plot, min + left * width, max + right * width);
    };
    button(nav, "+", "closer", by(0.25, -0.25));
    button(nav, "−", "further away", by(-0.5, 0.5));
    button(nav, "◀", "earlier", by(-0.5, -0.5));
    button(nav, "▶", "later", by(0.5, 0.5));
    button(nav, "all", "the whole run", () => show(plot, data[0][0], data[0][data[0].length - 1]));
    plot.over.addEventListener("dblclick", () => show(plot, data[0][0], data[0][data[0].length - 1]));
    box.classList.add("on");
    new ResizeObserver(() => {
      if (box.clientWidth > 0) plot.setSize({width: box.clientWidth, height: height()});
    }).observe(box);
  };

  const seen = new IntersectionObserver(entries => {
    for (const entry of entries) {
      if (!entry.isIntersecting || entry.target.clientWidth === 0) continue;
      seen.unobserve(entry.target);
      build(entry.target);
    }
  }, {rootMargin: "200px"});
  for (const box of document.querySelectorAll(".plot")) seen.observe(box);
});
