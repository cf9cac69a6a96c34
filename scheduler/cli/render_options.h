// The options of `penumbra render` as the user gave them.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/farm/checkpoint_sink.h"

namespace penumbra {

/// What says which scene to read and how; `render` and `info` share it.
struct SceneOptions {
  std::string scene;
  std::vector<std::string> defines;   ///< name=value
  std::vector<std::string> settings;  ///< key=value
  bool lenient = false;
  bool strict = false;
  std::string dialect;                    ///< empty: what the scene file tells
  std::optional<std::string> integrator;  ///< one of the names of integrator.type
  std::optional<std::string> sampler;
  std::optional<std::uint32_t> spp;
  std::optional<std::uint32_t> seed;
  std::string intersector = "auto";
  bool no_features = false;
  bool cryptomatte = false;

  friend auto operator<=>(const SceneOptions&, const SceneOptions&) = default;
};

/// A rectangle of film pixels, the end outside.
struct CropRectangle {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct PixelPosition {
  int x = 0, y = 0;
};

struct RenderOptions {
  std::vector<std::string> scenes;  ///< of one command
  SceneOptions scene;               ///< of one of them
  std::string out;                  ///< empty: named after the scene, in the current folder
  std::string statistics;
  bool no_statistics = false;
  std::string backend = "native";
  std::string opencl_device;
  std::optional<std::string> isa;
  int workers = 1;
  int threads = 0;  ///< of each worker; 0: all cores shared out among the workers
  int tile = 64;
  std::string launch;        ///< a command that starts the workers; empty: they are started here
  std::string listen;        ///< another address for watchers; empty: only the private socket
  std::string keys;          ///< folder of keys for `listen`; empty: none
  std::string tev;           ///< address of a tev that shows the render; empty: none
  bool interactive = false;  ///< watchers choose camera and samples
  std::uint32_t samples_per_pass = 16;
  std::optional<std::uint32_t> stop_after;        ///< samples per pixel, of those that spp plans
  std::optional<std::uint64_t> stop_after_units;  ///< of all tiles and passes, in their order
  std::optional<double> time_budget;
  std::optional<double> target_error;
  bool adaptive = false;  ///< tiles get samples by their errors
  double verify = 0;      ///< share of the units that two workers do
  std::optional<CropRectangle> crop;
  std::optional<PixelPosition> pixel;
  bool strict_numerics = false;  ///< a non-finite sample is an error
  bool quiet = false;
  bool estimate = false;  ///< say what it would cost, and render no image
  bool json = false;      ///< ... as JSON
  bool resume = false;    ///< says so where there is no checkpoint of an earlier process to go on with
  bool restart = false;   ///< does not go on with it, but replaces it
  double checkpoint_interval = kCheckpointInterval;  ///< seconds; 0: none
  // Of several scenes.
  bool force = false;   ///< also what is there unchanged
  std::string summary;  ///< file that says what became of each; empty: beside the images
};

/// Adds the options to a command; they are stored when it is parsed.
void add_scene_options(CLI::App& command, SceneOptions& options);
void add_render_options(CLI::App& command, RenderOptions& options);
/// The options of a scheduler that renders a window's requests.
void add_preview_options(CLI::App& command, RenderOptions& options);

/// "x0,y0,x1,y1" with 0 <= x0 < x1 and 0 <= y0 < y1; nothing if it is anything else.
std::optional<CropRectangle> parse_crop(const std::string& text);
/// "x,y", neither negative.
std::optional<PixelPosition> parse_pixel(const std::string& text);

}  // namespace penumbra
