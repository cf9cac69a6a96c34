// Pictures of jobs: loaded while they can be seen, and again when more of the job is rendered.
const kInterval = 2000, kEvery = 10000, kRetry = 4000;  // milliseconds

const frames = new Map();  // frame element -> what it shows
const observer = new IntersectionObserver(entries => {
  for (const entry of entries) {
    const shown = frames.get(entry.target);
    if (shown) shown.visible = entry.isIntersecting;
  }
}, {rootMargin: "200px"});

/** Shows jobs/NUMBER/KIND.png in the frame from now on. */
export function showPicture(frame, job, kind) {
  let shown = frames.get(frame);
  if (!shown) {
    shown = {visible: false, loaded: 0};
    frames.set(frame, shown);
    observer.observe(frame);
  }
  if (shown.number !== job.job) {
    shown.version = null;
    frame.replaceChildren();
  }
  Object.assign(shown, {number: job.job, kind, job});
}

export function forgetPicture(frame) {
  observer.unobserve(frame);
  frames.delete(frame);
}

/** A queued job has a picture only if an earlier process has begun it; that is not asked for. */
function wanted(shown, now) {
  if (!shown.visible || shown.loading || shown.job.state === "queued") return null;
  const age = now - shown.loaded;
  const isRendering = shown.job.state === "rendering";
  const version = `${shown.job.state}-${shown.job.samples_done}`;
  const isDue = isRendering ? (version !== shown.version && age >= kInterval) || age >= kEvery
                            : version !== shown.version && (shown.version === null || age >= kInterval);
  return isDue && !(shown.failed && age < kRetry) ? version : null;
}

function load(frame, shown, version, now) {
  const image = new Image();
  const number = shown.number;
  shown.loading = true;
  shown.loaded = now;
  const done = isGood => {
    shown.loading = false;
    shown.failed = !isGood;
    if (frames.get(frame) !== shown || shown.number !== number) return;
    // Of a job that is over there will be no other picture.
    if (isGood || shown.job.state !== "rendering") shown.version = version;
    if (isGood) frame.replaceChildren(image);
    frame.dispatchEvent(new Event("picture"));
  };
  image.onload = () => done(true);
  image.onerror = () => done(false);
  image.alt = "";
  image.src = `jobs/${number}/${shown.kind}.png?v=${encodeURIComponent(version)}-${Math.floor(now)}`;
}

function refresh() {
  const now = performance.now();
  for (const [frame, shown] of frames) {
    const version = wanted(shown, now);
    if (version !== null) load(frame, shown, version, now);
  }
}
setInterval(refresh, 250);
