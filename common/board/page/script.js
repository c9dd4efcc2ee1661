// Asks for board.json twice a second and draws it. Text from the bus enters the page as text alone.
"use strict";

const kPeriod = 500;     // ms
const kPatience = 2500;  // ms without an answer after which the page says so
const kOld = 3;          // s after which a section is marked
const byId = (id) => document.getElementById(id);

/** An element; children are elements or whatever shall stand there as text. */
function el(tag, attributes, ...children) {
  const svg = tag === "svg" || tag === "polyline";
  const node = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name === "style") node.style.cssText = value;
    else if (value !== null && value !== undefined && value !== "") node.setAttribute(name, value);
  }
  for (const child of children.flat()) {
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

const is = (x) => typeof x === "number";
const fixed = (x, digits) => (is(x) ? x.toFixed(digits).replace(/^-(0\.?0*)$/, "$1") : "–");
const times = (scale, x) => (is(x) ? scale * x : null);  // null times anything would be a measured zero
const short = (x) => (!is(x) ? "–" : x !== 0 && (Math.abs(x) < 1e-3 || Math.abs(x) >= 1e5) ? x.toExponential(2) : String(+x.toPrecision(4)));
const ago = (age) => fixed(age, age < 10 ? 1 : 0) + " s";
const cell = (kind, ...children) => el("td", { class: kind }, ...children);
const row = (kind, ...cells) => el("tr", { class: kind }, ...cells);
const table = (heads, rows) =>
  el("table", {}, heads && el("thead", {}, el("tr", {}, heads.map((h) => el("th", { class: h[0] === ">" ? "n" : "" }, h.replace(">", ""))))), el("tbody", {}, rows));

/** A bar from the middle, or from the left when nothing is below zero. `mark`: another value on the same scale. */
function bar(value, most, both, mark) {
  const share = (x) => Math.max(-1, Math.min(1, is(x) && most > 0 ? x / most : 0)) * (both ? 50 : 100);
  const from = both ? 50 : 0, s = share(value);
  return el("div", { class: both ? "bar two" : "bar" },
    el("span", { class: s < 0 ? "minus" : "", style: `left:${(from + Math.min(s, 0)).toFixed(2)}%;width:${Math.abs(s).toFixed(2)}%` }),
    is(mark) ? el("u", { style: `left:${(from + share(mark)).toFixed(2)}%` }) : null);
}

/** Two minutes; a gap where nothing was heard. */
function chart(t, values, scale, least) {
  const known = values.filter(is);
  let low = Math.min(...known), high = Math.max(...known);
  const room = Math.max(least / scale - (high - low), 0) / 2;
  low -= room;
  high += room;
  const lines = [[]];
  t.forEach((at, i) => {
    if (i > 0 && at - t[i - 1] > 2) lines.push([]);
    if (is(values[i])) lines[lines.length - 1].push(`${(120 + at).toFixed(1)},${(17 - (16 * (values[i] - low)) / (high - low || 1)).toFixed(1)}`);
  });
  return el("svg", { viewBox: "0 0 120 18", preserveAspectRatio: "none" }, lines.map((line) => el("polyline", { points: line.join(" ") })));
}

const lively = new Set();

/** Channels of a process that came all the time and do not any more; others are orders, and what is said once. */
function quiet(p) {
  const key = (c) => `${p.host} ${p.pid} ${p.name} ${c.channel}`;
  if (lively.size > 5000) lively.clear();
  for (const c of p.channels) if (c.rate >= 2) lively.add(key(c));
  return p.channels.filter((c) => c.rate < 0.5 && c.age > 1 && lively.has(key(c)));
}

const sections = {
  trial(all) {
    const t = all.trial;
    if (!t) return "no EXCITATION: the supervisor has not spoken";
    const stopped = t.phase === "aborted" || t.phase === "lost";
    const said = [el("p", { class: "big" }, el("b", { class: stopped ? "bad" : "" }, t.phase), " ", el("span", { class: stopped ? "bad" : "" }, t.reason))];
    if (!t.mode) return said;
    said.push(el("p", {}, "mode ", el("b", {}, t.mode), `, ${fixed(t.elapsed, 0)} of at most ${fixed(t.duration, 0)} s`,
      t.signal ? `, ${t.signal}` : "", t.bent ? el("b", { class: "warn" }, ", bent by the fence") : null));
    if (is(t.metric) && t.threshold > 0) {
      // Variances fall over decades, so the bar is logarithmic: full at the threshold, empty at a thousand times it.
      const left = Math.log10(Math.max(t.metric / t.threshold, 1)) / 3;
      said.push(el("p", {}, `metric ${short(t.metric)} against ${short(t.threshold)}`), bar(Math.max(1 - left, 0), 1, false));
    }
    if (t.missing) said.push(el("p", {}, el("b", {}, "missing: "), t.missing));
    if (t.frozen.length) said.push(el("p", { class: "soft" }, "not learnt now: " + t.frozen.join(", ")));
    return said;
  },

  processes(all) {
    if (!all.processes.length) return "nobody says HEALTH on this bus";
    return table(["process", "host", "health", ">CPU", ">memory", ">dropped", ">rejected", "says of itself; hears"],
      all.processes.map((p) => {
        const ended = p.state === "stopped";
        const heard = p.channels.filter((c) => c.rate >= 0.5).map((c) => `${c.channel} ${fixed(c.rate, 0)}/s`).join(", ");
        const rare = p.channels.filter((c) => c.rate < 0.5).map((c) => `${c.channel} ${ago(c.age)}`).join(", ");
        const lost = quiet(p).map((c) => `${c.channel} silent for ${ago(c.age)}`).join(", ");
        const words = p.state === "silent" ? p.state : p.age > 2 ? `${p.state}, ${ago(p.age)} ago` : p.state;
        return row(ended ? "soft" : p.healthy ? "" : "sick",
          cell("k", p.name), cell("k plain", p.host, el("span", { class: "soft" }, " " + p.pid)), cell("word", words),
          cell("n", fixed(times(100, p.cpu), 0) + " %"), cell("n", fixed(times(1e-6, p.memory), 0) + " MB"),
          cell(p.dropped ? "n warn" : "n", p.dropped), cell(p.rejected ? "n warn" : "n", p.rejected),
          cell("", p.detail ? el("div", {}, p.detail.replace(/; *$/, "")) : null,
            p.returns ? el("div", { class: "warn" }, `started again ${p.returns === 1 ? "once" : p.returns + " times"}`) : null,
            ended || p.state === "silent" ? null : el("div", { class: "soft", title: rare && "not now, for so long: " + rare },
              heard, lost && el("b", { class: "warn" }, (heard && ", ") + lost))));
      }));
  },

  state(all) {
    const s = all.state;
    if (!s) return "no STATE: the estimator has not spoken";
    const deg = 180 / Math.PI;
    const kinds = [["north", "m", 1, 3, 0.1], ["east", "m", 1, 3, 0.1], ["depth", "m", 1, 3, 0.1], ["roll", "°", deg, 1, 2], ["pitch", "°", deg, 1, 2],
      ["yaw", "°", deg, 1, 2], ["u", "m/s", 1, 3, 0.05], ["v", "m/s", 1, 3, 0.05], ["w", "m/s", 1, 3, 0.05], ["p", "°/s", deg, 1, 2], ["q", "°/s", deg, 1, 2], ["r", "°/s", deg, 1, 2]];
    return [el("p", {}, el("b", { class: s.valid ? "good" : "bad" }, s.valid ? "valid" : "NOT VALID"),
      el("span", { class: "soft" }, "; rests on " + (s.sources.map((x) => `${x.channel} ${fixed(x.age, 2)} s`).join(", ") || "nothing"))),
    table(["", ">", ">± 1σ", "", "last two minutes"], kinds.map(([name, unit, scale, digits, least], i) =>
      row("", cell("k", name), cell("n", fixed(times(scale, s.values[i]), digits)), cell("n soft", fixed(times(scale, s.sigma[i]), digits)), cell("soft", unit),
        cell("chart", chart(all.history.t, all.history.values[i], scale, least)))))];
  },

  model(all) {
    const m = all.model;
    if (!m) return "no MODEL: the identifier has not spoken";
    const line = (p) => row(p.frozen ? "soft" : "", cell("k", p.name), cell("n", short(p.value)), cell("", p.unit),
      cell("n", `${short(p.low)} … ${short(p.high)}`), cell("n soft", is(p.entangled) ? short(p.entangled) : ""), cell("soft", p.frozen ? "not learnt now" : ""));
    return [el("p", {}, el("b", {}, m.joint ? "joint" : "recursive"), el("span", { class: "soft" }, m.joint ? " estimate, of state and parameters in one filter" : " estimate, from STATE")),
      m.residual_fails_on.length ? el("p", {}, el("b", {}, "this model lacks something"), el("span", { class: "soft" }, `: its residual failed the test on ${m.residual_fails_on.join(", ")}; intervals are wider for it, and may still miss`)) : null,
      table(["parameter", ">value", "", ">95 %", ">entangled", ""], m.parameters.map(line)),
      is(m.condition) ? el("p", { class: "soft" }, `entangled: times the variance were all others known; condition of the correlations ${short(m.condition)}`) : null,
      el("p", {}, el("b", {}, "adopted: "), m.effects.length ? m.effects.join(", ") : "no effect"),
      m.effect_numbers.length ? table(null, m.effect_numbers.map(line)) : null];
  },

  thrusters(all) {
    const t = all.thrusters, asked = all.asked && all.asked.age < kOld ? all.asked.tau : null;
    if (!t) return "no THRUSTERS: the thruster driver has not spoken";
    const size = (values) => Math.max(1, ...(values || []).filter(is).map(Math.abs));
    sections.most = Math.max(sections.most || 1, size(t.force));
    const volts = all.battery ? [el("b", {}, fixed(all.battery.voltage, 1) + " V"), all.battery.age > kOld ? el("span", { class: "bad" }, ` ${ago(all.battery.age)} ago`) : null] : "voltage not told";
    const forces = t.force.length ? table(["thruster", ">applied", "", `± ${fixed(sections.most, 0)} N`], t.force.map((f, i) =>
      row("", cell("k", `${i + 1}`), cell("n", fixed(f, 2)), cell("soft", "N"), cell("wide", bar(f, sections.most, true))))) : el("p", { class: "soft" }, "forces not told");
    const most = [size([...(t.tau || []).slice(0, 3), ...(asked || []).slice(0, 3)]), size([...(t.tau || []).slice(3), ...(asked || []).slice(3)])];
    const wrench = t.tau || asked ? table(["wrench", ">applied", ">asked", "", "applied, | asked"], [..."XYZKMN"].map((name, i) =>
      row("", cell("k", name), cell("n", t.tau ? fixed(t.tau[i], 2) : "–"), cell("n", asked ? fixed(asked[i], 2) : "–"), cell("soft", i < 3 ? "N" : "N m"),
        cell("wide", bar(t.tau ? t.tau[i] : null, most[i < 3 ? 0 : 1], true, asked ? asked[i] : null))))) : null;
    const command = asked ? null : el("p", { class: "soft" }, all.asked ? `no WRENCH_COMMAND for ${ago(all.asked.age)}` : "no WRENCH_COMMAND yet");
    return [el("p", {}, volts), forces, wrench, command];
  },

  effects(all) {
    const e = all.effects;
    if (!e) return "no EFFECTS: the diagnoser has not spoken";
    const most = Math.max(5, ...e.candidates.map((c) => Math.abs(c.log_odds || 0)));
    const said = [el("p", { class: "big" }, "verdict: ", el("b", {}, e.verdict))];
    if (e.against) said.push(el("p", { class: "warn" }, `cannot be told from ${e.against}`));
    if (e.segment) said.push(el("p", {}, "to fly next: ", el("b", {}, e.segment), e.duration > 0 ? `, ${fixed(e.duration, 0)} s` : ""));
    said.push(e.candidates.length ? table(["candidate", ">log odds", "", ">explains"], e.candidates.slice(0, 8).map((c) =>
      row("", cell("k", c.name, c.variant ? el("span", { class: "soft" }, " " + c.variant) : null), cell("n", fixed(c.log_odds, 1)),
        cell("wide", bar(c.log_odds, most, true)), cell("n", fixed(times(100, c.error_reduction), 0) + " %")))) : el("p", { class: "soft" }, "no candidate yet"));
    return said;
  },
};

const source = { trial: "trial", state: "state", model: "model", thrusters: "thrusters", effects: "effects" };
const slow = { model: 4, effects: 10 };  // times as long: they are said more rarely

function draw(all) {
  const silent = all.heard === null || all.heard > all.silence;
  for (const name of ["trial", "processes", "state", "model", "thrusters", "effects"]) {
    const heard = all[source[name]], age = heard && is(heard.age) ? heard.age : null;
    const old = age !== null && (silent || age > kOld * (slow[name] || 1));
    byId(name).className = old ? (all.standing.over ? "old over" : "old") : "";
    byId(name).querySelector("h2 i").textContent = old ? `last heard ${ago(age)} ago` : "";
    const fresh = el("div", {}, [sections[name](all)].flat());
    morph(byId(name).querySelector("h2 + div"), fresh);
  }
  const stands = all.standing;
  for (const name of ["phase", "armed"]) {
    byId(name).textContent = stands[name].text;
    byId(name).className = `badge ${stands[name].kind}`;
    byId(name).hidden = !stands[name].text;
  }
  byId("bus").textContent = all.bus;
  byId("heard").textContent = silent ? "" : `heard ${ago(all.heard)} ago`;
  byId("alarm").hidden = !(stands.alarm || stands.remark);
  byId("alarm").className = stands.alarm ? "" : "calm";
  byId("alarm").textContent = stands.alarm || stands.remark;
}

let number = null, moved = performance.now();

/** The veil's clock begins anew; it falls by itself when this is not called any more. */
function alive() {
  moved = performance.now();
  const veil = byId("veil");
  veil.replaceWith(veil.cloneNode(true));
}

async function ask() {
  let why = "The board does not answer";
  try {
    const answer = await fetch("board.json", { cache: "no-store", signal: AbortSignal.timeout(kPatience) });
    if (!answer.ok) throw new Error(`it answers ${answer.status}`);
    const all = await answer.json();
    why = "The board answers, but stands still";
    if (all.number !== undefined && all.number !== number) {
      number = all.number;
      why = "The page cannot draw what it is told";
      draw(all);
      alive();
      why = "The script of this page stands still";  // should it never come here again
    }
  } catch (error) {
    why += ` (${error.message})`;
  }
  const still = (performance.now() - moved) / 1000;
  byId("why").textContent = `${why}; all on it is ${ago(still)} old.`;
  setTimeout(ask, kPeriod);
}

// Two columns of sections, each as tight as it can be; below one another on a narrow screen.
for (const names of [["trial", "state", "thrusters"], ["processes", "model", "effects"]]) {
  document.querySelector("main").append(el("div", {}, names.map(byId)));
}
ask();
