"use strict";
// The page's numbers, unpacked; small helpers for all that follows.

const data = JSON.parse(document.getElementById("data").textContent);
const count = data.state.length;
const byId = id => document.getElementById(id);

// {step, deltas} as described in report_data.h: one number per step, NaN for a gap.
function unpack({step, deltas}) {
  const values = new Float64Array(deltas.length);
  let last = 0;
  deltas.forEach((delta, i) => { values[i] = delta === null ? NaN : (last += delta) * step; });
  return values;
}

const frames = unpack(data.frame), times = unpack(data.time);
const accuracy = unpack(data.accuracy), sampleSize = unpack(data.n_eff);
const dofs = data.dofs.map(dof => ({...dof, values: unpack(dof.values), half: unpack(dof.half),
                                    isAngle: dof.unit !== "m", places: dof.unit === "m" ? 3 : 1}));
const trusts = data.trust.map(({camera, values}) => ({camera, values: unpack(values)}));
const landmarks = data.skeleton.positions.map(axes => axes.map(unpack));  // [landmark][x, y, z][step]
const hasEvidence = i => data.state[i] === "t" || data.state[i] === "i";
const evidence = Array.from({length: count}, (_, i) => i).filter(hasEvidence);  // steps

function element(name, parent, text, className) {
  const node = document.createElement(name);
  if (text !== undefined) node.textContent = text;
  if (className) node.className = className;
  if (parent) parent.append(node);
  return node;
}

let style = getComputedStyle(document.documentElement);
const colour = name => style.getPropertyValue(name).trim();
const sideColour = side => colour(side === "left" ? "--left" : side === "right" ? "--right" : "--middle");
const withoutSide = name => name.replace(/^(left|right)_/, "");

const known = values => values.filter(Number.isFinite);
const mean = values => values.length ? values.reduce((a, b) => a + b, 0) / values.length : NaN;
const deviation = values => { const m = mean(values); return Math.sqrt(mean(values.map(v => (v - m) ** 2))); };
const largest = values => values.reduce((a, b) => Math.max(a, b), -Infinity);
const smallest = values => values.reduce((a, b) => Math.min(a, b), Infinity);
// The value below which a share of the values lies.
function quantile(values, share) {
  const sorted = Float64Array.from(known(values)).sort();
  return sorted.length ? sorted[Math.round(share * (sorted.length - 1))] : NaN;
}
const digits = (value, places) => Number.isFinite(value) ? value.toFixed(places) : "-";
const halfText = half => Number.isFinite(half) ? `\u00b1${half.toFixed(1)}\u00b0` : "-";
const seconds = time => digits(time, 2) + " s";

// Round tick positions: 1, 2 or 5 times a power of ten, at most `most` of them.
function ticks(low, high, most) {
  if (!(high > low)) return {values: [low], places: 2};
  const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(f => f * power).find(s => s >= raw * 0.999);
  const values = [];
  for (let t = Math.ceil(low / step - 1e-9) * step; t <= high + step * 1e-9; t += step) values.push(t);
  return {values, places: Math.max(0, -Math.floor(Math.log10(step) + 1e-9))};
}

// The step whose time is nearest.
function stepAt(time) {
  let low = 0, high = count - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle; else high = middle;
  }
  return high > 0 && Math.abs(times[high] - time) < Math.abs(times[low] - time) ? high : low;
}

// Stretches of steps for which `holds(i)`: [[first, last], ...]; those at most `apart` steps from each other are one.
function stretches(holds, apart = 1) {
  const found = [];
  for (let i = 0; i < count; ++i) {
    if (!holds(i)) continue;
    const last = found[found.length - 1];
    if (last && i - last[1] <= apart) last[1] = i; else found.push([i, i]);
  }
  return found;
}

// A canvas as large as it is shown; its context in CSS pixels. Null where it is not shown.
function prepare(canvas) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (!width || !height) return null;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const g = canvas.getContext("2d");
  g.scale(ratio, ratio);
  return {g, width, height};
}
const gaps = stretches(i => !hasEvidence(i));
