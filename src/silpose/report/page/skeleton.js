// The body's bones in 3D on a floor, for interactive rotation. World: Y up, metres; the view turns about the body's
// middle.

// {yaw, pitch} in radians; `distance` of the eye in metres, `focal` in pixels. The eye is at
// target + distance (sin yaw cos pitch, sin pitch, cos yaw cos pitch).
function projector(target, {yaw, pitch, distance}, focal, width, height) {
  const cy = Math.cos(yaw), sy = Math.sin(yaw), cp = Math.cos(pitch), sp = Math.sin(pitch);
  return point => {
    const x = point[0] - target[0], y = point[1] - target[1], z = point[2] - target[2];
    const near = sy * x + cy * z, depth = cp * near + sp * y;  // towards the eye
    const away = distance - depth;
    if (away < distance * 0.05) return null;
    const scale = focal / away;
    return {x: width / 2 + (cy * x - sy * z) * scale, y: height / 2 - (cp * y - sp * near) * scale, depth, scale};
  };
}

const skeletonCanvas = byId("skeleton");
const skeletonAt = step => landmarks.map(axes => axes.map(axis => axis[step]));
const isKnown = points => points.length > 0 && Number.isFinite(points[0][0]);

// The box around a pose: its middle, and half its diagonal.
function boundsOf(points) {
  const low = [0, 1, 2].map(k => smallest(points.map(p => p[k])));
  const high = [0, 1, 2].map(k => largest(points.map(p => p[k])));
  return {middle: [0, 1, 2].map(k => (low[k] + high[k]) / 2),
          radius: Math.hypot(...[0, 1, 2].map(k => high[k] - low[k])) / 2};
}

const view = {yaw: 0.5, pitch: 0.15, zoom: 1};
let bodyRadius = 1, middleHeight = 1, fromCamera = {yaw: 0.5, pitch: 0.15}, cell = 0.5;

// The size of the body over the clip, and where the camera sees it from.
function measureBody() {
  const sample = [], stride = Math.max(1, Math.floor(count / 60));
  for (let i = 0; i < count; i += stride) {
    const points = skeletonAt(i);
    if (isKnown(points)) sample.push(boundsOf(points));
  }
  if (!sample.length) return;
  bodyRadius = Math.max(1e-3, quantile(sample.map(bounds => bounds.radius), 0.9));
  middleHeight = quantile(sample.map(bounds => bounds.middle[1]), 0.5);
  const middle = [0, 1, 2].map(k => quantile(sample.map(bounds => bounds.middle[k]), 0.5));
  if (data.viewpoint) {
    const [x, y, z] = data.viewpoint.map((value, k) => value - middle[k]);
    fromCamera = {yaw: Math.atan2(x, z), pitch: Math.atan2(y, Math.hypot(x, z))};
  }
  cell = ticks(0, 2 * bodyRadius, 5).values[1] || 0.5;  // 0.5 m for a person
}

// Floor lines around the body, in pieces of a cell so that those behind the eye can be left out.
function drawFloor(g, project, target) {
  const reach = 6, at = [Math.round(target[0] / cell), Math.round(target[2] / cell)];
  g.strokeStyle = colour("--floor");
  g.lineWidth = 1;
  g.beginPath();
  for (let i = -reach; i <= reach; ++i) {
    for (let j = -reach; j < reach; ++j) {
      const ends = [[[i, j], [i, j + 1]], [[j, i], [j + 1, i]]];
      for (const [a, b] of ends) {
        const from = project([(at[0] + a[0]) * cell, 0, (at[1] + a[1]) * cell]);
        const to = project([(at[0] + b[0]) * cell, 0, (at[1] + b[1]) * cell]);
        if (!from || !to) continue;
        g.moveTo(from.x, from.y);
        g.lineTo(to.x, to.y);
      }
    }
  }
  g.stroke();
}

