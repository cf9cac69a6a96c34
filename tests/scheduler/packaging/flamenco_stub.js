// What Flamenco 3's manual says of the functions that its manager gives to job types, as far as ours uses them. Prints
// the tasks of a job: node flamenco_stub.js JOB_TYPE.js SETTINGS_AS_JSON
const fs = require("fs"), vm = require("vm");

function framesOf(text) {
  return text.split(",").flatMap(part => {
    const [first, last = first] = part.split("-").map(Number);
    return Array.from({length: last - first + 1}, (_, i) => first + i);
  });
}

/** Runs of frames have a dash, and a chunk may have several. */
function chunkText(frames) {
  const runs = [];
  for (const frame of frames)
    if (runs.length > 0 && runs.at(-1)[1] === frame - 1) runs.at(-1)[1] = frame;
    else runs.push([frame, frame]);
  return runs.map(([first, last]) => first === last ? `${first}` : `${first}-${last}`).join(",");
}

const manager = {
  author: {
    Task: (name, type) => ({name, type, commands: [], addCommand(command) { this.commands.push(command); }}),
    Command: (name, parameters) => ({name, parameters}),
  },
  frameChunker(text, size) {
    const frames = framesOf(text), chunks = [];
    for (let i = 0; i < frames.length; i += size) chunks.push(chunkText(frames.slice(i, i + size)));
    return chunks;
  },
};
const context = vm.createContext(manager);
vm.runInContext(fs.readFileSync(process.argv[2], "utf8") + "\nthis.type = JOB_TYPE;\nthis.compile = compileJob;\n", context);
const given = JSON.parse(process.argv[3]);
const settings = {};
for (const {key, type} of context.type.settings)
  if (!["string", "int32", "float", "bool"].includes(type) || typeof key !== "string") throw new Error(`setting ${key}`);
for (const setting of context.type.settings) settings[setting.key] = given[setting.key] ?? setting.default;
const tasks = [];
context.compile({settings, addTask: task => tasks.push(task)});
console.log(JSON.stringify(tasks));
