// The page: shows each state that the scheduler sends.
import {connect} from "./connection.js";
import {JobList, showCount} from "./jobs.js";
import {clock, counted, element, rate, setText} from "./text.js";

const jobs = new JobList();
const workers = new Map();
let state = null;
let received = 0;  // when it came, by the browser's clock, in seconds

const seconds = () => performance.now() / 1000;

function updateWorkers() {
  const section = document.getElementById("workers"), list = section.querySelector("ul");
  section.hidden = state.workers.length === 0;
  showCount(section, state.workers.length);
  const present = new Set(state.workers.map(worker => worker.worker));
  for (const [number, item] of workers)
    if (!present.has(number)) {
      item.remove();
      workers.delete(number);
    }
  for (const worker of state.workers) {
    let item = workers.get(worker.worker);
    if (!item) {
      item = element("li", "", element("div", "title", element("bdi", "name"), element("span", "at")), element("p", "detail"));
      workers.set(worker.worker, item);
      list.append(item);
    }
    item.dataset.worker = worker.worker;
    item.dataset.idle = worker.job === null;
    setText(item.querySelector(".name"), worker.name);
    setText(item.querySelector(".at"), worker.job === null ? "idle" : `job ${worker.job}`);
    const parts = [worker.device, counted(worker.units, "unit")];
    if (worker.busy_seconds > 0) parts.push(`${rate(worker.samples / worker.busy_seconds)} while busy`);
    parts.push(`here for ${clock(worker.since_seconds + seconds() - received)}`);
    setText(item.querySelector(".detail"), parts.filter(part => part).join(" · "));
  }
}

function updateMessages() {
  const section = document.getElementById("messages"), list = section.querySelector("ol");
  section.hidden = state.messages.length === 0;
  const newestFirst = [...state.messages].reverse();
  newestFirst.forEach((text, index) => setText(list.children[index] || list.appendChild(element("li")), text));
  while (list.children.length > newestFirst.length) list.lastChild.remove();
}

function update() {
  if (state === null) return;
  const now = state.now + seconds() - received;
  const count = name => state.jobs.filter(job => job.state === name).length;
  const all = state.jobs.length + (state.jobs_left_out || 0);
  setText(document.getElementById("summary"),
          [counted(all, "job"), `${count("rendering")} rendering`, `${count("queued")} queued`,
           counted(state.workers.length, "worker")].join(" · "));
  setText(document.getElementById("version"), `penumbra ${state.penumbra}, up ${clock(state.up_seconds + seconds() - received)}.`);
  document.title = `${count("rendering")} rendering · Penumbra`;
  jobs.update(state, now, update);
  updateWorkers();
  updateMessages();
  document.body.dataset.shown = "true";
}

function showNotice(text) {
  const notice = document.getElementById("notice");
  notice.hidden = text === "";
  setText(notice, text);
}

/** Shows this state. */
export function show(newest) {
  state = newest;
  received = seconds();
  update();
}

connect(show, showNotice);
setInterval(update, 1000);
