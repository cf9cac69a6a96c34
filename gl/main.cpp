// penumbra-view: a window for a scene or for a running render.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <span>

#include "gl/script_runner.h"
#include "gl/view_options.h"
#include "gl/viewer.h"
#include "kernels/host/console.h"
#include "kernels/host/plain_file.h"
#include "scenes/scene_reader.h"
#include "scheduler/files/output_check.h"
#include "scheduler/files/program_path.h"
#include "scheduler/files/stop_signal.h"
#include "scheduler/image/picture.h"
#include "scheduler/record/version.h"
#include "scheduler/render/frame_files.h"
#include "worker/cli/command_line.h"
#include "worker/cli/command_reference.h"
#include "worker/cli/exit_code.h"
#include "worker/cli/help_text.h"
#include "worker/protocol/grpc_log.h"
#include "worker/protocol/message_memory.h"

namespace penumbra {
namespace {

// News and input end the waiting; what else may happen (a child ends, a script's time is up) is looked for at
// this interval.
constexpr double kIdleSeconds = 0.25, kScriptSeconds = 0.01;
// In narrower windows the picture begins without the panel beside it.
constexpr int kLeastWidthForPanel = 640;
constexpr std::uint64_t kMaxScriptBytes = std::uint64_t{1} << 20;

Expected<std::vector<ScriptCommand>> read_script(const std::string& path) {
  if (path.empty()) return std::vector<ScriptCommand>{};
  const Expected<std::string> text = read_plain_file(path, kMaxScriptBytes);
  if (!text) return fail("--script: " + text.error().message);
  return parse_script(*text, path);
}

/// Without a script, takes a screenshot once all samples have arrived.
std::vector<ScriptCommand> with_screenshot(std::vector<ScriptCommand> commands, const ViewOptions& options) {
  if (options.screenshot.empty()) return commands;
  if (options.script.empty())
    commands.push_back(
        WaitCommand{.what = WaitFor::kFinished, .timeout_seconds = std::numeric_limits<double>::infinity()});
  if (!commands.empty() && std::holds_alternative<QuitCommand>(commands.back())) commands.pop_back();
  commands.push_back(ScreenshotCommand{.path = options.screenshot});
  return commands;
}

/// Whether the name is that of a shot's image files.
bool is_shot_name(const std::string& name) {
  return is_image_name(name) && FrameFiles::unless_file(name).has_value();
}

/// The arguments without the options of these names, and their values.
std::vector<std::string> without(std::vector<std::string> arguments,
                                 std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    if (const auto at = std::ranges::find(arguments, name); at != arguments.end())
      arguments.erase(at, at + 2);
  return arguments;
}

/// Checks, before anything is started, that the scene exists and no input would be overwritten.
Expected<void> check_files(const ViewOptions& options, const std::vector<ScriptCommand>& script) {
  std::vector<std::filesystem::path> inputs, outputs;
  if (const std::string& scene = options.preview.scene.file; !scene.empty()) {
    if (auto found = check_scene_file(scene, {}); !found && !is_image_name(scene)) return found;
    if (!is_shot_name(scene)) inputs.emplace_back(scene);
  }
  if (!options.reference.empty()) inputs.emplace_back(options.reference);
  if (!options.script.empty()) inputs.emplace_back(options.script);
  if (!options.screenshot.empty()) outputs.emplace_back(options.screenshot);
  for (const ScriptCommand& command : script) {
    if (const auto* save = std::get_if<SaveCommand>(&command)) outputs.emplace_back(save->path);
    if (const auto* screenshot = std::get_if<ScreenshotCommand>(&command))
      outputs.emplace_back(screenshot->path);
  }
  // One by one: a script may write the same file twice.
  for (const auto& output : outputs)
    if (auto checked = check_outputs(std::span(&output, 1), inputs); !checked) return checked;
  return {};
}

/// Runs until the user quits or the script is done.
Expected<void> show(Viewer& viewer, Window& window, ScriptRunner* script, const std::atomic<bool>& stop) {
  while (!viewer.wants_to_quit() && !stop) {
    const double patience = script != nullptr ? kScriptSeconds : kIdleSeconds;
    const double to_next = viewer.seconds_to_next().value_or(patience);
    viewer.handle(window.poll(viewer.is_stale() ? 0 : std::min(patience, to_next)));
    if (Expected<void> updated = viewer.update(); !updated) return updated;
    if (script != nullptr) {
      if (Expected<void> stepped = script->step(viewer, window); !stepped) return stepped;
      if (script->is_done()) return {};
    }
    if (!viewer.is_stale() && (script == nullptr || !script->wants_frame())) continue;
    if (Expected<void> drawn = viewer.draw(); !drawn) return drawn;
  }
  return {};
}

ExitCode view(const ViewOptions& options, const CommandLine& app) {
  const std::atomic<bool>& stop = install_stop_signal();
  auto script = read_script(options.script);
  if (!script) return print_error(script.error()), kBadInput;
  if (const auto checked = check_files(options, *script); !checked)
    return print_error(checked.error()), kBadInput;
  const bool scripted = !options.script.empty() || !options.screenshot.empty();

  const auto access = client_access(options.connect, options.preview.keys, KeyRole::kViewer);
  if (!access) return print_error(access.error()), kBadInput;
  const bool shows_file = is_image_name(options.preview.scene.file);
  std::vector<std::string> unused = preview_arguments(app);
  std::erase(unused, options.preview.scene.file);
  const bool shows_shot = shows_file && is_shot_name(options.preview.scene.file);
  if (shows_shot) unused = without(std::move(unused), {"--frame", "--fps"});
  if (shows_file && !unused.empty())
    return print_error({fmt::format("{}: an image is shown as it is; options of renders do not apply: {}",
                                    options.preview.scene.file, fmt::join(unused, " "))}),
           kBadInput;
  std::unique_ptr<LocalScheduler> local;
  std::string address = options.connect;
  if (options.connect.empty() && !shows_file) {
    const auto penumbra = find_program("penumbra");
    if (!penumbra) return print_error(penumbra.error()), kIncomplete;
    auto started = LocalScheduler::start(*penumbra, preview_arguments(app));
    if (!started) return print_error(started.error()), kIncomplete;
    local = std::move(*started);
    address = local->address();
  }
  const std::string name = options.connect.empty() ? options.preview.scene.file : options.connect;
  auto window = Window::create({.title = fmt::format("Penumbra: {}", name),
                                .width = options.width,
                                .height = options.height,
                                .visible = !options.hidden,
                                .debug = options.gl_debug,
                                .content_scale = {}});
  if (!window) return print_error(window.error()), kIncomplete;
  const ShotOptions shot{.first = options.preview.scene.frame, .fps = options.preview.scene.fps};
  auto viewer = shows_shot   ? Viewer::show_shot(*window, options.preview.scene.file, shot)
                : shows_file ? Viewer::show_file(*window, options.preview.scene.file)
                             : Viewer::create(*window, address, *access, options.job, local.get());
  if (!viewer) return print_error(viewer.error()), shows_file ? kBadInput : kIncomplete;
  if (!options.reference.empty())
    if (const auto opened = (*viewer)->open_reference(options.reference); !opened)
      return print_error(opened.error()), kBadInput;
  (*viewer)->set_panel(options.width >= kLeastWidthForPanel);

  if (options.script.empty() && !options.screenshot.empty()) (*viewer)->refine_from_the_start();
  ScriptRunner runner(with_screenshot(std::move(*script), options), options.script);
  const Expected<void> shown = show(**viewer, *window, scripted ? &runner : nullptr, stop);
  const std::vector<std::string> gl_errors = window->take_gl_errors();
  if (!shown) {
    print_error(shown.error());
    return (*viewer)->scheduler_exit_code() == kBadInput ? kBadInput : kIncomplete;
  }
  for (const std::string& error : gl_errors) print_error({"OpenGL: " + error});
  return gl_errors.empty() && (!scripted || runner.is_done() || (*viewer)->wants_to_quit()) ? kAllDone
                                                                                            : kIncomplete;
}

ExitCode run(int argc, char** argv) {
  CommandLine app(
      "Open a window on a scene, or on a render that is under way. Polygon lights are there at once; their "
      "shadows converge",
      "penumbra-view");
  app.add_version([] { return fmt::format("penumbra-view {}", kVersion); });
  ViewOptions options;
  add_view_options(app, options);
  app.footer(
      "Keys: space asks for one more sample, r refines until told otherwise, w a s d and the mouse move the "
      "camera, h shows all keys.\n\n"
      "Exit code: 0 all done, 1 something failed, 2 bad usage or bad input.\n\n"
      "Examples:\n"
      "  penumbra-view scenes/star-light/star-light.xml --workers 2\n"
      "  penumbra-view --connect unix:/run/user/1000/penumbra-x/socket\n"
      "  penumbra-view 'out/shot.####.exr'                   plays the frames, also while they are rendered\n"
      "  xvfb-run -a penumbra-view scene.xml --script steps.txt --screenshot end.png");
  if (const auto answered = answer_about(app, {argv + 1, argv + argc})) return *answered;
  if (const auto ended = app.parse(argc, argv)) return *ended;
  if (options.preview.scene.file.empty() && options.connect.empty())
    return app.refuse("SCENE or --connect is required");
  return view(options, app);
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  penumbra::begin_program("penumbra-view");
  penumbra::keep_message_memory();
  penumbra::route_grpc_log();
  penumbra::keep_grpc_running();
  try {
    return penumbra::end_program(penumbra::run(argc, argv));
  } catch (const std::exception& error) {
    penumbra::print_error({fmt::format("internal error: {}", error.what())});
  }
  return penumbra::kIncomplete;
}
