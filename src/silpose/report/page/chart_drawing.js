// How a chart is drawn. However long the clip, a curve has at most two points per pixel: of the steps that fall on one,
// the least and the greatest, so that no peak is lost.

// Points of a curve in the time shown, in order: {x, low, high, below, above} with the values' extremes and those of
// the band, cut where `isIn(step)` does not hold: a list of runs.
function runsOf({values, half}, x, width, isIn) {
  const runs = [];
  const perPixel = (shown[1] - shown[0] + 1) / Math.max(1, width) > 2;
  let run = null, point = null;
  for (let i = shown[0]; i <= shown[1]; ++i) {
    const value = values[i];
    if (!Number.isFinite(value) || !isIn(i)) { run = point = null; continue; }
    const spread = half && Number.isFinite(half[i]) ? half[i] : 0;
    const at = perPixel ? Math.round(x(i)) : x(i);
    if (!run) runs.push(run = []);
    if (point && perPixel && point.x === at) {
      point.low = Math.min(point.low, value);
      point.high = Math.max(point.high, value);
      point.below = Math.min(point.below, value - spread);
      point.above = Math.max(point.above, value + spread);
    } else {
      run.push(point = {x: at, low: value, high: value, below: value - spread, above: value + spread});
    }
  }
  return runs;
}

function drawAxes(g, chart, x, y, {left, right, top, bottom}) {
  const [low, high] = chart.range;
  const vertical = ticks(low, high, 5);
  const span = ticks(startTime(), endTime(), Math.max(2, Math.floor((right - left) / 80)));
  g.font = "11px system-ui, sans-serif";
  g.lineWidth = 1;
  g.strokeStyle = colour("--grid");
  g.fillStyle = colour("--soft");
  g.textAlign = "right";
  g.textBaseline = "middle";
  for (const value of vertical.values) {
    g.beginPath(); g.moveTo(left, y(value)); g.lineTo(right, y(value)); g.stroke();
    g.fillText(value.toFixed(vertical.places), left - 6, y(value));
  }
  g.textBaseline = "top";
  for (const time of span.values) {
    const at = left + (right - left) * (time - startTime()) / (endTime() - startTime());
    g.textAlign = at > right - 14 ? "right" : at < left + 14 ? "left" : "center";
    g.fillText(time.toFixed(span.places) + " s", Math.min(at, right + 6), bottom + 6);
  }
}

// The time without evidence, in grey with slanted lines: seen in any scheme, and when printed.
function drawGaps(g, x, {top, bottom}) {
  const halfStep = i => Math.max(0.75, i > 0 ? (x(i) - x(i - 1)) / 2 : i + 1 < count ? (x(i + 1) - x(i)) / 2 : 4);
  for (const [first, last] of gaps) {
    if (last < shown[0] || first > shown[1]) continue;
    const from = x(first) - halfStep(first), to = x(last) + halfStep(last);
    g.save();
    g.beginPath(); g.rect(from, top, to - from, bottom - top); g.clip();
    g.fillStyle = colour("--coast");
    g.fillRect(from, top, to - from, bottom - top);
    g.strokeStyle = colour("--coast");
    g.lineWidth = 2;
    g.beginPath();
    for (let at = from - (bottom - top); at < to; at += 9) { g.moveTo(at, bottom); g.lineTo(at + bottom - top, top); }
    g.stroke();
    g.restore();
  }
}

function drawRuns(g, runs, y) {
  g.beginPath();
  for (const run of runs) {
    run.forEach(({x, low, high}, i) => {
      if (i === 0) g.moveTo(x, y(low)); else g.lineTo(x, y(low));
      if (high !== low) g.lineTo(x, y(high));
    });
    if (run.length === 1) g.lineTo(run[0].x + 1, y(run[0].high));
  }
  g.stroke();
}

function drawBand(g, runs, y) {
  for (const run of runs) {
    g.beginPath();
    run.forEach(({x, above}) => g.lineTo(x, y(above)));
    for (let i = run.length; i-- > 0;) g.lineTo(run[i].x, y(run[i].below));
    g.closePath();
    g.fill();
  }
}

function drawChart(chart) {
  const canvas = prepare(chart.canvas);
  if (!canvas || !count) return;
  const {g, width, height} = canvas, {options, range: [low, high]} = chart;
  const area = {left: plotLeft, right: width - plotRight, top: 6, bottom: height - 20};
  const x = i => area.left + (area.right - area.left) * (times[i] - startTime()) / (endTime() - startTime());
  const y = value => area.bottom - (area.bottom - area.top) * (value - low) / (high - low);
  drawAxes(g, chart, x, y, area);
  g.save();
  g.beginPath(); g.rect(area.left, area.top, area.right - area.left, area.bottom - area.top); g.clip();
  drawGaps(g, x, area);
  if (options.limits) {
    g.strokeStyle = colour("--limit");
    g.setLineDash([5, 4]);
    for (const limit of options.limits) {
      g.beginPath(); g.moveTo(area.left, y(limit)); g.lineTo(area.right, y(limit)); g.stroke();
    }
    g.setLineDash([]);
  }
  for (const series of options.series) {
    const seen = runsOf(series, x, area.right - area.left, i => series.everywhere || hasEvidence(i));
    const guessed = series.everywhere ? [] : runsOf(series, x, area.right - area.left, i => !hasEvidence(i));
    g.strokeStyle = g.fillStyle = sideColour(series.side);
    if (series.half) {
      g.globalAlpha = 0.2;
      drawBand(g, seen, y);
      g.globalAlpha = 0.08;
      drawBand(g, guessed, y);
      g.globalAlpha = 1;
    }
    g.lineWidth = 1.6;
    g.lineJoin = "round";
    drawRuns(g, seen, y);
    g.lineWidth = 1;
    g.setLineDash([1.5, 3]);
    drawRuns(g, guessed, y);
    g.setLineDash([]);
  }
  g.restore();
}
