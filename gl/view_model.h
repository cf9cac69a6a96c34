// What the window shows and how: plain values that the connection, the drawing passes and the panel share.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace penumbra {

/// The layer that is shown. Without a closed form only kComposite (the image itself) and kError are
/// meaningful.
enum class Layer { kComposite, kAnalytic, kDifference, kError };
enum class ToneMap { kClamp, kReinhard, kFilmic };

struct DisplaySettings {
  Layer layer = Layer::kComposite;
  ToneMap tone_map = ToneMap::kClamp;
  float exposure = 0;          ///< stops: radiance is multiplied by 2^exposure
  float alpha = 1;             ///< of the control variate
  bool outlines = false;       ///< of the tiles that workers are rendering, in a colour per worker
  bool automatic = false;      ///< keep refining
  bool relative_error = true;  ///< kError: standard error over brightness; else times 2^exposure
  bool denoise = false;        ///< kComposite: the denoised picture
  bool panel = true, help = false;
};

/// kEnded: the render is finished, and everything has arrived.
enum class ConnectionState { kStarting, kConnected, kLost, kRefused, kEnded };

/// A worker, for the panel's list and the outline of its tile.
struct WorkerView {
  std::uint32_t number = 0;  ///< selects its colour
  std::string name, device;
  int x = 0, y = 0, width = 0, height = 0;  ///< film pixels that it is rendering; width 0: none
  std::uint64_t units = 0;
};

/// The state of the watched render.
struct ViewStatus {
  ConnectionState connection = ConnectionState::kStarting;
  std::string address;
  std::string scene, integrator;
  bool hybrid = false;       ///< the closed form is drawn here, the difference comes from workers
  bool interactive = false;  ///< the camera can be moved
  bool finished = false;     ///< all requested samples are merged
  int film_width = 0, film_height = 0;
  std::uint64_t samples_done = 0, samples_total = 0;  ///< of all pixels, in the current view
  std::uint32_t spp_done = 0, spp_wanted = 0;         ///< passes merged in every tile; requested passes
  double samples_per_second = 0;
  double seconds_left = 0;     ///< NaN: unknown
  double relative_error = 0;   ///< NaN: unknown
  double latency_seconds = 0;  ///< from requesting samples to their first tile; NaN: none yet
  double frames_per_second = 0;
  int analytic_frames = 0;  ///< frames of the closed form averaged for antialiasing
  std::vector<WorkerView> workers;
  std::vector<std::string>
      messages;  ///< newest last; "error:" or "warning:" at the start decides how it is shown
};

}  // namespace penumbra
