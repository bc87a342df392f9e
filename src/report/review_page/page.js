"use strict";
// The decisions, the most doubtful first; what the reviewer says of each is kept in `words`.
const data = JSON.parse(document.getElementById("data").textContent);
const steps = data.steps;
const by = (id) => document.getElementById(id);
const SVG = "http://www.w3.org/2000/svg";
const store = "tauscope review " + data.name + " " + steps.map((s) => s.p).join(" ").length + " " + data.decisions;
const key = (s) => [s.joint, s.trial, s.i, s.p].join("\u0000");
let at = 0;
let words = {};
let unsaved = false;

for (const s of steps) {
  if (s.verdict) words[key(s)] = { verdict: s.verdict, delay_s: s.delay_s, note: s.note, reviewer: s.reviewer };
}
// Words that were said in this browser and not saved yet come back.
try {
  const kept = JSON.parse(localStorage.getItem(store) || "{}");
  if (kept.words) { words = Object.assign(words, kept.words); unsaved = true; }
  by("reviewer").value = kept.reviewer || "";
} catch (_) { /* a browser that keeps nothing for files */ }

function keep() {
  unsaved = true;
  try { localStorage.setItem(store, JSON.stringify({ words, reviewer: by("reviewer").value })); } catch (_) { /* as above */ }
}

function number(x) {
  if (x === null || x === undefined) return "";
  const text = Number(x).toPrecision(5);
  return String(Number(text));
}

// The line of least squares through the samples from..to of `values`, of which the first has
// the number `first`: [slope, intercept, squared error].
function line(values, first, from, to) {
  let n = 0, x = 0, y = 0;
  for (let k = from; k <= to; k++) { n += 1; x += k; y += values[k - first]; }
  if (n < 2) return [0, n ? y / n : 0, 0];
  const mx = x / n, my = y / n;
  let xx = 0, xy = 0, yy = 0;
  for (let k = from; k <= to; k++) {
    const dx = k - mx, dy = values[k - first] - my;
    xx += dx * dx; xy += dx * dy; yy += dy * dy;
  }
  const slope = xy / xx;
  return [slope, my - slope * mx, Math.max(yy - slope * xy, 0)];
}

const isNumber = (x) => x !== null && x !== undefined && x !== "";
const samples = (n) => `${number(n)} ${Number(n) === 1 ? "sample" : "samples"}`;
const fitted = (s) => (s.smoothed.length ? s.smoothed : s.measured);
const programQ = (s) => (s.program_delay_s === null ? null : s.p + s.program_delay_s / s.period_s);
function chosenQ(s) {
  const word = words[key(s)];
  if (word && isNumber(word.delay_s)) return s.p + word.delay_s / s.period_s;
  return programQ(s);
}

function pair(s, q) {
  if (q === null) return null;
  const r = s.segment[0], end = s.fitted_to;
  const middle = Math.min(Math.max(Math.round(q), r + 2), end - 1);
  const before = line(fitted(s), s.first, r, middle - 1), after = line(fitted(s), s.first, middle, end);
  return { q, middle, before, after, sse: before[2] + after[2] };
}

function ticks(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * power).find((m) => m >= rough) || rough;
  const found = [];
  for (let t = Math.ceil(low / step) * step; t <= high + step * 1e-9; t += step) found.push(Number(t.toPrecision(12)));
  return found;
}

function range(values) {
  let low = Infinity, high = -Infinity;
  for (const v of values) { if (v < low) low = v; if (v > high) high = v; }
  if (!(high > low)) { low -= 1; high += 1; }
  const room = 0.06 * (high - low);
  return [low - room, high + room];
}

