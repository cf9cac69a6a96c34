// Jobs and groups of jobs as elements, one for each, which are updated in place.
import {Frames} from "./frames.js";
import {forgetPicture, showPicture} from "./pictures.js";
import {bytes, clock, element, moment, percent, rate, setText, share} from "./text.js";
import {openViewer, updateViewer} from "./viewer.js";

const isOver = job => job.state !== "queued" && job.state !== "rendering";

function secondsLeft(job) {
  if (typeof job.seconds_left === "number") return job.seconds_left;
  const here = job.samples_done - (job.samples_before || 0);
  return here > 0 && job.elapsed_seconds > 0 ? (job.samples_total - job.samples_done) * job.elapsed_seconds / here : null;
}

function error(job) {
  return typeof job.relative_error === "number" ? `error ${(100 * job.relative_error).toPrecision(2)}%` : null;
}

/** What is told beside the name. */
export function detailOf(job, state, now) {
  const parts = [];
  if (job.state === "rendering") {
    const here = job.samples_done - (job.samples_before || 0), left = secondsLeft(job);
    const workers = state.workers.filter(worker => worker.job === job.job).length;
    parts.push(percent(share(job)));
    if (here > 0 && job.elapsed_seconds > 0) parts.push(rate(here / job.elapsed_seconds));
    if (left !== null) parts.push(`${clock(left)} left`);
    parts.push(error(job), workers > 0 ? `${workers} at work` : null);
  } else if (job.state === "queued") {
    parts.push(`since ${clock(now - job.submitted)}`);
    if (job.priority !== 0) parts.push(`priority ${job.priority}`);
    if (job.after && job.after.length > 0) parts.push(`after ${job.after.join(", ")}`);
  } else {
    if (job.error) parts.push(job.error);
    if (job.begun && job.ended) parts.push(`in ${clock(job.ended - job.begun)}`);
    if (!job.error) parts.push(error(job));
    if (job.ended) parts.push(`ended ${moment(job.ended)}`);
  }
  return parts.filter(part => part).join(" · ");
}

class JobElement {
  constructor(onChange) {
    this.picture = element("button", "picture");
    this.picture.type = "button";
    this.number = element("span", "number");
    this.name = element("bdi", "name");
    this.state = element("span", "state");
    this.bar = element("progress");
    this.detail = element("p", "detail");
    this.facts = element("dl");
    this.problems = element("ul", "problems");
    this.more = element("details", "more", element("summary", "", "Details"), this.facts, this.problems);
    this.node = element("li", "job", this.picture, element("div", "title", this.number, this.name, this.state),
                        element("div", "", this.bar, this.detail), this.more);
    this.picture.addEventListener("click", () => openViewer(this.job));
    this.picture.addEventListener("picture", () => { this.picture.disabled = !this.picture.querySelector("img"); });
    this.more.addEventListener("toggle", () => {
      if (!this.more.open) return;
      onChange();
      this.loadProblems();
    });
    this.picture.disabled = true;
  }

  update(job, state, now) {
    const changed = this.job && this.job.state !== job.state;
    this.job = job;
    this.node.dataset.job = job.job;
    this.node.dataset.state = job.state;
    this.picture.setAttribute("aria-label", `Image of job ${job.job}`);
    setText(this.number, String(job.job));
    setText(this.name, job.name);
    this.name.title = job.name.slice(0, 500);
    setText(this.state, job.state);
    const detail = detailOf(job, state, now);
    setText(this.detail, detail);
    this.bar.hidden = job.state !== "rendering";
    this.bar.setAttribute("aria-label", `Share of job ${job.job} that is rendered`);
    this.bar.value = share(job);
    showPicture(this.picture, job, "thumbnail");
    updateViewer(job, detail);
    if (this.more.open) {
      this.updateFacts(job);
      if (changed) this.loadProblems();
    }
  }

  updateFacts(job) {
    const facts = [["Priority", String(job.priority)], ["Submitted", job.submitted ? moment(job.submitted) : null],
      ["By", job.submitter], ["Begun", job.begun ? moment(job.begun) : null], ["Ended", job.ended ? moment(job.ended) : null],
      ["Samples", job.samples_total > 0 ? `${job.samples_done} of ${job.samples_total}` : null],
      ["Error", error(job)?.slice("error ".length)], ["Folder", job.folder]].filter(([, value]) => value);
    const files = (job.files || []).map(file => [file.name, file.bytes]);
    const text = JSON.stringify([facts, files]);
    if (this.shownFacts === text) return;
    this.shownFacts = text;
    const rows = facts.flatMap(([name, value]) => [element("dt", "", name), element("dd", "", element("bdi", "", value))]);
    if (files.length > 0) {
      const list = element("ul", "files");
      for (const [name, size] of files) {
        const link = element("a", "", element("bdi", "", name));
        link.href = `jobs/${job.job}/files/${encodeURIComponent(name)}`;
        link.download = name;
        list.append(element("li", "", link, ` ${bytes(size)}`));
      }
      rows.push(element("dt", "", "Files"), element("dd", "", list));
    }
    this.facts.replaceChildren(...rows);
  }

  async loadProblems() {
    try {
      const answer = await fetch(`jobs/${this.job.job}.json`);
      if (!answer.ok) return;
      const problems = (await answer.json()).problems || [];
      this.problems.replaceChildren(...problems.map(text => element("li", "", text)));
    } catch {
      // The notice of the page tells that the connection is lost.
    }
  }

