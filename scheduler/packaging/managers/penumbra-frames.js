// A job type of Flamenco 3: frames of a shot, rendered in chunks by `penumbra render`. Put it into the folder `scripts`
// of the manager; the workers need `penumbra` in their PATH.
const JOB_TYPE = {
    label: "Penumbra Frames",
    description: "Renders frames of a shot; those that are there and would be the same are kept",
    settings: [
        { key: "scene", type: "string", subtype: "file_path", required: true,
          description: "The scene, or a name with ####, a file for each frame" },
        { key: "frames", type: "string", required: true, default: "1-10",
          description: "As in 1-250, or 1-10,50-60" },
        { key: "chunk_size", type: "int32", default: 10, propargs: {min: 1},
          description: "Frames of a task; they share the reading of the scene" },
        { key: "output", type: "string", subtype: "file_path", required: true, default: "out/frame.####.exr",
          description: "Name of the images" },
        { key: "options", type: "string", default: "",
          description: "Further options of `penumbra render`, separated by spaces, as in --spp 256 --denoise" },
        { key: "penumbra", type: "string", default: "penumbra", visible: "web", description: "The program" },
    ],
};

// A task fails where the exit code is not 0: 1 if frames failed or are incomplete, 2 if the command or the scene is
// wrong. Tried again, it renders only what is missing, and continues from checkpoints.
function compileJob(job) {
    const settings = job.settings;
    const options = settings.options.split(" ").filter(word => word !== "");
    for (const chunk of frameChunker(settings.frames, settings.chunk_size)) {
        const task = author.Task(`frames ${chunk}`, "misc");
        task.addCommand(author.Command("exec", {
            exe: settings.penumbra,
            args: ["render", settings.scene, "--frames", chunk, "-o", settings.output].concat(options),
        }));
        job.addTask(task);
    }
}
