// The frames of a shot: a strip with a cell for each, and the pictures of those that have begun.
import {forgetPicture, showPicture} from "./pictures.js";
import {element, percent, setText, share} from "./text.js";
import {openViewer} from "./viewer.js";

const kMostReasons = 5;
const kMostApart = 120;  // cells with gaps, which would take most of the room of more

class FrameElement {
  constructor(frame) {
    this.picture = element("button", "picture");
    this.picture.type = "button";
    this.picture.disabled = true;
    this.label = element("span", "label");
    this.node = element("li", "frame", this.picture, this.label);
    this.node.dataset.frame = frame;
    this.picture.addEventListener("click", () => openViewer(this.job));
    this.picture.addEventListener("picture", () => { this.picture.disabled = !this.picture.querySelector("img"); });
  }

  update(job, detail) {
    this.job = job;
    this.node.dataset.state = job.state;
    this.node.title = detail.slice(0, 500);
    this.picture.setAttribute("aria-label", `Image of frame ${job.frame}`);
    const more = job.state === "rendering" ? percent(share(job)) : job.state === "done" ? "" : job.state;
    setText(this.label, [String(job.frame), more].filter(part => part).join(" · "));
    showPicture(this.picture, job, "thumbnail");
  }

  remove() {
    forgetPicture(this.picture);
    this.node.remove();
  }
}

/** Of one group. */
export class Frames {
  constructor() {
    this.strip = element("div", "strip");
    this.strip.setAttribute("role", "img");
    this.reasons = element("ul", "reasons");
    this.list = element("ol", "frames");
    this.node = element("div", "shot", this.strip, this.reasons, this.list);
    this.elements = new Map();  // by number of the job
    this.cells = new Map();
  }

  /** `detailOf` tells of a job what is told beside its name. */
  update(frames, jobs, detailOf) {
    this.updateStrip(frames);
    const begun = jobs.filter(job => typeof job.frame === "number" && job.state !== "queued").sort((a, b) => a.frame - b.frame || a.job - b.job);
    const present = new Set(begun.map(job => job.job));
    for (const [number, item] of this.elements)
      if (!present.has(number)) {
        item.remove();
        this.elements.delete(number);
      }
    begun.forEach((job, index) => {
      let shown = this.elements.get(job.job);
      if (!shown) this.elements.set(job.job, shown = new FrameElement(job.frame));
      shown.update(job, detailOf(job));
      if (this.list.children[index] !== shown.node) this.list.insertBefore(shown.node, this.list.children[index] || null);
    });
    this.updateReasons(begun);
  }

  updateStrip(frames) {
    const states = new Map();
    for (const [state, numbers] of Object.entries(frames)) for (const frame of numbers) states.set(frame, state);
    const text = JSON.stringify([...states]);
    if (this.shownStates === text) return;
    this.shownStates = text;
    const cells = [...states].sort((a, b) => a[0] - b[0]).map(([frame, state]) => {
      const cell = element("i");
      cell.dataset.state = state;
      cell.title = `frame ${frame}: ${state}`;
      return cell;
    });
    this.strip.replaceChildren(...cells);
    this.strip.classList.toggle("many", cells.length > kMostApart);
    const counts = Object.entries(frames).filter(([, numbers]) => numbers.length > 0).map(([state, numbers]) => `${numbers.length} ${state}`);
    this.strip.setAttribute("aria-label", `Frames: ${counts.join(", ")}`);
  }

  /** Why frames failed: each reason once. */
  updateReasons(jobs) {
    const reasons = new Map();
    const failed = jobs.filter(job => job.error && (job.state === "failed" || job.state === "incomplete"));
    for (const job of failed) reasons.set(job.error, [...(reasons.get(job.error) || []), job.frame]);
    const texts = [...reasons].slice(0, kMostReasons).map(([error, frames]) =>
      `Frame${frames.length > 1 ? "s" : ""} ${frames.slice(0, 10).join(", ")}${frames.length > 10 ? ", …" : ""}: ${error}`);
    if (reasons.size > kMostReasons) texts.push(`${reasons.size - kMostReasons} more reasons`);
    const text = JSON.stringify(texts);
    if (this.shownReasons === text) return;
    this.shownReasons = text;
    this.reasons.replaceChildren(...texts.map(line => element("li", "", line)));
  }

  remove() {
    for (const item of this.elements.values()) item.remove();
  }
}
