// What the window shows and how: plain values that the connection, the drawing passes and the panel share.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gl/histogram.h"
#include "gl/image_view.h"
#include "scheduler/image/tone_map.h"

namespace penumbra {

/// The layer that is shown. Without a closed form only kComposite (the image itself), kError and kNamed are
/// meaningful. kNamed: the PictureLayer of the settings' name.
enum class Layer { kComposite, kAnalytic, kDifference, kError, kNamed };

/// What is shown of a layer and its reference: the layer, the reference, the layer minus the reference, or
/// the relative error.
enum class ShownComparison { kNone, kReference, kDifference, kRelativeError };

struct DisplaySettings {
  Layer layer = Layer::kComposite;
  std::string named = {};  ///< kNamed: the layer
  ShownComparison comparison = ShownComparison::kNone;
  ToneOperator tone_map = ToneOperator::kClamp;
  bool false_color = false;    ///< colours show the luminance of an image, not its tone map
  float exposure = 0;          ///< stops: radiance is multiplied by 2^exposure
  float alpha = 1;             ///< of the control variate
  bool outlines = false;       ///< of the tiles that workers are rendering, in a colour per worker
  bool automatic = false;      ///< keep refining
  bool relative_error = true;  ///< kError: standard error over brightness; else times 2^exposure
  bool denoise = false;        ///< kComposite: the denoised picture
  bool panel = true, help = false;
  ImageView view = {};
};

/// kEnded: the render is finished, and everything has arrived. kFile: a file is shown, not a render.
enum class ConnectionState { kStarting, kConnected, kLost, kRefused, kEnded, kFile };

/// A worker, for the panel's list and the outline of its tile.
struct WorkerView {
  std::uint32_t number = 0;  ///< selects its colour
  std::string name, device;
  int x = 0, y = 0, width = 0, height = 0;  ///< film pixels that it is rendering; width 0: none
  std::uint64_t units = 0;
};

/// The film pixel below the mouse.
struct PixelValue {
  int x = 0, y = 0;
  std::array<float, 3> value{};  ///< what is shown there, linear
  std::string of = {};           ///< what that is, if it is not the layer as it was rendered: "difference"
  float samples = 0;             ///< 0: what is shown has none
  std::optional<float> standard_error = {};
  /// A value that is NaN is the same as itself.
  bool operator==(const PixelValue& other) const {
    using Bits = std::array<std::uint32_t, 3>;
    return x == other.x && y == other.y && std::bit_cast<Bits>(value) == std::bit_cast<Bits>(other.value) &&
           of == other.of && samples == other.samples && standard_error == other.standard_error;
  }
};

/// How a layer differs from the reference, over the pixels that both have and whose values are finite.
struct Difference {
  double mean = 0;    ///< of layer minus reference, over channels
  double relmse = 0;  ///< mean of (layer - reference)² / (reference² + 0.01)
  bool operator==(const Difference&) const = default;
};

/// kWaiting: the summary of the renders says that the frame is to come, even where there is an older file.
/// kFailed: it says that it failed.
enum class FrameState { kThere, kWaiting, kFailed, kMissing };

struct ShotFrame {
  int number = 0;
  FrameState state = FrameState::kMissing;
  bool has_file = false;
  bool is_read = false;  ///< in memory
};

/// The frames of a shot whose files are shown.
struct ShotStatus {
  std::vector<ShotFrame> frames = {};  ///< ascending
  int current = 0;                     ///< where the shot stands
  std::optional<int> shown = {};       ///< of which frame the picture is; that before, where there is none
  bool plays = false;
  double fps = 0;
  double shown_per_second = 0;  ///< while it plays
  std::uint64_t skipped = 0;    ///< frames since it plays for which there was no time
};

/// The state of the watched render, or of the file.
struct ViewStatus {
  ConnectionState connection = ConnectionState::kStarting;
  std::string address;
  std::string scene, integrator;
  bool hybrid = false;       ///< the closed form is drawn here, the difference comes from workers
  bool interactive = false;  ///< the camera can be moved
  bool has_camera = false;   ///< the camera is known
  bool finished = false;     ///< all requested samples are merged
  int film_width = 0, film_height = 0;
  std::uint64_t samples_done = 0, samples_total = 0;  ///< of all pixels, in the current view
  std::uint32_t spp_done = 0, spp_wanted = 0;         ///< passes merged in every tile; requested passes
  double samples_per_second = 0;
  double seconds_left = 0;     ///< NaN: unknown
  double relative_error = 0;   ///< NaN: unknown
  double latency_seconds = 0;  ///< from requesting samples to their first tile; NaN: none yet
  double frames_per_second = 0;
  int analytic_frames = 0;      ///< frames of the closed form averaged for antialiasing
  std::uint32_t scene_spp = 0;  ///< samples per pixel that the scene asks for; 0: unknown
  std::vector<std::string> named_layers;
  std::string reference;  ///< name of the picture to compare with; empty: none
  std::optional<Difference> difference;
  std::optional<PixelValue> pixel;
  Histogram histogram;
  std::optional<ShotStatus> shot;  ///< nothing: what is shown is no shot
  std::vector<WorkerView> workers;
  std::vector<std::string> messages;  ///< newest last; how it is shown: see message_kind
};

}  // namespace penumbra
