// The head of the page: is the track good, and where is it not?

const typicalAccuracy = quantile(accuracy, 0.5);
const accuracyDrop = 0.1;  // this far below the clip's median agreement is worth a look

// Places worth a look: {first, last, text}, in order of time.
function doubtfulPlaces() {
  const places = [];
  const frames = ([first, last]) => last === first ? "1 frame" : `${last - first + 1} frames`;
  const add = (stretch, text) => places.push({first: stretch[0], last: stretch[1], text});
  for (const stretch of stretches(i => data.state[i] === "w")) {
    add(stretch, `no pose: the subject is not found yet, ${frames(stretch)}`);
  }
  for (const stretch of stretches(i => data.state[i] === "c")) {
    add(stretch, `no evidence: the pose is predicted, ${frames(stretch)}`);
  }
  const apart = Math.max(1, Math.round(data.fps / 5));
  for (const [first, last] of stretches(i => accuracy[i] < typicalAccuracy - accuracyDrop, apart)) {
    let worst = first;
    for (let i = first; i <= last; ++i) if (!(accuracy[worst] <= accuracy[i])) worst = i;
    add([first, last], `the silhouettes agree less: ${digits(accuracy[worst], 2)} at ${seconds(times[worst])}`);
  }
  return places.sort((a, b) => a.first - b.first);
}

// Share of the frames with evidence in which an angle is at its limit, to within a degree.
function shareAtLimit({limits, values}) {
  if (!limits || !evidence.length) return 0;
  return evidence.filter(i => values[i] <= limits[0] + 1 || values[i] >= limits[1] - 1).length / evidence.length;
}
for (const dof of dofs) dof.atLimit = shareAtLimit(dof);

function writeTiles() {
  const predicted = stretches(i => data.state[i] === "c").reduce((sum, [first, last]) => sum + last - first + 1, 0);
  const waiting = count - evidence.length - predicted;
  const seen = known(accuracy);
  const tiles = [[count, "frames"], [evidence.length, "tracked"], [predicted, "coasted: no evidence"],
                 ...(waiting ? [[waiting, "waiting for the subject"]] : []),
                 [seen.length ? `${digits(mean(seen), 3)} \u00b1 ${digits(deviation(seen), 3)}` : "-",
                  "visual accuracy: agreement of silhouettes (IoU)"]];
  const halves = mapJoints.map(joint => joint.median).filter(Number.isFinite);
  if (halves.length) tiles.push([halfText(quantile(halves, 0.5)), "claimed 90 % interval of a joint, median"]);
  for (const [value, label] of tiles) {
    const tile = element("div", byId("tiles"), undefined, "tile");
    element("b", tile, value);
    element("span", tile, label);
  }
}

function writeVerdict(places) {
  if (!count) { byId("verdict").textContent = "There is no frame in this result."; return; }
  const sentences = [];
  if (!evidence.length) {
    sentences.push("No frame was compared with a silhouette: there is nothing to trust here.");
  } else {
    const worst = evidence.reduce((a, b) => accuracy[b] < accuracy[a] ? b : a);
    sentences.push(`${evidence.length} of ${count} frames were compared with a silhouette; the agreement is ` +
        `${digits(typicalAccuracy, 2)} in the median and ${digits(accuracy[worst], 2)} at worst ` +
        `(${seconds(times[worst])}).`);
    if (byUncertainty.length > 1) {
      const list = joints => joints.map(joint => `${joint.name} (${halfText(joint.median)})`).join(", ");
      sentences.push(`Least certain: ${list(byUncertainty.slice(0, 3))}; ` +
          `most certain: ${list(byUncertainty.slice(-2))}.`);
    }
  }
  if (places.length) {
    sentences.push(`${places.length} ${places.length === 1 ? "place is" : "places are"} listed below to look at.`);
  }
  byId("verdict").textContent = sentences.join(" ");
}

function writePlaces(places) {
  const list = byId("places"), most = 10;
  // The longest are kept where there are many.
  const shownPlaces = [...places].sort((a, b) => (b.last - b.first) - (a.last - a.first)).slice(0, most)
      .sort((a, b) => a.first - b.first);
  for (const {first, last, text} of shownPlaces) {
    const time = first === last ? seconds(times[first]) : `${digits(times[first], 2)} to ${seconds(times[last])}`;
    const button = element("button", element("li", list), `${time}: ${text}`);
    button.addEventListener("click", () => seek(first));
  }
  if (places.length > most) element("li", list, `and ${places.length - most} more, no longer than these`, "plain soft");
  if (!places.length && evidence.length) {
    element("li", list, `Nowhere does the agreement fall ${accuracyDrop} below its median, and no frame is without ` +
        "evidence.", "plain");
  }
  const stuck = dofs.filter(dof => dof.atLimit > 0.1).sort((a, b) => b.atLimit - a.atLimit).slice(0, 6);
  if (stuck.length) {
    element("li", list, "At a limit of the joint for more than a tenth of the time, so perhaps wrong: " +
        stuck.map(dof => `${dof.name} (${digits(100 * dof.atLimit, 0)} %)`).join(", ") + ".", "plain");
  }
}

function writeHead() {
  const places = doubtfulPlaces();
  byId("lead").textContent = count ? `Frames ${digits(frames[0], 0)} to ${digits(frames[count - 1], 0)}, ` +
      `${seconds(times[0])} to ${seconds(times[count - 1])}` : "No frame";
  for (const warning of data.warnings) element("li", byId("warnings").querySelector("ul"), warning);
  byId("warnings").hidden = !data.warnings.length;
  writeTiles();
  writeVerdict(places);
  writePlaces(places);
  const downloads = byId("downloads");
  downloads.hidden = !data.downloads.length;
  element("span", downloads, "Files next to this page:", "soft");
  for (const [file, what] of data.downloads) {
    const link = element("a", downloads, file);
    link.href = encodeURIComponent(file);
    link.title = what;
    link.setAttribute("download", "");
  }
}
