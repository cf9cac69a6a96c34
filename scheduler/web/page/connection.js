// The stream of states from the scheduler. It is opened again whenever it breaks, and only while the page can be seen:
// browsers allow few connections to a server.
const kSilence = 25000;  // milliseconds; the scheduler says something every ten seconds
const kRetry = 2000, kUnseen = 5000;

let source = null, lastHeard = 0, lastState = null, isOver = false, retry = null, unseen = null;
let onState, onNotice;

function lost(why) {
  if (source) source.close();
  source = null;
  const of = lastState ? ` What you see is of ${lastState.toLocaleTimeString()}.` : "";
  onNotice(why ? why + of : `Connection lost, trying again.${of}`);
  clearTimeout(retry);
  retry = setTimeout(open, kRetry);
}

/** An EventSource does not tell why the server refuses it. */
async function tellWhy() {
  let why = "";
  try {
    const answer = await fetch("events", {method: "HEAD", cache: "no-store"});
    if (answer.status === 401) why = "This browser is not admitted (any more): open the link that the scheduler printed.";
    if (answer.status === 503) why = "Too many pages show this farm. This one waits for another to be closed.";
  } catch {
    // Nobody is there.
  }
  if (source === null || source.readyState === EventSource.CLOSED) lost(why);
}

function open() {
  clearTimeout(retry);
  if (isOver || source || document.hidden) return;
  const opened = source = new EventSource("events");
  lastHeard = performance.now();
  opened.onmessage = event => {
    lastHeard = performance.now();
    lastState = new Date();
    onNotice("");
    onState(JSON.parse(event.data));
  };
  opened.addEventListener("alive", () => {
    lastHeard = performance.now();
    lastState = new Date();
  });
  opened.addEventListener("over", () => {
    isOver = true;
    opened.close();
    onNotice("The render is over. This is its last state.");
  });
  opened.onerror = () => {
    if (isOver || source !== opened) return;
    opened.close();
    tellWhy();
  };
}

/** Calls `state` with each new state, and `notice` with what to tell about the connection, "" if it is good. */
export function connect(state, notice) {
  onState = state;
  onNotice = notice;
  open();
  setInterval(() => {
    if (source && performance.now() - lastHeard > kSilence) lost("");
  }, 1000);
  document.addEventListener("visibilitychange", () => {
    clearTimeout(unseen);
    if (!document.hidden) return open();
    unseen = setTimeout(() => {
      if (source) source.close();
      source = null;
    }, kUnseen);
  });
}
