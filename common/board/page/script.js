// Asks for board.json twice a second and draws it. Text from the bus enters the page as text alone.
"use strict";

const kPeriod = 500;     // ms
const kPatience = 2000;  // ms that an answer may take; the veil (style.css) waits for two of them
const kOld = 3;          // s after which a section is marked
const kLeft = ["trial", "plan", "state", "thrusters", "vehicle"], kRight = ["processes", "model", "residual", "effects", "events"];
const byId = (id) => document.getElementById(id);

const fixed = (x, digits) => (is(x) ? x.toFixed(digits).replace(/^-(0\.?0*)$/, "$1") : "–");
const times = (scale, x) => (is(x) ? scale * x : null);  // null times anything would be a measured zero
const short = (x) => (!is(x) ? "–" : x !== 0 && (Math.abs(x) < 1e-3 || Math.abs(x) >= 1e5) ? x.toExponential(2) : String(+x.toPrecision(4)));
/** "150 : 1" of a natural logarithm; beyond a million nobody wants the digits. */
function odds(log) {
  if (!is(log)) return "–";
  const size = Math.exp(Math.abs(log));
  const words = size >= 1e6 ? "> 10⁶" : size >= 100 ? String(+size.toPrecision(2)) : size.toFixed(size < 10 ? 1 : 0);
  return log >= 0 ? `${words} : 1` : `1 : ${words}`;
}
const ago = (age) => fixed(age, age < 10 ? 1 : 0) + " s";
const cell = (kind, ...children) => el("td", { class: kind }, ...children);
const row = (kind, ...cells) => el("tr", { class: kind }, ...cells);
// Of a column's head ">" means numbers, "~" that a narrow screen does without.
const table = (heads, rows) =>
  el("table", {}, heads && el("thead", {}, el("tr", {}, heads.map((h) =>
    el("th", { class: (h.includes(">") ? "n" : "") + (h.includes("~") ? " roomy" : "") }, h.replace(/[>~]/g, ""))))), el("tbody", {}, rows));

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
    const left = is(t.duration) && is(t.elapsed) ? Math.max(t.duration - t.elapsed, 0) : null;
    said.push(el("p", {}, "mode ", el("b", {}, t.mode), `, ${fixed(t.elapsed, 0)} s`, is(left) ? el("b", {}, `, at most ${fixed(left, 0)} s left`) : null,
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

  plan(all) {
    return planView(all) || "nothing to draw yet: no STATE, and no site is told (--config SITE.yaml)";
  },

  vehicle(all) {
    const v = all.vehicle;
    if (!v) return el("span", { class: "soft" }, "no VEHICLE: no thruster driver tells what is behind it");
    const volts = is(v.voltage) ? `, ${fixed(v.voltage, 1)} V` + (is(v.voltage_floor) ? ` (floor ${fixed(v.voltage_floor, 1)} V)` : "") : "";
    const words = [v.kind, v.armed === null ? null : v.armed ? "armed" : "disarmed", v.mode || null, is(v.heartbeat_age) ? `heard ${ago(v.heartbeat_age)} ago` : null];
    return [el("p", {}, words.filter((w) => w).join(", ") + volts, v.failsafe ? el("b", { class: "bad" }, ", FAILSAFE") : null),
      table(null, v.lines.map((l) => row(l.ok ? "" : "sick", cell(l.ok ? "good" : "bad", l.ok ? "ok" : "NOT OK"), cell("k plain", l.name), cell("", l.text)))),
      v.texts.map((one) => el("p", { class: one.severity <= 3 ? "bad" : "warn" }, `“${one.text}”, ${ago(one.age)} ago`))];
  },

  events(all) {
    if (!all.events.length) return el("span", { class: "soft" }, "nothing yet");
    const clock = (age) => (age < 100 ? `${fixed(age, 0)} s` : age < 5940 ? `${fixed(age / 60, 0)} min` : `${fixed(age / 3600, 1)} h`);
    return el("div", { class: "log" }, table(null, all.events.map((one) =>
      row("", cell("n soft", `${clock(one.age)} ago`), cell(one.kind === "go" ? "" : one.kind, one.text)))));
  },

  residual(all) {
    const r = all.residual, m = all.model, kept = all.residuals;
    if (!r) return el("span", { class: "soft" }, "no RESIDUAL: the identifier says it once the model holds");
    const rms = (values) => { const k = values.filter(is); return k.length ? Math.sqrt(k.reduce((sum, x) => sum + x * x, 0) / k.length) : null; };
    return [table(["axis", ">now", ">RMS", "", ">to noise", "~last two minutes"], [..."XYZKMN"].map((name, i) => {
      const ratio = m && is(m.residual_ratio[i]) && m.residual_ratio[i] > 0 ? Math.sqrt(m.residual_ratio[i]) : null;
      return row("", cell("k", name), cell("n", fixed(r.wrench[i], 2)), cell("n", fixed(rms(kept.values[i]), 2)), cell("soft", i < 3 ? "N" : "N m"),
        cell(ratio > 2 ? "n warn" : "n", is(ratio) ? fixed(ratio, 1) : "–"), cell("chart roomy", chart(kept.t, kept.values[i], 1, i < 3 ? 0.5 : 0.05, true)));
    })), el("p", { class: "soft" }, "what the model leaves unexplained; to noise: recent RMS over what noise alone would give")];
  },

  processes(all) {
    if (!all.processes.length) return "nobody says HEALTH on this bus";
    return table(["process", "~host", "health", "~>CPU", "~>memory", "~>dropped", "~>rejected", "says of itself; hears"],
      all.processes.map((p) => {
        const ended = p.state === "stopped";
        const heard = p.channels.filter((c) => c.rate >= 0.5).map((c) => `${c.channel} ${fixed(c.rate, 0)}/s`).join(", ");
        const rare = p.channels.filter((c) => c.rate < 0.5).map((c) => `${c.channel} ${ago(c.age)}`).join(", ");
        const lost = quiet(p).map((c) => `${c.channel} silent for ${ago(c.age)}`).join(", ");
        const words = p.state === "silent" ? p.state : p.age > 2 ? `${p.state}, ${ago(p.age)} ago` : p.state;
        return row(ended ? "soft" : p.healthy ? "" : "sick",
          cell("k", p.name), cell("k plain roomy", p.host, el("span", { class: "soft" }, " " + p.pid)), cell("word", words),
          cell("n roomy", fixed(times(100, p.cpu), 0) + " %"), cell("n roomy", fixed(times(1e-6, p.memory), 0) + " MB"),
          cell(p.dropped ? "n warn roomy" : "n roomy", p.dropped), cell(p.rejected ? "n warn roomy" : "n roomy", p.rejected),
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
    attitude(s.values, all.place),
    table(["", ">", ">± 1σ", "", "last two minutes"], kinds.map(([name, unit, scale, digits, least], i) =>
      row("", cell("k", name), cell("n", fixed(times(scale, s.values[i]), digits)), cell("n soft", fixed(times(scale, s.sigma[i]), digits)), cell("soft", unit),
        cell("chart", chart(all.history.t, all.history.values[i], scale, least)))))];
  },

  model(all) {
    const m = all.model;
    if (!m) return "no MODEL: the identifier has not spoken";
    const line = (p, i) => row(p.frozen ? "soft" : "", cell("k", p.name, p.frozen ? el("div", { class: "soft plain" }, "not learnt now") : null),
      cell("n", short(p.value), el("div", { class: "soft narrow" }, p.unit)), cell("word roomy", p.unit), cell("n", `${short(p.low)} … ${short(p.high)}`),
      cell("n soft roomy", is(p.entangled) ? short(p.entangled) : ""), cell("chart", all.converging.parameters[i] ? convergence(all.converging.t, all.converging.parameters[i]) : null));
    const number = (p) => row("", cell("k", p.name), cell("n", short(p.value)), cell("word", p.unit), cell("n", `${short(p.low)} … ${short(p.high)}`));
    return [el("p", {}, el("b", {}, m.joint ? "joint" : "recursive"), el("span", { class: "soft" }, m.joint ? " estimate, of state and parameters in one filter" : " estimate, from STATE")),
      m.residual_fails_on.length ? el("p", {}, el("b", {}, "this model lacks something"), el("span", { class: "soft" }, `: its residual failed the test on ${m.residual_fails_on.join(", ")}; intervals are wider for it, and may still miss`)) : null,
      table(["parameter", ">value", "~", ">95 %", "~>entangled", "since the beginning"], m.parameters.map(line)),
      is(m.condition) ? el("p", { class: "soft" }, `entangled: times the variance were all others known; condition of the correlations ${short(m.condition)}`) : null,
      el("p", {}, el("b", {}, "adopted: "), m.effects.length ? m.effects.join(", ") : "no effect"),
      m.effect_numbers.length ? table(null, m.effect_numbers.map(number)) : null];
  },

  thrusters(all) {
    const t = all.thrusters, asked = all.asked && all.asked.age < kOld ? all.asked.tau : null;
    if (!t) return "no THRUSTERS: the thruster driver has not spoken";
    const size = (values) => Math.max(1, ...(values || []).filter(is).map(Math.abs));
    sections.most = Math.max(sections.most || 1, size(t.force));
    const volts = all.battery ? [el("b", {}, fixed(all.battery.voltage, 1) + " V"), all.battery.age > kOld ? el("span", { class: "bad" }, ` ${ago(all.battery.age)} ago`) : null] : "voltage not told";
    const forces = t.force.length ? table(["thruster", ">applied", "", `± ${fixed(sections.most, 0)} N`], t.force.map((f, i) =>
      row("", cell("k", all.place.thrusters.length === t.force.length ? all.place.thrusters[i] : `${i + 1}`), cell("n", fixed(f, 2)), cell("soft", "N"), cell("wide", bar(f, sections.most, true))))) : el("p", { class: "soft" }, "forces not told");
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
    const sorted = [...e.candidates].sort((a, b) => (b.log_odds || 0) - (a.log_odds || 0)).slice(0, 8);
    said.push(e.candidates.length ? table(["candidate", ">odds", "~>log odds", "", ">explains"], sorted.map((c) =>
      row("", cell("k", c.name, c.variant ? el("span", { class: "soft" }, " " + c.variant) : null), cell("n", odds(c.log_odds)), cell("n soft roomy", fixed(c.log_odds, 1)),
        cell("wide", bar(c.log_odds, most, true)), cell("n", fixed(times(100, c.error_reduction), 0) + " %")))) : el("p", { class: "soft" }, "no candidate yet"));
    const l = all.learned;
    if (l) said.push(el("p", { class: l.adopted ? "" : "soft" }, el("b", {}, l.adopted ? "learned: " : "not learned: "), l.words));
    if (l && l.equation) said.push(el("p", {}, l.equation));
    return said;
  },
};

const source = { plan: "state", vehicle: "vehicle", residual: "residual", trial: "trial", state: "state", model: "model", thrusters: "thrusters", effects: "effects" };
const slow = { model: 4, effects: 10, residual: 4 };  // times as long: they are said more rarely

function draw(all) {
  const silent = all.heard === null || all.heard > all.silence;
  const calm = all.standing.over || all.standing.calm || all.replay !== null;
  for (const name of kLeft.concat(kRight)) {
    const heard = all[source[name]], age = heard && is(heard.age) ? heard.age : null;
    const old = age !== null && (silent || age > kOld * (slow[name] || 1));
    byId(name).className = old ? (calm ? "old over" : "old") : "";
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
  const replay = all.replay;
  byId("bus").textContent = replay ? `replay of ${all.bus}: ${fixed(replay.at, 0)} of ${fixed(replay.length, 0)} s${replay.over ? ", ended" : ""}` : all.bus;
  byId("abort").hidden = replay !== null;
  // Armed again since: what became of the abort stands among the events.
  told(all.abort && all.abort.state === "confirmed" && all.abort.age > 3 && all.trial && all.trial.armed ? null : all.abort);
  byId("heard").textContent = silent ? "" : `heard ${ago(all.heard)} ago`;
  byId("alarm").hidden = !(stands.alarm || stands.remark);
  byId("alarm").className = stands.alarm ? "" : "calm";
  byId("alarm").textContent = stands.alarm || stands.remark;
}

/** What became of an abort; `refused` by the board itself where it never asked. */
function told(abort, refused) {
  const box = byId("aborted");
  if (refused) box.dataset.refused = refused;
  const mine = box.dataset.refused;
  box.hidden = !mine && !(abort && abort.age < 120);
  if (box.hidden) return;
  box.className = mine ? "bad" : { confirmed: "good", asked: "warn" }[abort.state] || "bad";
  box.textContent = mine || (abort.state === "asked" ? "abort: asked, waiting for the thrusters …" : `${abort.text} (${ago(abort.age)} ago)`);
}

async function pressAbort() {
  delete byId("aborted").dataset.refused;
  try {
    const answer = await fetch("abort", { method: "POST", headers: { "X-Fathom": "abort" }, signal: AbortSignal.timeout(kPatience) });
    if (!answer.ok) told(null, `NOT ABORTED: ${(await answer.text()).trim()}`);
  } catch (error) {
    told(null, `NOT ABORTED: the board does not answer (${error.message}). By hand: fathom abort, or the vehicle's kill switch`);
  }
}

let number = null, moved = performance.now();

/** The veil's clock begins anew; it falls by itself when this is not called any more. */
function alive() {
  moved = performance.now();
  const veil = byId("veil");
  veil.replaceWith(veil.cloneNode(true));
}

let timer = null;  // of the next question

async function ask() {
  clearTimeout(timer);
  timer = null;
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
  timer = setTimeout(ask, kPeriod);
}

// Two columns of sections, each as tight as it can be; below one another on a narrow screen.
for (const names of [kLeft, kRight]) {
  document.querySelector("main").append(el("div", {}, names.map(byId)));
}
byId("abort").addEventListener("click", pressAbort);
// A browser asks rarely for a page that nobody sees: once it is looked at again, it shall be of now.
document.addEventListener("visibilitychange", () => { if (!document.hidden && timer !== null) ask(); });
ask();
