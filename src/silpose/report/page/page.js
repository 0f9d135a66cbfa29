// The rest of the page: charts of the track's quality, the joints' curves by group, the masks, tables; and the start of
// all.

function writeQuality() {
  const parent = byId("quality");
  addChart(parent, {title: "Visual accuracy (IoU)", range: [0, 1], places: 3,
                    series: [{values: accuracy, everywhere: true}]});
  // Of one hypothesis, and of a smoothed clip, the size is 1 throughout and carries no information.
  const most = largest(known(sampleSize));
  if (most > 1) {
    addChart(parent, {title: "Effective sample size", range: [0, most * 1.05], places: most < 100 ? 1 : 0,
                      series: [{values: sampleSize, everywhere: true}]});
  }
  trusts.forEach(({camera, values}) => addChart(byId("trust"), {
    title: trusts.length > 1 ? `Trust in the masks of ${camera}` : "Trust in the masks", range: [0, 1.02], places: 2,
    series: [{values, everywhere: true}]}));
}

// The curves of a group: one chart per angle, right and left ones together.
const groups = [...new Set(dofs.map(dof => dof.group))];
let fixedCharts = 0, chosenGroup = "";
function showGroup(group) {
  chosenGroup = group;
  charts.length = fixedCharts;
  const parent = byId("curves"), sides = byId("sides").value, byName = new Map();
  parent.replaceChildren();
  for (const dof of dofs) {
    if (group && dof.group !== group) continue;
    if (sides && dof.side && dof.side !== sides) continue;
    const name = withoutSide(dof.name), chart = byName.get(name) || [];
    byName.set(name, [...chart, dof]);
  }
  for (const [name, together] of byName) {
    const [dof] = together, same = together.every(d => JSON.stringify(d.limits) === JSON.stringify(dof.limits));
    addChart(parent, {title: together.length > 1 ? name : dof.name, unit: dof.unit, places: dof.places,
                      least: dof.isAngle ? 10 : 0.1, limits: same ? dof.limits : null,
                      series: together.map(d => ({name: d.side, side: d.side, values: d.values, half: d.half}))});
  }
  byId("groups").querySelectorAll("button").forEach(button =>
      button.setAttribute("aria-pressed", button.value === group));
  drawAll();
}

function writeGroups() {
  for (const group of [...groups, ""]) {
    const button = element("button", byId("groups"), group || "all");
    button.value = group;
    button.addEventListener("click", () => showGroup(group));
  }
  byId("groups").hidden = groups.length < 2;
  byId("sides-label").hidden = !["left", "right"].every(side => dofs.some(dof => dof.side === side));
  document.body.classList.toggle("sideless", !data.skeleton.names.some(name => withoutSide(name) !== name));
  byId("sides").addEventListener("change", () => showGroup(chosenGroup));
  whenJointChosen = showGroup;
}

function writeNumbers() {
  const table = byId("numbers"), head = element("tr", element("thead", table)), body = element("tbody", table);
  const titles = ["angle", "least", "greatest", "range", "claimed 90 %, median", "95th percentile", "at its limit"];
  for (const title of titles) {
    element("th", head, title, title === "angle" ? "" : "number").scope = "col";
  }
  for (const dof of dofs) {
    const row = element("tr", body), values = evidence.map(i => dof.values[i]), halves = evidence.map(i => dof.half[i]);
    const name = element("th", row);
    name.scope = "row";
    element("button", name, dof.name).addEventListener("click", () => {
      showGroup(dof.group);
      byId("curves-title").scrollIntoView();
    });
    const low = smallest(known(values)), high = largest(known(values)), unit = dof.isAngle ? "\u00b0" : " m";
    const cell = (value, sign = "") =>
        element("td", row, Number.isFinite(value) ? sign + digits(value, dof.places) + unit : "-", "number");
    cell(low);
    cell(high);
    cell(high - low);
    cell(quantile(halves, 0.5), "\u00b1");
    cell(quantile(halves, 0.95), "\u00b1");
    element("td", row, dof.limits ? digits(100 * dof.atLimit, 0) + " %" : "-", "number");
  }
}

function writeTable(id, lines) {
  const body = element("tbody", byId(id));
  for (const [name, text] of lines) {
    const row = element("tr", body);
    element("th", row, name).scope = "row";
    element("td", row, text);
  }
}

function writeMasks() {
  writeTable("mask-facts", data.mask_facts);
  for (const {camera, examples} of data.strips) {
    if (!examples.length) continue;
    if (data.strips.length > 1) element("h3", byId("strips"), camera);
    const strip = element("div", byId("strips"), undefined, "strip");
    for (const {frame, time, width, height, empty, image} of examples) {
      const button = element("button", strip);
      const image = element("img", button);
      const found = empty ? ", in which nothing was found" : " with the outline of its mask";
      Object.assign(image, {src: image, width, height, alt: `The image at ${seconds(time)}${found}`});
      element("span", button, `${seconds(time)}${empty ? ": nothing found" : ""}`);
      button.title = `frame ${frame}`;
      button.addEventListener("click", () => seek(stepAt(time)));
    }
  }
  if (data.strips.some(({examples}) => examples.length)) {
    element("p", byId("strips"), "The input, cut out around the mask, with the mask's outline, evenly over the clip.",
            "soft");
  }
  byId("masks").hidden = !data.mask_facts.length && !data.strips.length && !trusts.length;
}

function writeStages() {
  const spent = data.stages.filter(([, time]) => time >= 0.005), total = spent.reduce((sum, [, time]) => sum + time, 0);
  const most = Math.max(1e-9, ...spent.map(([, time]) => time)), body = element("tbody", byId("stages"));
  for (const [name, time] of spent) {
    const row = element("tr", body);
    element("th", row, name).scope = "row";
    element("div", element("td", row), undefined, "bar").style.width = `${100 * time / most}%`;
    element("td", row, seconds(time), "number");
    element("td", row, count ? `${digits(1000 * time / count, 1)} ms a frame` : "", "number");
  }
  if (!spent.length) return;
  const row = element("tr", body);
  element("th", row, "together").scope = "row";
  element("td", row);
  element("td", row, seconds(total), "number");
  element("td", row, count ? `${digits(1000 * total / count, 1)} ms a frame` : "", "number");
}

function redraw() {
  style = getComputedStyle(document.documentElement);
  drawAll();
  drawMap();
  followMap();
  drawSkeleton();
}

writeHead();
writeQuality();
writeMasks();
fixedCharts = charts.length;
writeGroups();
writeNumbers();
writeTable("facts", data.facts);
writeStages();
// First what moves most: of the groups that are not the root's, the one with the largest mean range.
const rangeOfDof = dof => { const seen = known(dof.values); return seen.length ? largest(seen) - smallest(seen) : 0; };
const liveliest = groups.slice(groups.length > 1 ? 1 : 0)
    .map(group => [group, mean(dofs.filter(dof => dof.group === group && dof.isAngle).map(rangeOfDof)) || 0])
    .reduce((best, next) => next[1] > best[1] ? next : best, [groups[0] || "", -1])[0];
showGroup(liveliest);
redraw();
moved();
new ResizeObserver(redraw).observe(document.body);
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
window.addEventListener("beforeprint", redraw);
