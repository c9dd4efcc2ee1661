// Elements and pictures of the page. Text from the bus enters it as text alone.
"use strict";

const kDrawn = ["svg", "polyline", "polygon", "path", "rect", "circle", "line", "text", "g", "ellipse"];
const is = (x) => typeof x === "number";

/** An element; children are elements or whatever shall stand there as text. */
function el(tag, attributes, ...children) {
  const node = kDrawn.includes(tag) ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name === "style") node.style.cssText = value;
    else if (value !== null && value !== undefined && value !== "") node.setAttribute(name, value);
  }
  for (const child of children.flat(2)) {
    if (child === null || child === undefined) continue;
    node.append(child instanceof Node ? child : document.createTextNode(String(child)));
  }
  return node;
}

/** Makes `old` like `fresh` with as few changes as may be, so that what somebody has selected stays selected. */
function morph(old, fresh) {
  if (old.nodeType !== fresh.nodeType || old.nodeName !== fresh.nodeName) return old.replaceWith(fresh);
  if (old.nodeType === Node.TEXT_NODE) {
    if (old.data !== fresh.data) old.data = fresh.data;
    return;
  }
  for (const { name } of [...old.attributes]) if (!fresh.hasAttribute(name)) old.removeAttribute(name);
  for (const { name, value } of fresh.attributes) {
    if (old.getAttribute(name) === value) continue;
    if (name === "style") old.style.cssText = value;  // the other way is an inline style, which is not allowed here
    else old.setAttribute(name, value);
  }
  const before = [...old.childNodes], after = [...fresh.childNodes];
  after.forEach((child, i) => (i < before.length ? morph(before[i], child) : old.append(child)));
  before.slice(after.length).forEach((child) => child.remove());
}

/** A bar from the middle, or from the left when nothing is below zero. `mark`: another value on the same scale. */
function bar(value, most, both, mark) {
  const share = (x) => Math.max(-1, Math.min(1, is(x) && most > 0 ? x / most : 0)) * (both ? 50 : 100);
  const from = both ? 50 : 0, s = share(value);
  return el("div", { class: both ? "bar two" : "bar" },
    el("span", { class: s < 0 ? "minus" : "", style: `left:${(from + Math.min(s, 0)).toFixed(2)}%;width:${Math.abs(s).toFixed(2)}%` }),
    is(mark) ? el("u", { style: `left:${(from + share(mark)).toFixed(2)}%` }) : null);
}

/** Two minutes; a gap where nothing was heard. `zero`: a line there. */
function chart(t, values, scale, least, zero) {
  const known = values.filter(is);
  if (zero) known.push(0);
  let low = Math.min(...known), high = Math.max(...known);
  const room = Math.max(least / scale - (high - low), 0) / 2;
  low -= room;
  high += room;
  const y = (value) => (17 - (16 * (value - low)) / (high - low || 1)).toFixed(1);
  const lines = [[]];
  t.forEach((at, i) => {
    if (i > 0 && at - t[i - 1] > 2) lines.push([]);
    if (is(values[i])) lines[lines.length - 1].push(`${(120 + at).toFixed(1)},${y(values[i])}`);
  });
  return el("svg", { viewBox: "0 0 120 18", preserveAspectRatio: "none", class: "strip" },
    zero ? el("line", { x1: 0, x2: 120, y1: y(0), y2: y(0), class: "zero" }) : null,
    lines.map((line) => el("polyline", { points: line.join(" ") })));
}

/** A value on its way with its interval, from the trial's beginning to now. */
function convergence(t, kept) {
  const points = t.map((at, i) => [at, kept.value[i], kept.low[i], kept.high[i]]).filter((p) => p.every(is));
  if (points.length < 2) return el("svg", { viewBox: "0 0 100 18", preserveAspectRatio: "none", class: "strip" });
  // The first intervals are as wide as the prior: the last three quarters are shown whole.
  const late = points.slice(Math.floor(points.length / 4));
  let low = Math.min(...late.map((p) => p[2])), high = Math.max(...late.map((p) => p[3]));
  const room = 0.25 * (high - low) || Math.abs(high) * 0.05 || 1;
  low -= room;
  high += room;
  const first = points[0][0], last = points[points.length - 1][0];
  const x = (at) => ((100 * (at - first)) / (last - first || 1)).toFixed(1);
  const y = (value) => (17 - 16 * Math.max(0, Math.min(1, (value - low) / (high - low)))).toFixed(1);
  const band = [...points.map((p) => `${x(p[0])},${y(p[3])}`), ...points.map((p) => `${x(p[0])},${y(p[2])}`).reverse()];
  return el("svg", { viewBox: "0 0 100 18", preserveAspectRatio: "none", class: "strip" },
    el("polygon", { points: band.join(" "), class: "band" }),
    el("polyline", { points: points.map((p) => `${x(p[0])},${y(p[1])}`).join(" ") }));
}

