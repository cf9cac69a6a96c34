// The options of `penumbra render` as the user gave them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenes/integrators.h"
#include "scheduler/farm/checkpoint_sink.h"
#include "scheduler/plan/plan_options.h"
#include "worker/cli/command_line.h"

namespace penumbra {

/// The options that determine the scene; `render` and `info` share them.
struct SceneOptions {
  std::string scene;
  std::vector<std::string> defines;   ///< name=value
  std::vector<std::string> settings;  ///< key=value
  std::optional<double> scale;        ///< of the film, after `settings`; see film_scale.h; not 1
  bool lenient = false;
  bool strict = false;
  std::string dialect;                    ///< empty: determined from the scene file
  std::optional<std::string> integrator;  ///< one of the names of integrator.type
  std::optional<std::string> sampler;     ///< one of the names of sampler.type, or "scene"
  bool needs_independent = false;         ///< an independent sampler of the scene is not replaced
  std::optional<std::uint32_t> spp;
  std::optional<std::uint32_t> seed;
  std::string intersector = "auto";
  bool no_features = false;
  bool cryptomatte = false;
  std::string denoise;  ///< one of the names of film.denoise; empty: the scene's
  std::string layers;   ///< a value of film.layers; empty: the scene's

  friend auto operator<=>(const SceneOptions&, const SceneOptions&) = default;
};

/// A rectangle of film pixels; x1 and y1 are exclusive.
struct CropRectangle {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct PixelPosition {
  int x = 0, y = 0;
};

struct RenderOptions {
  std::vector<std::string> scenes;  ///< the scenes of the command
  SceneOptions scene;               ///< the options for one of them
  std::string out;                  ///< empty: named after the scene, in the current folder
  std::string statistics;
  bool no_statistics = false;
  std::string backend = "native";
  std::string opencl_device;
  std::optional<std::string> isa;
  int workers = 1;
  int threads = 0;           ///< per worker; 0: all cores, divided among the workers
  std::string launch;        ///< command that launches the workers; empty: they are started here
  std::string listen;        ///< additional address for viewers; empty: only the private socket
  std::string keys;          ///< folder of keys for `listen`; empty: none
  std::string web;           ///< address of the page in the browser; empty: none
  std::string address_file;  ///< in which workers find the address of `listen`; empty: none
  std::string tev;           ///< address of a tev viewer that shows the render; empty: none
  bool interactive = false;  ///< viewers choose camera and samples
  PlanOptions plan;          ///< except the next two, which depend on the integrator if they are not given
  std::optional<std::uint32_t> samples_per_pass;
  std::optional<int> tile;
  std::optional<double> time_budget;
  double verify = 0;  ///< fraction of units that a second worker renders too
  std::optional<CropRectangle> crop;
  std::optional<PixelPosition> pixel;
  bool strict_numerics = false;  ///< a non-finite sample is an error
  bool quiet = false;
  bool estimate = false;  ///< print the expected cost, and render no image
  bool json = false;      ///< print the estimate as JSON
  double film_scale = 1;  ///< at most 1; a smaller film, with its crop, for an estimate
  bool resume = false;    ///< print a note if there is no checkpoint to resume from
  bool restart = false;   ///< ignore and replace an existing checkpoint
  double checkpoint_interval = kCheckpointInterval;  ///< seconds; 0: no checkpoints
  bool writes_here = true;  ///< false: the files are written elsewhere, by a service, or not at all
  // For several scenes.
  bool force = false;   ///< render also what is already there and unchanged
  std::string summary;  ///< file with the result of each render; empty: beside the images
  std::string table;    ///< the same as CSV; empty: none
};

/// --threads, --backend, --opencl-device, --isa.
void add_denoise_device_options(CommandLine& command, RenderOptions& options);

/// The values of --sampler.
std::vector<std::string> sampler_names();

/// The plan with the defaults of this integrator.
PlanOptions plan_of(const RenderOptions& options, const IntegratorSettings& integrator);

/// Adds the options to a command. Parsing stores their values in `options`.
void add_scene_options(CommandLine& command, SceneOptions& options);
/// The same without the scene itself.
void add_scene_overrides(CommandLine& command, SceneOptions& options);
void add_render_options(CommandLine& command, RenderOptions& options);
/// Chooses what the short help of a command with add_render_options shows.
void show_common_render_options(CommandLine& command);
/// Adds the options of a scheduler that renders for an interactive window.
void add_preview_options(CommandLine& command, RenderOptions& options);

/// "x0,y0,x1,y1" with 0 <= x0 < x1 and 0 <= y0 < y1; nothing if it is anything else.
std::optional<CropRectangle> parse_crop(const std::string& text);
/// "x,y", neither negative.
std::optional<PixelPosition> parse_pixel(const std::string& text);

}  // namespace penumbra
