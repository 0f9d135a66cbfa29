// Curves over time. options: title, unit, places, series: [{name, side, values, half, everywhere: also where there is
// no evidence}], limits, range, least (span of the vertical axis). What is drawn stays; the cursor is a line above it.

const charts = [];                     // those on the page
const plotLeft = 44, plotRight = 8;    // room for the vertical axis, and at the right end
let shown = [0, Math.max(0, count - 1)];  // first and last step of the time that is shown

const startTime = () => times[shown[0]];
const endTime = () => Math.max(times[shown[1]], times[shown[0]] + 1e-3);

function rangeOf({series, range, least = 0}) {
  if (range) return range;
  let low = Infinity, high = -Infinity;
  for (const {values, half, everywhere} of series) {
    values.forEach((value, i) => {
      if (!Number.isFinite(value) || (evidence.length && !everywhere && !hasEvidence(i))) return;
      const spread = half && Number.isFinite(half[i]) ? half[i] : 0;
      low = Math.min(low, value - spread);
      high = Math.max(high, value + spread);
    });
  }
  if (low > high) [low, high] = [0, 1];
  if (high - low < least) [low, high] = [(low + high - least) / 2, (low + high + least) / 2];
  const room = (high - low) * 0.06 || 0.5;
  return [low - room, high + room];
}

// What a screen reader says about a chart.
function chartLabel({title, unit = "", places, series}) {
  const parts = series.map(({name, values, half}) => {
    const seen = known(values);
    if (!seen.length) return `${name || ""} nothing known`;
    const claimed = half ? `, interval in the median plus or minus ${digits(quantile(half, 0.5), places)}` : "";
    return `${name || ""} from ${digits(smallest(seen), places)} to ${digits(largest(seen), places)} ${unit}${claimed}`;
  });
  return `${title} over time: ${parts.join("; ")}. Click to move the time.`;
}

// Makes `plot`'s clicks and drags move the cursor.
function scrub(plot, left, right) {
  const go = event => {
    const box = plot.getBoundingClientRect();
    const share = (event.clientX - box.left - left) / (box.width - left - right);
    seek(stepAt(startTime() + Math.min(1, Math.max(0, share)) * (endTime() - startTime())));
  };
  plot.addEventListener("pointerdown", event => {
    if (event.button !== 0) return;
    plot.setPointerCapture(event.pointerId);
    go(event);
  });
  plot.addEventListener("pointermove", event => { if (plot.hasPointerCapture(event.pointerId)) go(event); });
}

// Moves a cursor line over a plot; hides it outside the time shown.
function placeCursor(line, plot, left, right) {
  const share = (times[cursor] - startTime()) / (endTime() - startTime());
  const isInside = count > 0 && share >= -1e-9 && share <= 1 + 1e-9;
  line.style.visibility = isInside ? "visible" : "hidden";
  if (isInside) line.style.transform = `translateX(${left + share * (plot.clientWidth - left - right)}px)`;
}

function readingOf({series, places, unit}, step) {
  return series.map(({name, values, half}) => {
    const value = values[step], spread = half ? half[step] : NaN;
    return (name && series.length > 1 ? name + " " : "") + digits(value, places) +
        (Number.isFinite(value) && Number.isFinite(spread) ? " \u00b1 " + digits(spread, places) : "") +
        (unit && Number.isFinite(value) ? (unit === "\u00b0" ? "" : " ") + unit : "");
  }).join("  ");
}

function addChart(parent, options) {
  const card = element("div", parent, undefined, "card chart");
  const header = element("header", card);
  element("b", header, options.title);
  const reading = element("span", header);
  const plot = element("div", card, undefined, "plot");
  const canvas = element("canvas", plot);
  plot.setAttribute("role", "img");
  plot.setAttribute("aria-label", chartLabel(options));
  const line = element("i", plot, undefined, "cursor");
  const chart = {options, canvas, plot, range: rangeOf(options)};
  chart.follow = step => {
    reading.textContent = readingOf(options, step);
    placeCursor(line, plot, plotLeft, plotRight);
  };
  scrub(plot, plotLeft, plotRight);
  charts.push(chart);
  return chart;
}

const drawAll = () => charts.forEach(chart => { drawChart(chart); chart.follow(cursor); });

followers.push(step => {
  if (step < shown[0] || step > shown[1]) showSpan();  // the cursor left the time that is shown
  else charts.forEach(chart => chart.follow(step));
});

// The time shown: the whole clip, or this many seconds around the cursor.
const spanChoice = byId("span");
for (const length of [30, 10, 3, 1]) {
  if (count && times[count - 1] - times[0] > 1.5 * length) element("option", spanChoice, `${length} s`).value = length;
}
spanChoice.parentNode.hidden = spanChoice.options.length < 2;
function showSpan() {
  const length = Number(spanChoice.value);
  if (!count) return;
  if (!length) {
    shown = [0, count - 1];
  } else {
    const first = stepAt(Math.max(times[0], Math.min(times[cursor] - length / 4, times[count - 1] - length)));
    shown = [Math.min(first, cursor), Math.max(stepAt(times[first] + length), cursor)];
  }
  drawAll();
}
spanChoice.addEventListener("change", showSpan);
