// The large picture of one job.
import {forgetPicture, showPicture} from "./pictures.js";
import {setText} from "./text.js";

const dialog = document.getElementById("viewer");
const frame = dialog.querySelector(".frame");
let number = null;

export function openViewer(job) {
  number = job.job;
  updateViewer(job, "");
  dialog.showModal();
}

/** The job has news. */
export function updateViewer(job, detail) {
  if (job.job !== number) return;
  setText(dialog.querySelector("h2"), job.name);
  setText(dialog.querySelector(".detail"), detail);
  showPicture(frame, job, "image");
}

dialog.addEventListener("close", () => {
  number = null;
  forgetPicture(frame);
  frame.replaceChildren();
});
dialog.querySelector("button").addEventListener("click", () => dialog.close());
dialog.addEventListener("click", event => {
  if (event.target === dialog) dialog.close();
});
