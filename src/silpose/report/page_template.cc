#include "silpose/report/page_template.h"

namespace silpose {

const std::string_view kPageTemplate = R"PAGE(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>@TITLE@ - silpose</title>
<style>
:root { --page: #f6f6f3; --card: #ffffff; --ink: #1d1f23; --soft: #666b73; --line: #dcdcd6; --grid: #ecece6;
        --curve: #1f5fae; --band: #1f5fae26; --limit: #c2571a; --coast: #8882; --good: #2e7d4f; --warn: #fff4dc; }
@media (prefers-color-scheme: dark) {
  :root { --page: #16181b; --card: #1f2226; --ink: #e8e8e4; --soft: #9aa0a8; --line: #34383e; --grid: #2a2e33;
          --curve: #74aef2; --band: #74aef230; --limit: #e8935a; --coast: #fff2; --good: #6cc795; --warn: #3a3220; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1180px; padding: 24px 20px 60px; background: var(--page); color: var(--ink);
       font: 15px/1.45 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { font-size: 24px; margin: 0 0 2px; overflow-wrap: anywhere; }
h2 { font-size: 17px; margin: 30px 0 10px; }
p.lead { color: var(--soft); margin: 0 0 18px; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 10px; }
.tile, .card { background: var(--card); border: 1px solid var(--line); border-radius: 8px; }
.tile { padding: 10px 14px; }
.tile b { display: block; font-size: 20px; white-space: nowrap; font-variant-numeric: tabular-nums; }
.tile span { color: var(--soft); font-size: 13px; line-height: 1.3; display: block; }
.warnings { background: var(--warn); border: 1px solid var(--line); border-radius: 8px; padding: 10px 14px 10px 32px;
            margin: 14px 0 0; }
.two { display: grid; grid-template-columns: minmax(0, 3fr) minmax(0, 2fr); gap: 14px; align-items: start; }
@media (max-width: 820px) { .two { grid-template-columns: minmax(0, 1fr); } }
video { width: 100%; max-height: 560px; background: #000; border-radius: 8px; display: block; }
.stack { display: grid; gap: 10px; }
.card { padding: 8px 10px 4px; }
.card header { display: flex; justify-content: space-between; gap: 8px; font-size: 13px; }
.card header span { color: var(--soft); font-variant-numeric: tabular-nums; }
canvas { width: 100%; height: 130px; display: block; cursor: crosshair; }
.curves { display: grid; grid-template-columns: repeat(auto-fill, minmax(340px, 1fr)); gap: 10px; }
nav { display: flex; flex-wrap: wrap; gap: 6px; margin-bottom: 10px; align-items: center; }
nav button, nav select { font: inherit; font-size: 14px; padding: 4px 12px; border-radius: 16px; color: var(--ink);
                         border: 1px solid var(--line); background: var(--card); cursor: pointer; }
nav button[aria-pressed=true] { background: var(--curve); border-color: var(--curve); color: var(--card); }
.key { color: var(--soft); font-size: 13px; margin: 6px 0 0; }
.key i { display: inline-block; width: 22px; height: 9px; margin: 0 5px 0 12px; }
.key i:first-child { margin-left: 0; }
table { border-collapse: collapse; width: 100%; }
td { padding: 4px 8px; border-bottom: 1px solid var(--line); vertical-align: middle; overflow-wrap: anywhere; }
td:first-child { color: var(--soft); width: 34%; overflow-wrap: normal; }
td.number { text-align: right; font-variant-numeric: tabular-nums; width: 6em; }
.bar { height: 11px; background: var(--curve); border-radius: 3px; min-width: 1px; }
</style>
</head>
<body>
<h1>@TITLE@</h1>
<p class="lead" id="lead"></p>
<div class="tiles" id="tiles"></div>
<ul class="warnings" id="warnings" hidden></ul>

<h2>The clip, and how well the body explains it</h2>
<div class="two">
  <div><video id="video" controls muted loop playsinline preload="auto" src="@VIDEO@"></video>
  <p class="key">Outline of the tracked body and its skeleton over the picture. Click a curve to go to that
  frame.</p></div>
  <div class="stack" id="quality"></div>
</div>

<h2>Joint angles</h2>
<nav id="parts" aria-label="Part of the body"></nav>
<div class="curves" id="curves"></div>
<p class="key"><i style="background:var(--curve);height:2px;vertical-align:middle"></i>estimate
<i style="background:var(--band)"></i>&plusmn; one standard deviation
<i style="border-top:2px dashed var(--limit);height:0;vertical-align:middle"></i>limit of the joint
<i style="background:var(--coast)"></i>no usable silhouette: predicted only</p>

<div class="two">
  <div><h2>The run</h2><div class="card"><table id="facts"></table></div></div>
  <div><h2>Where the time went</h2><div class="card"><table id="stages"></table></div></div>
</div>

<script type="application/json" id="data">@DATA@</script>
<script>
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const video = document.getElementById("video");
const count = data.frame.length;
const charts = [];
let cursor = Math.max(0, data.state.findIndex(state => state !== "waiting"));

function element(name, parent, text, className) {
  const node = document.createElement(name);
  if (text !== undefined) node.textContent = text;
  if (className) node.className = className;
  if (parent) parent.append(node);
  return node;
}
const colour = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const known = values => values.filter(value => value !== null);
const mean = values => values.length ? values.reduce((a, b) => a + b, 0) / values.length : NaN;
const deviation = values => { const m = mean(values); return Math.sqrt(mean(values.map(v => (v - m) ** 2))); };
const digits = (value, places) => Number.isFinite(value) ? value.toFixed(places) : "-";

// Round tick positions: 1, 2 or 5 times a power of ten, at most `most` of them.
function ticks(low, high, most) {
  const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(f => f * power).find(s => s >= raw * 0.999);
  const result = [];
  for (let t = Math.ceil(low / step) * step; t <= high + step * 1e-9; t += step) result.push(t);
  return {values: result, places: Math.max(0, -Math.floor(Math.log10(step) + 1e-9))};
}

// A curve over time with its band. options: title, unit, values, sd, limits, range, places.
function addChart(parent, options) {
  const card = element("div", parent, undefined, "card");
  const header = element("header", card);
  element("b", header, options.title);
  const reading = element("span", header);
  const canvas = element("canvas", card);
  const seen = known(options.values);
  let low = Infinity, high = -Infinity;
  options.values.forEach((value, i) => {
    if (value === null) return;
    const sd = options.sd ? options.sd[i] || 0 : 0;
    low = Math.min(low, value - sd); high = Math.max(high, value + sd);
  });
  if (options.range) [low, high] = options.range;
  if (!seen.length && !options.range) { low = 0; high = 1; }
  const least = options.least || 0;
  if (high - low < least) { const middle = (low + high) / 2; low = middle - least / 2; high = middle + least / 2; }
  if (!options.range) { const room = (high - low) * 0.06; low -= room; high += room; }
  const chart = {options, canvas, reading, low, high};
  canvas.addEventListener("click", event => {
    const box = canvas.getBoundingClientRect(), left = 44, width = box.width - left - 8;
    const at = Math.round((event.clientX - box.left - left) / width * Math.max(1, count - 1));
    setCursor(Math.min(count - 1, Math.max(0, at)), true);
  });
  charts.push(chart);
  return chart;
}

function draw(chart) {
  const {canvas, options, low, high} = chart;
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (!width) return;
  canvas.width = width * ratio; canvas.height = height * ratio;
  const g = canvas.getContext("2d");
  g.scale(ratio, ratio);
  const left = 44, right = width - 8, top = 6, bottom = height - 20;
  const x = i => left + (right - left) * (count > 1 ? i / (count - 1) : 0.5);
  const y = value => bottom - (bottom - top) * (value - low) / (high - low);
  g.font = "11px system-ui, sans-serif";
  g.lineWidth = 1;
  const vertical = ticks(low, high, 6);
  g.textAlign = "right"; g.textBaseline = "middle";
  for (const value of vertical.values) {
    g.strokeStyle = colour("--grid"); g.beginPath(); g.moveTo(left, y(value)); g.lineTo(right, y(value)); g.stroke();
    g.fillStyle = colour("--soft"); g.fillText(value.toFixed(vertical.places), left - 6, y(value));
  }
  g.textAlign = "center"; g.textBaseline = "top";
  if (count > 1) {
    const first = data.time[0], last = data.time[count - 1];
    const horizontal = ticks(first, last, Math.max(2, Math.floor(width / 90)));
    for (const time of horizontal.values) {
      const at = left + (right - left) * (time - first) / (last - first);
      g.textAlign = at > right - 16 ? "right" : "center";
      g.fillText(time.toFixed(horizontal.places) + " s", Math.min(at, right + 6), bottom + 5);
    }
  }
  g.save();
  g.beginPath(); g.rect(left, top, right - left, bottom - top); g.clip();
  const half = count > 1 ? (right - left) / (count - 1) / 2 : 4;
  g.fillStyle = colour("--coast");
  data.state.forEach((state, i) => {
    if (state === "coasted" || state === "waiting") g.fillRect(x(i) - half, top, 2 * half, bottom - top);
  });
  if (options.sd) {  // the band, one strip between neighbouring frames
    g.fillStyle = colour("--band");
    for (let i = 1; i < count; ++i) {
      if (options.values[i] === null || options.values[i - 1] === null) continue;
      const a = options.values[i - 1], b = options.values[i], da = options.sd[i - 1] || 0, db = options.sd[i] || 0;
      g.beginPath(); g.moveTo(x(i - 1), y(a + da)); g.lineTo(x(i), y(b + db)); g.lineTo(x(i), y(b - db));
      g.lineTo(x(i - 1), y(a - da)); g.fill();
    }
  }
  if (options.limits) {
    g.strokeStyle = colour("--limit"); g.setLineDash([5, 4]);
    for (const limit of options.limits) {
      g.beginPath(); g.moveTo(left, y(limit)); g.lineTo(right, y(limit)); g.stroke();
    }
    g.setLineDash([]);
  }
  g.strokeStyle = colour("--curve"); g.lineWidth = 1.6; g.lineJoin = "round"; g.beginPath();
  let pen = false;
  options.values.forEach((value, i) => {
    if (value === null) { pen = false; return; }
    if (pen) g.lineTo(x(i), y(value)); else { g.moveTo(x(i), y(value)); g.lineTo(x(i) + 0.5, y(value)); }
    pen = true;
  });
  g.stroke();
  g.strokeStyle = colour("--ink"); g.lineWidth = 1; g.globalAlpha = 0.6;
  g.beginPath(); g.moveTo(x(cursor), top); g.lineTo(x(cursor), bottom); g.stroke();
  g.restore();
  const value = options.values[cursor], sd = options.sd ? options.sd[cursor] : null;
  chart.reading.textContent = value === null || value === undefined ? "-" : value.toFixed(options.places) +
      (sd === null ? "" : " \u00b1 " + sd.toFixed(options.places)) + (options.unit ? " " + options.unit : "");
}

function setCursor(frame, seek) {
  cursor = frame;
  if (seek && Number.isFinite(video.duration)) video.currentTime = Math.min((frame + 0.5) / data.fps, video.duration);
  charts.forEach(draw);
}
function follow() {
  const at = Math.min(count - 1, Math.floor(video.currentTime * data.fps + 1e-6));
  if (at !== cursor && at >= 0) setCursor(at, false);
  if (!video.paused) requestAnimationFrame(follow);
}
video.addEventListener("play", follow);
video.addEventListener("seeked", follow);
if (!video.getAttribute("src")) video.hidden = true;

// The head of the page.
const accuracy = known(data.accuracy);
// Of one hypothesis, and of a smoothed clip, the size is 1 throughout and tells nothing.
const largestSize = Math.max(1, ...known(data.n_eff)), manyStates = largestSize > 1;
const sizePlaces = largestSize < 100 ? 1 : 0;
const counts = {tracked: 0, coasted: 0, waiting: 0, initialised: 0};
data.state.forEach(state => ++counts[state]);
const tracked = counts.tracked + counts.initialised;
document.getElementById("lead").textContent = count
    ? `Frames ${data.frame[0]} to ${data.frame[count - 1]}, ` +
      `${digits(data.time[0], 2)} s to ${digits(data.time[count - 1], 2)} s`
    : "No frame";
const tiles = document.getElementById("tiles");
const agreement = accuracy.length ? digits(mean(accuracy), 3) + " \u00b1 " + digits(deviation(accuracy), 3) : "-";
for (const [value, label] of [[count, "frames"], [tracked, "tracked"],
    [counts.coasted, "coasted (no usable silhouette)"], [counts.waiting, "waiting for a person"],
    [agreement, "visual accuracy (IoU)"],
    ...(manyStates ? [[digits(mean(known(data.n_eff)), sizePlaces), "effective sample size, mean"]] : [])]) {
  const tile = element("div", tiles, undefined, "tile");
  element("b", tile, value); element("span", tile, label);
}
const warnings = document.getElementById("warnings");
data.warnings.forEach(warning => element("li", warnings, warning));
warnings.hidden = !data.warnings.length;

const quality = document.getElementById("quality");
addChart(quality, {title: "Visual accuracy", values: data.accuracy, range: [0, 1], places: 3});
if (manyStates) {
  addChart(quality, {title: "Effective sample size", values: data.n_eff, places: sizePlaces,
                     range: [0, largestSize * 1.05]});
}
const rotational = data.dofs.filter(dof => dof.unit !== "m");
addChart(quality, {title: "Mean spread of the angles", unit: "\u00b0", places: 2, least: 1,
  values: data.frame.map((_, i) => {
    const sds = known(rotational.map(dof => dof.sd[i]));
    return sds.length ? mean(sds) : null;
  })});
const fixedCharts = charts.length;

// The curves of one part of the body at a time.
const parts = [...new Set(data.dofs.map(dof => dof.part))];
const nav = document.getElementById("parts"), curves = document.getElementById("curves");
function show(choice) {
  charts.length = fixedCharts;
  curves.replaceChildren();
  for (const dof of data.dofs.filter(d => choice === "All" || d.part === choice || d.name === choice)) {
    addChart(curves, {title: dof.name, unit: dof.unit, values: dof.values, sd: dof.sd, limits: dof.limits,
                      places: dof.unit === "m" ? 3 : 1, least: dof.unit === "m" ? 0.1 : 10});
  }
  nav.querySelectorAll("button").forEach(button => button.setAttribute("aria-pressed", button.textContent === choice));
  charts.forEach(draw);
}
for (const part of [...parts, "All"]) element("button", nav, part).addEventListener("click", () => show(part));
const select = element("select", nav);
select.setAttribute("aria-label", "One degree of freedom");
element("option", select, "One curve\u2026").value = "";
data.dofs.forEach(dof => element("option", select, dof.name));
select.addEventListener("change", () => { if (select.value) show(select.value); });

const facts = document.getElementById("facts");
for (const [name, text] of data.facts) {
  const row = element("tr", facts);
  element("td", row, name); element("td", row, text);
}
const stages = document.getElementById("stages"), longest = Math.max(1e-9, ...data.stages.map(stage => stage[1]));
for (const [name, seconds] of data.stages) {
  const row = element("tr", stages);
  element("td", row, name);
  element("div", element("td", row), undefined, "bar").style.width = 100 * seconds / longest + "%";
  element("td", row, seconds.toFixed(2) + " s", "number");
}
show(parts.includes("Right leg") ? "Right leg" : parts[0] || "All");
window.addEventListener("resize", () => charts.forEach(draw));
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => charts.forEach(draw));
</script>
</body>
</html>
)PAGE";

}  // namespace silpose
