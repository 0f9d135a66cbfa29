// Which joint is uncertain, and when: one row per joint that turns, one column per piece of time, darker where the
// claimed 90 % interval of its angles is wide. A click goes to that time and shows that joint's curves.

const mapRowHeight = 17, mapValues = 52, mapAxis = 20;
const mapJoints = [];  // {name, group, half: the widest of its angles at each step}
for (const dof of dofs.filter(d => d.isAngle)) {
  let row = mapJoints.find(joint => joint.name === dof.joint);
  if (!row) mapJoints.push(row = {name: dof.joint, group: dof.group, half: new Float64Array(count).fill(NaN)});
  dof.half.forEach((half, i) => { if (!(row.half[i] >= half) && Number.isFinite(half)) row.half[i] = half; });
}
for (const joint of mapJoints) joint.median = quantile(joint.half.filter((_, i) => hasEvidence(i)), 0.5);

// Full colour: where only a twentieth of what is claimed is wider; 10 degrees at least, so that certain tracks look
// certain.
const mapTop = Math.max(10, Math.ceil(quantile(mapJoints.flatMap(joint => {
  const stride = Math.max(1, Math.floor(count / 500));
  return Array.from({length: Math.ceil(count / stride)}, (_, k) => joint.half[k * stride]);
}), 0.95) / 5) * 5 || 10);

const map = byId("map"), mapCanvas = map.querySelector("canvas"), mapCursor = map.querySelector(".cursor");
map.style.height = `${mapJoints.length * mapRowHeight + mapAxis + 8}px`;
const mapLeft = () => Math.min(150, map.clientWidth * 0.32);

function drawMap() {
  const canvas = prepare(mapCanvas);
  if (!canvas || !count) return;
  const {g, width, height} = canvas, left = Math.round(mapLeft()), right = width - mapValues;
  const columns = Math.max(1, Math.floor(right - left));
  const first = times[0], last = Math.max(times[count - 1], first + 1e-3);
  const x = i => left + (right - left) * (times[i] - first) / (last - first);
  // The first and last column of a step, which reaches half way to its neighbours.
  const column = at => Math.min(columns - 1, Math.max(0, Math.floor(at - left)));
  const between = (i, j) => column((x(i) + x(j)) / 2);
  const columnsOf = i => [between(Math.max(0, i - 1), i), between(i, Math.min(count - 1, i + 1))];
  g.font = "12px system-ui, sans-serif";
  g.textBaseline = "middle";
  mapJoints.forEach((joint, row) => {
    const top = 4 + row * mapRowHeight;
    g.globalAlpha = 1;
    g.fillStyle = sideColour((joint.name.match(/^(left|right)_/) || [])[1]);
    g.textAlign = "right";
    g.fillText(joint.name, left - 8, top + mapRowHeight / 2, left - 12);
    g.fillStyle = colour("--soft");
    g.fillText(halfText(joint.median), width - 6, top + mapRowHeight / 2);
    const widest = new Float64Array(columns).fill(NaN);  // of the steps that fall on a column
    for (let i = 0; i < count; ++i) {
      if (!Number.isFinite(joint.half[i])) continue;
      const [from, to] = columnsOf(i);
      for (let k = from; k <= to; ++k) if (!(widest[k] >= joint.half[i])) widest[k] = joint.half[i];
    }
    g.fillStyle = colour("--accent");
    widest.forEach((half, column) => {
      if (!Number.isFinite(half)) return;
      g.globalAlpha = 0.06 + 0.94 * Math.min(1, half / mapTop);
      g.fillRect(left + column, top + 1, 1, mapRowHeight - 2);
    });
  });
  g.globalAlpha = 1;
  const area = {left, right, top: 2, bottom: height - mapAxis};
  g.save();
  g.beginPath(); g.rect(left, area.top, right - left, area.bottom - area.top); g.clip();
  const kept = shown;
  shown = [0, count - 1];
  drawGaps(g, x, area);
  shown = kept;
  g.restore();
  g.fillStyle = colour("--soft");
  g.textBaseline = "top";
  const span = ticks(first, last, Math.max(2, Math.floor((right - left) / 80)));
  for (const time of span.values) {
    g.textAlign = time === first ? "left" : "center";
    const at = left + (right - left) * (time - first) / (last - first);
    g.fillText(time.toFixed(span.places) + " s", at, area.bottom + 4);
  }
}

function followMap() {
  if (!count) return;
  const share = (times[cursor] - times[0]) / Math.max(times[count - 1] - times[0], 1e-3);
  mapCursor.style.visibility = "visible";
  mapCursor.style.transform = `translateX(${mapLeft() + share * (map.clientWidth - mapLeft() - mapValues)}px)`;
}

let whenJointChosen = () => {};  // called with a group
map.addEventListener("click", event => {
  const box = map.getBoundingClientRect(), left = mapLeft();
  const joint = mapJoints[Math.floor((event.clientY - box.top - 4) / mapRowHeight)];
  if (joint) whenJointChosen(joint.group);
  const share = (event.clientX - box.left - left) / (box.width - left - mapValues);
  if (share >= 0 && share <= 1) seek(stepAt(times[0] + share * (times[count - 1] - times[0])));
});

const byUncertainty = mapJoints.filter(joint => Number.isFinite(joint.median)).sort((a, b) => b.median - a.median);
map.setAttribute("aria-label", "Claimed 90 % interval of every joint over time; in the median: " +
    byUncertainty.map(joint => `${joint.name} plus or minus ${digits(joint.median, 1)} degrees`).join(", "));
map.hidden = byId("map-title").hidden = byId("map-key").hidden = !mapJoints.length || !count;
element("span", byId("map-key"), `Half the claimed 90 % interval, of the joint's least certain angle: `);
for (const share of [0.06, 0.5, 1]) {
  const sample = element("i", byId("map-key"));
  sample.style.background = "var(--accent)";
  sample.style.opacity = Math.max(0.1, share);
  element("span", byId("map-key"), share < 0.1 ? "0\u00b0" : `${share === 1 ? "from " : ""}${mapTop * share}\u00b0`);
}
element("span", byId("map-key"), ". On the right: the median. Click a row for its curves.");
followers.push(followMap);
