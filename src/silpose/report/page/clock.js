// One time cursor for the video, the skeleton and the curves: a step of the recording. The video goes without controls
// of its own, which would lie over the feet. Where there is no video, a clock of our own plays.

const video = byId("video");
let hasVideo = Boolean(video.getAttribute("src"));
let cursor = Math.max(0, evidence.length ? evidence[0] : 0);
let isPlaying = false, ownStart = null;  // of our own clock: {at, step}
const followers = [];                    // called with the step when the cursor moved

const slider = byId("slider"), play = byId("play"), now = byId("now"), speed = byId("speed");
const stateNames = {w: "waiting", i: "start", t: "tracked", c: "predicted"};

function moved() {
  slider.value = cursor;
  const frame = `frame ${digits(frames[cursor], 0)}, ${stateNames[data.state[cursor]] || "-"}`;
  slider.setAttribute("aria-valuetext", `${seconds(times[cursor])}, ${frame}`);
  now.replaceChildren(seconds(times[cursor]));
  element("small", now, ` ${frame}`);
  for (const follower of followers) follower(cursor);
}

// Moves the cursor, and the video with it.
function seek(step) {
  if (!count) return;
  cursor = Math.min(count - 1, Math.max(0, step));
  if (hasVideo && Number.isFinite(video.duration)) {
    // One image per step, which stays until the next one's time.
    const until = cursor + 1 < count ? times[cursor + 1] - times[0] : video.duration;
    video.currentTime = Math.min((times[cursor] - times[0] + until) / 2, video.duration);
  }
  if (ownStart) ownStart = {at: performance.now(), step: cursor};
  moved();
}

function showPlaying(playing) {
  isPlaying = playing;
  play.textContent = playing ? "Pause" : "Play";
}

function toggle() {
  if (!count) return;
  if (hasVideo) {
    if (video.paused) video.play(); else video.pause();
    return;
  }
  showPlaying(!isPlaying);
  ownStart = isPlaying ? {at: performance.now(), step: cursor} : null;
  if (isPlaying) requestAnimationFrame(tick);
}

function tick() {
  if (!isPlaying) return;
  let step = cursor;
  if (hasVideo) {
    const time = times[0] + video.currentTime + 0.001;
    step = stepAt(time);
    if (step > 0 && times[step] > time) --step;
  } else {
    const time = times[ownStart.step] + (performance.now() - ownStart.at) / 1000 * Number(speed.value);
    if (time > times[count - 1] + 1 / data.fps) ownStart = {at: performance.now(), step: 0};
    step = stepAt(time > times[count - 1] + 1 / data.fps ? times[0] : time);
  }
  if (step !== cursor) { cursor = step; moved(); }
  requestAnimationFrame(tick);
}

video.addEventListener("play", () => { showPlaying(true); requestAnimationFrame(tick); });
video.addEventListener("pause", () => showPlaying(false));
video.addEventListener("loadedmetadata", () => { video.playbackRate = Number(speed.value); seek(cursor); });
video.addEventListener("click", toggle);
byId("large").hidden = !document.fullscreenEnabled;
byId("large").addEventListener("click", () => video.requestFullscreen());
function withoutVideo(note) {
  hasVideo = false;
  video.hidden = true;
  ownStart = null;
  showPlaying(false);
  byId("video-note").textContent = note;
  byId("clip").classList.add("alone");
}
if (!hasVideo) withoutVideo("There is no overlay video of this result.");
video.addEventListener("error", () => {
  if (hasVideo) withoutVideo(`The overlay video cannot be shown (${video.getAttribute("src").slice(0, 60)}).`);
});

speed.addEventListener("change", () => {
  video.playbackRate = Number(speed.value);
  if (ownStart) ownStart = {at: performance.now(), step: cursor};
});
slider.max = Math.max(0, count - 1);
slider.addEventListener("input", () => seek(Number(slider.value)));
play.addEventListener("click", toggle);
byId("transport").hidden = !count;

// Space plays; arrows move by a frame, with shift by a second; Home and End. Elements with keys of their own keep them.
document.addEventListener("keydown", event => {
  if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
  const tag = event.target.tagName;
  if (tag === "SELECT" || (tag === "INPUT" && event.key !== " ")) return;
  if (event.key === " " && (tag === "BUTTON" || tag === "SUMMARY" || tag === "A")) return;
  const stride = event.shiftKey ? Math.max(1, Math.round(data.fps)) : 1;
  const steps = {ArrowLeft: cursor - stride, ArrowRight: cursor + stride, Home: 0, End: count - 1};
  if (event.key === " ") toggle();
  else if (event.key in steps) seek(steps[event.key]);
  else return;
  event.preventDefault();
});