const finite = (bounds) => bounds && [...bounds.low, ...bounds.high].every(is);

/** Seen from above, north up: x of the picture is east, y is south. */
function planView(all) {
  const place = all.place, state = all.state, [n, e, , , , yaw] = state ? state.values : [null, null, null, null, null, null];
  const here = is(n) && is(e) ? [n, e] : null;
  const reach = all.track.filter((p) => p.every(is));
  if (here) reach.push(here);
  for (const bounds of [place.walls, place.fence]) if (finite(bounds)) reach.push(bounds.low, bounds.high);
  for (const list of [place.tags, place.transponders]) reach.push(...list);
  if (place.anchor) reach.push(place.anchor.slice(0, 2));
  if (!reach.length) return null;
  const least = (i) => Math.min(...reach.map((p) => p[i])), most = (i) => Math.max(...reach.map((p) => p[i]));
  const size = Math.max(most(0) - least(0), most(1) - least(1), 1), pad = 0.07 * size;
  const box = [least(1) - pad, -most(0) - pad, most(1) - least(1) + 2 * pad, most(0) - least(0) + 2 * pad];
  // A track in a straight line, or a vehicle that has not moved, still gets a picture that one can look at.
  if (box[2] < 0.5 * box[3]) [box[0], box[2]] = [box[0] - (0.5 * box[3] - box[2]) / 2, 0.5 * box[3]];
  if (box[3] < 0.4 * box[2]) [box[1], box[3]] = [box[1] - (0.4 * box[2] - box[3]) / 2, 0.4 * box[2]];
  const unit = Math.max(box[2], box[3]) / 100, at = (p) => `${p[1].toFixed(3)},${(-p[0]).toFixed(3)}`;
  const wide = { "stroke-width": (0.4 * unit).toFixed(4) };
  const rect = (bounds, kind) => finite(bounds) ? el("rect", { ...wide, class: kind, x: bounds.low[1], y: -bounds.high[0],
    width: bounds.high[1] - bounds.low[1], height: bounds.high[0] - bounds.low[0] }) : null;
  const length = Math.max(is(place.hull[0]) ? place.hull[0] : 0, 3.5 * unit), half = 0.3 * length;
  const hull = [[0.55 * length, 0], [0.2 * length, half], [-0.45 * length, half], [-0.45 * length, -half], [0.2 * length, -half]];
  const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500].find((s) => s > 0.15 * box[2]) || 1000;
  const foot = box[1] + box[3] - 2 * unit, left = box[0] + 2 * unit;
  const drawing = el("svg", { viewBox: box.map((v) => v.toFixed(3)).join(" "), class: "plan", role: "img", "aria-label": "plan view, north up" },
    rect(place.walls, "walls"), rect(place.fence, "fence"),
    place.tags.map((p) => el("rect", { class: "tag", x: (p[1] - unit).toFixed(3), y: (-p[0] - unit).toFixed(3), width: 2 * unit, height: 2 * unit })),
    place.transponders.map((p) => el("circle", { class: "transponder", cx: p[1], cy: -p[0], r: 1.2 * unit })),
    place.anchor && here ? el("line", { ...wide, class: "tether", x1: place.anchor[1], y1: -place.anchor[0], x2: e, y2: -n }) : null,
    place.anchor ? el("circle", { class: "anchor", cx: place.anchor[1], cy: -place.anchor[0], r: 1.2 * unit }) : null,
    el("polyline", { "stroke-width": (0.6 * unit).toFixed(4), class: "track", points: all.track.filter((p) => p.every(is)).map(at).join(" ") }),
    here && is(state.sigma[0]) ? el("ellipse", { class: "doubt", cx: e, cy: -n, rx: 2 * (state.sigma[1] || 0), ry: 2 * state.sigma[0] }) : null,
    here && is(yaw) ? el("polygon", { ...wide, class: state.valid ? "hull" : "hull doubtful", points: hull.map(([x, y]) =>
      at([n + Math.cos(yaw) * x - Math.sin(yaw) * y, e + Math.sin(yaw) * x + Math.cos(yaw) * y])).join(" ") }) : null,
    el("line", { "stroke-width": (0.8 * unit).toFixed(4), class: "scale", x1: left, x2: left + step, y1: foot, y2: foot }),
    el("text", { class: "scale", x: left, y: foot - 1.2 * unit, "font-size": 3.4 * unit }, `${step} m`),
    el("text", { class: "scale", x: box[0] + box[2] - 6 * unit, y: box[1] + 6 * unit, "font-size": 4.5 * unit }, "N ↑"));
  const named = [[finite(place.walls), "walls", "walls"], [finite(place.fence), "fence", "fence"], [place.tags.length, "tag", "tags"],
    [place.transponders.length, "transponder", "transponders"], [place.anchor, "tether", "tether"], [true, "track", "track"]];
  return [drawing, el("p", { class: "legend soft" }, named.filter((one) => one[0]).map(([, kind, word]) => el("span", {}, el("i", { class: kind }), word)))];
}

