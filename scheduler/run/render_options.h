// The options of `penumbra render` as the user gave them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scheduler/denoise/in_time.h"
#include "scheduler/farm/checkpoint_sink.h"
#include "scheduler/render/render_request.h"
#include "worker/cli/command_line.h"

namespace penumbra {

/// A request, and what is of the whole command.
struct RenderOptions : RenderRequest {
  std::vector<std::string> scenes = {};  ///< the scenes of the command
  int workers = 1;
  std::string launch = {};        ///< command that launches the workers; empty: they are started here
  std::string listen = {};        ///< additional address for viewers; empty: only the private socket
  std::string keys = {};          ///< folder of keys for `listen`; empty: none
  std::string web = {};           ///< address of the page in the browser; empty: none
  std::string address_file = {};  ///< in which workers find the address of `listen`; empty: none
  std::string tev = {};           ///< address of a tev viewer that shows the render; empty: none
  bool interactive = false;       ///< viewers choose camera and samples
  bool quiet = false;
  std::string progress = {};  ///< see progress_style
  bool estimate = false;      ///< print the expected cost, and render no image
  bool json = false;          ///< print the estimate as JSON
  double film_scale = 1;      ///< at most 1; a smaller film, with its crop, for an estimate
  bool resume = false;        ///< print a note if there is no checkpoint to resume from
  bool restart = false;       ///< ignore and replace an existing checkpoint
  double checkpoint_interval = kCheckpointInterval;  ///< seconds; 0: no checkpoints
  bool writes_here = true;  ///< false: the files are written elsewhere, by a service, or not at all
  // For several scenes and frames.
  std::string frames = {};        ///< see frames_of; empty: no shot
  bool preview_order = false;     ///< frames come in preview_order
  std::string video = {};         ///< file of the shot's video; empty: none
  int time_radius = kTimeRadius;  ///< of denoised frames, see ShotDenoiser
  bool no_sheet = false;          ///< no contact sheet
  bool force = false;             ///< render also what is already there and unchanged
  std::string summary = {};       ///< file with the result of each render; empty: beside the images
  std::string table = {};         ///< the same as CSV; empty: none
};

/// Adds the option of this name. Parsing stores its value in `request`, as that of all options here.
Option* add_render_option(CommandLine& command, RenderRequest& request, std::string_view name);

/// --web.
void add_web_option(CommandLine& command, std::string& address);

/// --threads, --backend, --opencl-device, --isa.
void add_device_options(CommandLine& command, RenderRequest& request);

void add_scene_options(CommandLine& command, RenderRequest& request);
/// The same without the scene itself.
void add_scene_overrides(CommandLine& command, RenderRequest& request);
void add_render_options(CommandLine& command, RenderOptions& options);
/// Chooses what the short help of a command with add_render_options shows.
void show_common_render_options(CommandLine& command);
/// Adds the options of a scheduler that renders for an interactive window.
void add_preview_options(CommandLine& command, RenderOptions& options);

}  // namespace penumbra
