// What to render and how: the one value that the command line and job files fill, `penumbra submit` sends, a
// checkpoint is known by, and records and statistics print. Its rows are in render_option.h.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/plan/plan_options.h"
#include "worker/device.h"

namespace penumbra {

/// The integrator of a render whose technique is chosen by pilot renders (scheduler/advise/).
constexpr const char* kAutoIntegrator = "auto";

/// The options that determine the scene; `render` and `info` share them.
struct SceneOptions {
  std::string file = {};                   ///< as named by the user
  std::vector<std::string> defines = {};   ///< name=value
  std::vector<std::string> settings = {};  ///< key=value
  std::optional<double> scale = {};        ///< of the film, after `settings`; see film_scale.h; not 1
  std::string blender = {};                ///< program that exports .blend files
  std::string blender_scene = {}, camera = {}, view_layer = {};  ///< of .blend files; empty: the file's
  bool lenient = false;
  bool strict = false;
  std::string dialect = {};                    ///< empty: determined from the scene file
  std::optional<std::string> integrator = {};  ///< one of the names of integrator.type, or kAutoIntegrator
  std::optional<std::string> sampler = {};     ///< one of the names of sampler.type, or "scene"
  bool needs_independent = false;              ///< an independent sampler of the scene is not replaced
  bool excludes_photons = false;               ///< kAutoIntegrator chooses no integrator with photons
  std::optional<std::uint32_t> spp = {};
  std::optional<std::uint32_t> seed = {};
  std::string intersector = "auto";  ///< auto, portable, embree
  bool no_features = false;
  bool cryptomatte = false;
  std::string denoise = {};       ///< one of the names of film.denoise; empty: the scene's
  std::string layers = {};        ///< a value of film.layers; empty: the scene's
  std::optional<int> frame = {};  ///< of a shot; its time is frame_seconds() (frames.h); nothing: a still
  std::optional<double> fps = {};
  double frame_offset = 0;
  /// The shot's first frame, for which kAutoIntegrator chooses; nothing: it chooses for each frame.
  std::optional<int> shot_begin = {};
  bool frame_is_a_file = false;  ///< each frame is a file of its own, whose name has the frame
  std::string clip = {};         ///< see ReadOptions
  bool seed_by_frame = false;    ///< the frame is added to the seed
  bool blends_frames = false;    ///< where images are denoised, the layer motion is asked for

  friend auto operator<=>(const SceneOptions&, const SceneOptions&) = default;
};

/// A rectangle of film pixels; x1 and y1 are exclusive.
struct CropRectangle {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct PixelPosition {
  int x = 0, y = 0;
};

struct RenderRequest {
  SceneOptions scene = {};
  std::optional<CropRectangle> crop = {};
  std::optional<PixelPosition> pixel = {};
  PlanOptions plan{.samples_per_pass = 0, .tile = 0};  ///< 0: by the integrator, see plan_of
  /// Seconds of rendering, including an earlier process, after which no further unit is started. The first
  /// pass is always rendered, and the image then counts as complete.
  std::optional<double> time_budget = {};
  double verify = 0;  ///< the fraction of units that a second worker renders too, to compare the results
  int threads = 0;    ///< of each worker; 0: all cores, divided among the workers
  Backend backend = Backend::kNative;
  std::string opencl_device = {};  ///< see DeviceOptions
  std::string isa = {};            ///< of the native backend; empty: the widest of the machine
  std::string out = {};            ///< empty: named after the scene, in the current folder
  std::string statistics = {};
  bool no_statistics = false;
  bool strict_numerics = false;  ///< a non-finite sample is an error
};

}  // namespace penumbra