/** Roll and pitch as a horizon, heading as a compass, depth between surface and floor. */
function attitude(values, place) {
  const [, , z, roll, pitch, yaw] = values, deg = 180 / Math.PI;
  if (![z, roll, pitch, yaw].every(is)) return null;
  const shift = Math.max(-38, Math.min(38, pitch * deg * 0.9));
  const horizon = el("svg", { viewBox: "-50 -50 100 100", class: "dial", role: "img", "aria-label": "roll and pitch" },
    el("circle", { r: 46, class: "water" }),
    el("g", { transform: `rotate(${(-roll * deg).toFixed(1)}) translate(0 ${shift.toFixed(1)})` },
      el("line", { x1: -40, x2: 40, y1: 0, y2: 0, class: "horizon" }), el("line", { x1: -14, x2: 14, y1: -18, y2: -18, class: "zero" }),
      el("line", { x1: -14, x2: 14, y1: 18, y2: 18, class: "zero" })),
    el("path", { d: "M-24 0h14l10 7l10 -7h14", class: "ship" }));
  const compass = el("svg", { viewBox: "-50 -50 100 100", class: "dial", role: "img", "aria-label": "heading" },
    el("circle", { r: 46, class: "water" }), [["N", 0, -32], ["E", 34, 4], ["S", 0, 40], ["W", -34, 4]].map(([word, x, y]) => el("text", { x, y, class: "rose" }, word)),
    el("polygon", { points: "0,-26 8,14 0,8 -8,14", class: "hull", transform: `rotate(${(yaw * deg).toFixed(1)})` }));
  const top = is(place.surface) ? place.surface : Math.min(0, z), floor = is(place.floor) && place.floor > top ? place.floor : Math.max(z * 1.3, top + 1);
  const y = (depth) => -44 + (88 * Math.max(0, Math.min(1, (depth - top) / (floor - top))));
  const depth = el("svg", { viewBox: "-25 -50 50 100", class: "dial depth", role: "img", "aria-label": "depth" },
    el("rect", { x: -10, y: -44, width: 20, height: 88, class: "water" }), el("polygon", { points: `-10,${y(z) - 5} -10,${y(z) + 5} 2,${y(z)}`, class: "hull" }),
    el("line", { x1: -10, x2: 10, y1: y(z), y2: y(z), class: "horizon" }));
  const dial = (picture, words) => el("figure", {}, picture, el("figcaption", {}, words));
  const angle = (x) => `${(x * deg).toFixed(0).replace(/^-0$/, "0")}°`;
  return el("div", { class: "dials" }, dial(horizon, `roll ${angle(roll)}, pitch ${angle(pitch)}`), dial(compass, `heading ${angle((yaw + 2 * Math.PI) % (2 * Math.PI))}`),
    dial(depth, is(place.floor) ? `depth ${(z - top).toFixed(2)} m, ${(floor - z).toFixed(2)} m above the floor` : `depth ${(z - top).toFixed(2)} m`));
}
