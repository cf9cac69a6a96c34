// Texts for numbers and times, and elements that contain text. Names and messages come from anybody who submits
// jobs: they only ever become text, never markup.

export function element(tag, className, ...children) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  made.append(...children);
  return made;
}

/** Sets a text where it differs, so that a selection stays. */
export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** "1:02:03", "4:05", "12 s". */
export function clock(seconds) {
  const whole = Math.max(0, Math.ceil(seconds));
  if (whole < 60) return `${whole} s`;
  const two = number => String(number).padStart(2, "0");
  const hours = Math.floor(whole / 3600), minutes = Math.floor(whole / 60) % 60;
  return hours > 0 ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`;
}

/** A time since 1970 in seconds, in the browser's zone: the time of day, and the day if it is another one. */
export function moment(unix) {
  const time = new Date(1000 * unix);
  const sameDay = time.toDateString() === new Date().toDateString();
  return sameDay ? time.toLocaleTimeString() : time.toLocaleString();
}

export function counted(number, noun) {
  return `${number} ${noun}${number === 1 ? "" : "s"}`;
}

export function bytes(size) {
  if (size < 1000) return `${size} B`;
  return size < 1e6 ? `${(size / 1e3).toFixed(1)} kB` : `${(size / 1e6).toFixed(1)} MB`;
}

export function rate(samplesPerSecond) {
  return `${(samplesPerSecond / 1e6).toFixed(2)} Msamples/s`;
}

export function percent(share) {
  const whole = 100 * share;  // rounded down, so that 100% is all
  return whole < 10 ? `${(Math.floor(10 * whole) / 10).toFixed(1)}%` : `${Math.floor(whole)}%`;
}

export function share(item) {
  return item.samples_total > 0 ? Math.min(1, item.samples_done / item.samples_total) : item.state === "done" ? 1 : 0;
}