function drawSkeleton() {
  const canvas = prepare(skeletonCanvas);
  if (!canvas || !count) return;
  const {g, width, height} = canvas, points = skeletonAt(cursor), seen = isKnown(points);
  const note = byId("skeleton-note");
  note.textContent = !seen ? "no pose yet" : hasEvidence(cursor) ? "" : "predicted: no evidence in this frame";
  const target = seen ? boundsOf(points).middle : [0, 0, 0];
  target[1] = middleHeight;
  const distance = 5 * bodyRadius;
  const focal = 0.45 * Math.min(width * 1.2, height) * distance / bodyRadius * view.zoom;
  const project = projector(target, {...view, distance}, focal, width, height);
  drawFloor(g, project, target);
  if (!seen) return;
  const bones = [];
  data.skeleton.parents.forEach((parent, i) => {
    if (parent < 0) return;
    const from = project(points[parent]), to = project(points[i]);
    if (from && to) bones.push({i, from, to, parent, depth: (from.depth + to.depth) / 2});
  });
  g.lineCap = "round";
  g.strokeStyle = colour("--shadow");
  g.lineWidth = 5;
  for (const {i, parent} of bones) {  // on the floor, below the bones
    const ends = [parent, i].map(k => project([points[k][0], 0, points[k][2]]));
    if (!ends[0] || !ends[1]) continue;
    g.beginPath(); g.moveTo(ends[0].x, ends[0].y); g.lineTo(ends[1].x, ends[1].y); g.stroke();
  }
  if (!hasEvidence(cursor)) { g.globalAlpha = 0.55; g.setLineDash([2, 7]); }
  bones.sort((a, b) => a.depth - b.depth);  // near ones last
  for (const {i, from, to} of bones) {
    const thick = Math.max(2, 0.024 * bodyRadius * (from.scale + to.scale) / 2);
    g.strokeStyle = colour("--card");  // a rim, so that crossing bones stay apart
    g.lineWidth = thick + 3;
    g.beginPath(); g.moveTo(from.x, from.y); g.lineTo(to.x, to.y); g.stroke();
    g.strokeStyle = g.fillStyle = sideColour((data.skeleton.names[i].match(/^(left|right)_/) || [])[1]);
    g.lineWidth = thick;
    g.beginPath(); g.moveTo(from.x, from.y); g.lineTo(to.x, to.y); g.stroke();
    g.beginPath(); g.arc(to.x, to.y, thick * 0.9, 0, 2 * Math.PI); g.fill();
  }
  g.setLineDash([]);
  g.globalAlpha = 1;
}

function turn(yaw, pitch, zoom = 1) {
  view.yaw += yaw;
  view.pitch = Math.min(1.5, Math.max(-1.5, view.pitch + pitch));
  view.zoom = Math.min(8, Math.max(0.25, view.zoom * zoom));
  drawSkeleton();
}

// One pointer rotates, two zoom.
const pointers = new Map();
skeletonCanvas.addEventListener("pointerdown", event => {
  skeletonCanvas.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, [event.clientX, event.clientY]);
});
skeletonCanvas.addEventListener("pointermove", event => {
  const before = pointers.get(event.pointerId);
  if (!before) return;
  const after = [event.clientX, event.clientY];
  pointers.set(event.pointerId, after);
  if (pointers.size === 1) {
    turn(-(after[0] - before[0]) * 0.01, (after[1] - before[1]) * 0.01);
  } else if (pointers.size === 2) {
    const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
    const apart = point => Math.max(1, Math.hypot(point[0] - other[0], point[1] - other[1]));
    turn(0, 0, apart(after) / apart(before));
  }
});
for (const name of ["pointerup", "pointercancel"]) {
  skeletonCanvas.addEventListener(name, event => pointers.delete(event.pointerId));
}
skeletonCanvas.addEventListener("wheel", event => {
  if (document.activeElement !== skeletonCanvas) return;  // the page scrolls until the view was clicked
  event.preventDefault();
  turn(0, 0, Math.exp(-event.deltaY * 0.001));
}, {passive: false});
skeletonCanvas.addEventListener("keydown", event => {
  const moves = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1],
                 "+": [0, 0, 1.15], "=": [0, 0, 1.15], "-": [0, 0, 1 / 1.15]};
  if (!(event.key in moves) || event.ctrlKey || event.metaKey) return;
  turn(...moves[event.key]);
  event.preventDefault();
});

function look(yaw, pitch) {
  Object.assign(view, {yaw, pitch: Math.min(1.5, Math.max(-1.5, pitch)), zoom: 1});
  drawSkeleton();
}

measureBody();
Object.assign(view, fromCamera);
skeletonCanvas.setAttribute("aria-label", `The body's ${data.skeleton.names.length} joints and ends in 3D at the ` +
    "time of the cursor. Arrow keys turn it, plus and minus bring it nearer and further.");
byId("cell").textContent = `${cell} m`;
const views = [["Camera", 0, null], ["Turned 90\u00b0", Math.PI / 2, null], ["From above", 0, 1.5]];
for (const [name, yaw, pitch] of views) {
  element("button", byId("views"), name).addEventListener("click", () =>
      look(fromCamera.yaw + yaw, pitch === null ? fromCamera.pitch : pitch));
}
byId("skeleton-figure").hidden = !landmarks.length || !count;
followers.push(drawSkeleton);