let scale = null;
function draw() {
  const s = steps[at], svg = by("plot");
  const { width, height } = svg.getBoundingClientRect();
  const w = Math.max(width, 300), h = Math.max(height, 220), left = 64, right = w - 10;
  svg.setAttribute("viewBox", `0 0 ${w} ${h}`);
  svg.querySelectorAll(":scope > g").forEach((g) => g.remove());
  const g = svg.appendChild(document.createElementNS(SVG, "g"));
  const put = (name, attributes, text) => {
    const node = g.appendChild(document.createElementNS(SVG, name));
    for (const [a, v] of Object.entries(attributes)) node.setAttribute(a, v);
    if (text !== undefined) node.textContent = text;
  };
  const last = s.first + s.measured.length - 1;
  const X = (k) => left + ((k - s.first) / Math.max(last - s.first, 1)) * (right - left);
  scale = { left, right, first: s.first, last, w };
  const panel = (top, bottom, [low, high], name, count, label) => {
    const Y = (v) => bottom - ((v - low) / (high - low)) * (bottom - top);
    put("rect", { x: left, y: top, width: right - left, height: bottom - top, class: "rule" });
    for (const t of ticks(low, high, count)) {
      put("line", { x1: left, x2: right, y1: Y(t), y2: Y(t), class: "rule" });
      put("text", { x: left - 5, y: Y(t) + 4, "text-anchor": "end", class: "faint" }, label ? label(t) : number(t));
    }
    put("text", { x: left + 4, y: top - 4 }, name);
    return (v) => Math.min(Math.max(Y(v), top - 2), bottom + 2);
  };
  const path = (points, color, width, dash) => put("path", { d: points.length ? "M" + points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L") : "", fill: "none", stroke: `var(--${color})`, "stroke-width": width, "stroke-dasharray": dash || "none" });
  const unit = s.output_unit ? ` [${s.output_unit}]` : "";
  const rows = [[18, h * 0.6], [h * 0.6 + 20, h * 0.77], [h * 0.77 + 20, h - 20]];
  const Y = panel(...rows[0], range([...s.measured, ...s.smoothed]), "output" + unit, 5);
  const program = pair(s, programQ(s)), mine = pair(s, chosenQ(s));
  const moved = mine && program && Math.abs(mine.q - program.q) > 1e-6;
  s.measured.forEach((v, k) => put("circle", { cx: X(s.first + k).toFixed(1), cy: Y(v).toFixed(1), r: 1.3, fill: "var(--raw)" }));
  path(s.smoothed.map((v, k) => [X(s.first + k), Y(v)]), "smooth", 1.4);
  for (const k of s.segment) path([[X(k), rows[0][0]], [X(k), rows[0][1]]], "faint", 1, "2 3");
  path([[X(s.p), rows[0][0]], [X(s.p), rows[2][1]]], "step", 1.6);
  const verdict = s.program_verdict === "accepted" ? "good" : "bad";
  const lines = (found, color) => {
    const at = ([slope, intercept], k) => [X(k), Y(intercept + slope * k)];
    path([at(found.before, s.segment[0]), at(found.before, found.q)], color, 2.2);
    path([at(found.after, found.q), at(found.after, s.segment[1])], color, 2.2);
    path([[X(found.q), rows[0][0]], [X(found.q), rows[2][1]]], color, 1.6);
  };
  if (program) lines(program, verdict);
  if (moved) lines(mine, "mine");
  const seen = mine || program;
  // Each name on its own side of two lines that may be near.
  const isBefore = !!seen && seen.q < s.p;
  const name = (k, text, isLeft) => put("text", { x: X(k) + (isLeft ? -5 : 5), y: rows[0][1] - 6, "text-anchor": isLeft ? "end" : "start" }, text);
  name(s.p, "input step", !isBefore);
  if (seen) name(seen.q, "breakpoint", isBefore);
  if (seen) {
    const left = [];
    for (let k = s.segment[0]; k <= s.segment[1]; k++) {
      const [slope, intercept] = k < seen.middle ? seen.before : seen.after;
      left.push([k, fitted(s)[k - s.first] - intercept - slope * k]);
    }
    const R = panel(...rows[1], range([0, ...left.map(([, v]) => v)]), "residual of both lines" + unit, 2);
    path([[X(s.first), R(0)], [X(last), R(0)]], "faint", 1);
    path(left.filter(([k]) => k < seen.middle).map(([k, v]) => [X(k), R(v)]), "smooth", 1.3);
    path(left.filter(([k]) => k >= seen.middle).map(([k, v]) => [X(k), R(v)]), "smooth", 1.3);
  }
  if (s.errors.length) {
    const most = Math.max(...s.errors.map(([, e]) => e), Number.MIN_VALUE);
    const log = (e) => Math.log10(Math.max(e, most * 1e-9));
    const E = panel(...rows[2], range(s.errors.map(([, e]) => log(e))), "squared error of each candidate (log)", 3, (t) => number(10 ** t));
    path(s.errors.map(([q, e]) => [X(q), E(log(e))]), "error", 1.6);
  }
  for (const k of ticks(s.first, last, 8)) put("text", { x: X(k), y: h - 5, "text-anchor": "middle", class: "faint" }, k);
  put("text", { x: left - 8, y: h - 5, "text-anchor": "end", class: "faint" }, "sample");
  by("plot-title").textContent = `Step ${s.i} of ${s.joint}`;
  by("plot-desc").textContent = `Output around the input step at sample ${s.p}, with the lines before and after the breakpoint` + (mine ? ` at sample ${number(mine.q)}.` : ".");
  const shown = moved ? mine : program;
  by("break").textContent = shown ? `${moved ? "your breakpoint" : "breakpoint"} q = ${number(shown.q)}: delay ${number((shown.q - s.p) * s.period_s)} s = ${samples(shown.q - s.p)}, squared error ${number(shown.sse)}` + (moved ? ` (the program: ${number(program.q)}, ${number(program.sse)})` : "") : "no breakpoint was found; click into the output to set one";
}

function show() {
  const s = steps[at], word = words[key(s)];
  by("step").textContent = `${s.joint}, trial ${s.trial}, step ${s.i}: input ${number(s.input[0])} → ${number(s.input[1])}${s.input_unit ? " " + s.input_unit : ""} at sample ${s.p}, held ${number(s.hold * s.period_s)} s`;
  const program = s.program_verdict === "accepted" ? `✓ accepted: delay ${number(s.program_delay_s)} s` : `✗ rejected: ${s.program_verdict}`;
  const verdict = by("verdict");
  verdict.textContent = word ? `You: ${word.verdict === "accepted" ? "✓ accepted" : "✗ rejected"}${isNumber(word.delay_s) ? ", " + number(word.delay_s) + " s" : ""} · the program: ${program}` : `The program: ${program}`;
  verdict.className = (word ? word.verdict : s.program_verdict) === "accepted" ? "good" : "bad";
  by("doubt").textContent = `doubt ${Math.round(100 * s.doubt)} % (${at + 1} of ${steps.length}): ${s.why}`;
  by("accept").setAttribute("aria-pressed", String(!!word && word.verdict === "accepted"));
  by("reject").setAttribute("aria-pressed", String(!!word && word.verdict === "rejected"));
  by("note").value = word ? word.note || "" : "";
  const body = by("conditions");
  body.replaceChildren(...s.conditions.map((c) => {
    const row = document.createElement("tr");
    row.title = c.met === false ? c.meaning : c.asks;
    const mark = c.met === null ? "–" : c.met ? "✓" : "✗";
    for (const text of [mark, c.id, number(c.value), number(c.limit)]) {
      row.appendChild(document.createElement("td")).textContent = text;
    }
    row.children[1].appendChild(document.createElement("small")).textContent = c.asks;
    row.className = c.met === false ? "bad" : "";
    return row;
  }));
  const said = steps.filter((s) => words[key(s)]).length;
  const less = data.decisions > steps.length ? ` (the ${steps.length} most doubtful of ${data.decisions})` : "";
  by("progress").textContent = `decision ${at + 1} of ${steps.length}${less}, the most doubtful first; a word on ${said}${unsaved ? "; not saved yet" : ""}`;
  const list = by("list");
  [...list.children].forEach((item, index) => {
    const button = item.firstChild, of = steps[index], word = words[key(of)];
    button.setAttribute("aria-current", String(index === at));
    button.textContent = `${Math.round(100 * of.doubt)} % ${of.joint} ${of.trial}/${of.i} ${of.program_verdict === "accepted" ? "✓" : "✗"}${word ? " → " + (word.verdict === "accepted" ? "✓" : "✗") : ""} ${word && isNumber(word.delay_s) ? number(word.delay_s) + " s" : of.program_verdict === "accepted" ? number(of.program_delay_s) + " s" : of.program_verdict}`;
  });
  const current = list.children[at];
  if (current) keepInView(list, current);
  draw();
}

// In the list alone: the page itself would scroll away from the verdict.
function keepInView(list, item) {
  const top = item.offsetTop - list.offsetTop, bottom = top + item.offsetHeight;
  if (top < list.scrollTop) list.scrollTop = top;
  else if (bottom > list.scrollTop + list.clientHeight) list.scrollTop = bottom - list.clientHeight;
}

function go(index) {
  if (!steps.length) return;
  at = Math.min(Math.max(index, 0), steps.length - 1);
  show();
}

function say(verdict) {
  const s = steps[at], before = words[key(s)];
  words[key(s)] = { verdict, delay_s: before ? before.delay_s : null, note: by("note").value, reviewer: by("reviewer").value };
  keep();
  show();
}

// A breakpoint of the reviewer's own, not before the input step: it is accepted with this delay.
function place(q) {
  const s = steps[at], [r, end] = s.segment;
  const kept = Math.min(Math.max(Math.round(q), r + 2, s.p), end - 1);
  words[key(s)] = Object.assign({ note: by("note").value, reviewer: by("reviewer").value }, words[key(s)], { verdict: "accepted", delay_s: Number(((kept - s.p) * s.period_s).toFixed(9)) });
  keep();
  show();
}

function shift(samples) {
  const q = chosenQ(steps[at]);
  place((q === null ? steps[at].p : Math.round(q)) + samples);
}

function forget() {
  delete words[key(steps[at])];
  keep();
  show();
}

function reset() {
  const word = words[key(steps[at])];
  if (word) { word.delay_s = null; keep(); show(); }
}

function cell(value) {
  const text = value === null || value === undefined ? "" : String(value);
  return /[",\r\n;]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
}

function csv() {
  const columns = ["joint", "trial", "i", "verdict", "delay_s", "note", "reviewer", "p", "program_verdict", "program_delay_s", "doubt", "why"];
  const rows = steps.filter((s) => words[key(s)]).map((s) => Object.assign({}, s, words[key(s)]));
  return [columns, ...rows.map((row) => columns.map((name) => row[name]))].map((row) => row.map(cell).join(",")).join("\n") + "\n";
}

function save() {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([csv()], { type: "text/csv" }));
  link.download = data.name.replace(/[^\w.-]+/g, "_") + "_review.csv";
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  unsaved = false;
  show();
}

const KEYS = [
  ["ArrowRight", "→ ←", "next and previous decision", () => go(at + 1)],
  ["ArrowLeft", "", "", () => go(at - 1)],
  ["Home", "Home End", "most and least doubtful one", () => go(0)],
  ["End", "", "", () => go(steps.length - 1)],
  ["o", "o", "next without a word", () => go(Math.max(steps.findIndex((s, k) => k > at && !words[key(s)]), at))],
  ["a", "a", "accept", () => say("accepted")],
  ["r", "r", "reject", () => say("rejected")],
  ["u", "u", "take the word back", forget],
  ["[", "[ ]", "breakpoint a sample earlier, later (with a mouse: click or drag in the plot)", () => shift(-1)],
  ["]", "", "", () => shift(1)],
  ["{", "{ }", "ten samples", () => shift(-10)],
  ["}", "", "", () => shift(10)],
  ["d", "d", "the program's breakpoint", reset],
  ["n", "n", "write a note; Esc leaves it", () => by("note").focus()],
  ["s", "s", "save the review", save],
  ["?", "?", "these keys", () => by("help").click()],
];
by("keys").textContent = KEYS.filter(([, shown]) => shown).map(([, shown, what]) => `${shown}: ${what}`).join(" · ");

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const field = event.target.matches("input, textarea");
  if (event.key === "Escape") { event.target.blur(); return; }
  if (field || !steps.length) return;
  const found = KEYS.find(([name]) => name === event.key);
  if (found) { event.preventDefault(); found[3](); }
});