  remove() {
    forgetPicture(this.picture);
    this.node.remove();
  }
}

class GroupElement {
  constructor() {
    this.name = element("bdi", "name");
    this.number = element("span", "number");
    this.state = element("span", "state");
    this.detail = element("p", "detail");
    this.bar = element("progress");
    this.list = element("ul", "jobs");
    this.details = element("details", "", element("summary", "", element("span", "title", this.number, this.name, this.state)),
                           this.bar, this.detail, this.list);
    this.node = element("li", "group", this.details);
  }

  /** Jobs of a shot are pictures of frames first. */
  showFrames(group, jobs, state, now) {
    if (!group.frames) return;
    if (!this.frames) {
      this.frames = new Frames();
      this.more = element("details", "more", element("summary", "", "Frames as jobs"), this.list);
      this.details.append(this.frames.node, this.more);
    }
    this.frames.update(group.frames, [...jobs, ...(group.frames_left_out || [])], job => detailOf(job, state, now));
  }

  update(group, jobs, state, now) {
    this.showFrames(group, jobs, state, now);
    // Else as the reader likes; a shot that ends stays as it is.
    const isShown = group.state === "rendering";
    if (this.shownState !== group.state && (isShown || !this.shownState || !group.frames)) this.details.open = isShown;
    this.shownState = group.state;
    this.node.dataset.group = group.group;
    for (const node of [this.node, this.details]) node.dataset.state = group.state;
    setText(this.number, String(group.group));
    setText(this.name, group.name || `group ${group.group}`);
    setText(this.state, group.state);
    const counts = Object.entries(group.jobs || {}).filter(([, count]) => count > 0).map(([name, count]) => `${count} ${name}`);
    counts.unshift(`${group.size ?? jobs.length} ${group.frames ? "frames" : "jobs"}`);
    if (group.seconds_left > 0) counts.push(`${clock(group.seconds_left)} left`);
    if (group.submitter) counts.push(`by ${group.submitter}`);
    setText(this.detail, counts.join(" · "));
    this.bar.hidden = group.state !== "rendering" || Boolean(group.frames);  // a shot has its strip
    this.bar.setAttribute("aria-label", `Share of group ${group.group} that is rendered`);
    this.bar.value = group.done ?? share(group);
  }

  remove() {
    if (this.frames) this.frames.remove();
    this.node.remove();
  }
}

/** Puts the nodes into the list in this order; those that stay in place are not touched. */
function arrange(list, nodes) {
  nodes.forEach((node, index) => {
    if (list.children[index] !== node) list.insertBefore(node, list.children[index] || null);
  });
}

const sectionOf = item => item.state === "queued" ? "waiting" : isOver(item) ? "ended" : "rendering";

function inOrder(section, items) {
  const keys = {rendering: item => [-(item.priority || 0), item.job ?? item.group],
                waiting: item => [-(item.priority || 0), item.job ?? item.group], ended: item => [-(item.ended || 0), 0]};
  const key = keys[section];
  return items.sort((a, b) => key(a)[0] - key(b)[0] || key(a)[1] - key(b)[1]);
}

export class JobList {
  constructor() {
    this.jobs = new Map();
    this.groups = new Map();
  }

  update(state, now, onChange) {
    const groups = new Map((state.groups || []).map(group => [group.group, group]));
    const members = new Map();  // of each group
    const sections = {rendering: [], waiting: [], ended: []};
    for (const group of groups.values()) sections[sectionOf(group)].push(group);
    for (const job of state.jobs) {
      let shown = this.jobs.get(job.job);
      if (!shown) this.jobs.set(job.job, shown = new JobElement(onChange));
      shown.update(job, state, now);
      if (groups.has(job.group)) members.set(job.group, [...(members.get(job.group) || []), job]);
      else sections[sectionOf(job)].push(job);
    }
    for (const group of groups.values()) {
      let shown = this.groups.get(group.group);
      if (!shown) this.groups.set(group.group, shown = new GroupElement());
      const jobs = (members.get(group.group) || []).sort((a, b) => a.job - b.job);
      shown.update(group, jobs, state, now);
      arrange(shown.list, jobs.map(job => this.jobs.get(job.job).node));
    }
    const present = new Set(state.jobs.map(job => job.job));
    this.removeOthers(this.jobs, present);
    this.removeOthers(this.groups, groups);
    for (const [name, items] of Object.entries(sections)) this.showSection(name, inOrder(name, items));
    const leftOut = document.querySelector("#ended .left-out");
    leftOut.hidden = !state.jobs_left_out;
    setText(leftOut, `${state.jobs_left_out} more, which ended earlier`);
  }

  removeOthers(shown, present) {
    for (const [number, item] of shown)
      if (!present.has(number)) {
        item.remove();
        shown.delete(number);
      }
  }

  showSection(name, items) {
    const section = document.getElementById(name);
    section.hidden = items.length === 0;
    arrange(section.querySelector(".jobs"),
            items.map(item => (item.job !== undefined ? this.jobs.get(item.job) : this.groups.get(item.group)).node));
    showCount(section, items.length);
  }
}

/** "Ended 12" */
export function showCount(section, count) {
  const heading = section.querySelector("h2");
  const shown = heading.querySelector(".count") || heading.appendChild(element("span", "count"));
  setText(shown, String(count));
}