by("note").addEventListener("input", () => {
  const s = steps[at], said = s.program_verdict === "accepted" ? "accepted" : "rejected";
  const word = words[key(s)] || { verdict: said, delay_s: null, reviewer: by("reviewer").value };
  words[key(s)] = Object.assign(word, { note: by("note").value });
  keep();
});
by("note").addEventListener("blur", () => { if (steps.length) show(); });
by("reviewer").addEventListener("input", () => {
  for (const word of Object.values(words)) word.reviewer = word.reviewer || by("reviewer").value;
  keep();
});
by("accept").addEventListener("click", () => say("accepted"));
by("reject").addEventListener("click", () => say("rejected"));
by("clear").addEventListener("click", forget);
by("previous").addEventListener("click", () => go(at - 1));
by("next").addEventListener("click", () => go(at + 1));
by("open").addEventListener("click", () => KEYS.find(([name]) => name === "o")[3]());
by("save").addEventListener("click", save);
by("help").addEventListener("click", () => {
  const keys = by("keys");
  keys.hidden = !keys.hidden;
  by("help").setAttribute("aria-expanded", String(!keys.hidden));
  draw();
});

let held = false;
function pointed(event) {
  const box = by("plot").getBoundingClientRect();
  const x = ((event.clientX - box.left) * scale.w) / box.width;
  place(scale.first + ((x - scale.left) / (scale.right - scale.left)) * (scale.last - scale.first));
}
by("plot").addEventListener("pointerdown", (event) => {
  if (!steps.length || event.button !== 0) return;
  held = true;
  by("plot").setPointerCapture(event.pointerId);
  pointed(event);
});
by("plot").addEventListener("pointermove", (event) => { if (held) pointed(event); });
by("plot").addEventListener("pointerup", () => { held = false; });
window.addEventListener("resize", draw);
window.addEventListener("beforeunload", (event) => { if (unsaved && Object.keys(words).length) event.preventDefault(); });

by("title").textContent = document.title;
by("list").replaceChildren(...steps.map((_, index) => {
  const item = document.createElement("li"), button = item.appendChild(document.createElement("button"));
  button.type = "button";
  button.tabIndex = -1;
  button.addEventListener("click", () => go(index));
  return item;
}));
if (steps.length) show(); else by("progress").textContent = "there is no decision in this log";
