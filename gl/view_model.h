// What the window shows and how: plain values between the connection, the passes that draw and the panel.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace penumbra {

/// What fills the picture. Without a closed form only kComposite (the image itself) and kError mean anything.
enum class Layer { kComposite, kAnalytic, kDifference, kError };
enum class ToneMap { kClamp, kReinhard, kFilmic };

struct DisplaySettings {
  Layer layer = Layer::kComposite;
  ToneMap tone_map = ToneMap::kClamp;
  float exposure = 0;          ///< stops: radiance is multiplied by 2^exposure
  float alpha = 1;             ///< of the control variate
  bool outlines = false;       ///< of the tiles that workers have in hand, in a colour for each worker
  bool automatic = false;      ///< refine until told otherwise
  bool relative_error = true;  ///< kError: standard error over brightness, else times 2^exposure
  bool panel = true, help = false;
};

/// kEnded: the render is over, and all of it has come.
enum class ConnectionState { kStarting, kConnected, kLost, kRefused, kEnded };

/// A worker, as the panel lists it and as its tile is outlined.
struct WorkerView {
  std::uint32_t number = 0;  ///< its colour
  std::string name, device;
  int x = 0, y = 0, width = 0, height = 0;  ///< film pixels it has in hand; no width: none
  std::uint64_t units = 0;
};

/// What is known of the render that is watched.
struct ViewStatus {
  ConnectionState connection = ConnectionState::kStarting;
  std::string address;
  std::string scene, integrator;
  bool hybrid = false;       ///< the closed form is drawn here, the difference comes from workers
  bool interactive = false;  ///< the camera can be moved
  bool finished = false;     ///< all samples that were asked for are merged
  int film_width = 0, film_height = 0;
  std::uint64_t samples_done = 0, samples_total = 0;  ///< over all pixels, of the present view
  std::uint32_t spp_done = 0, spp_wanted = 0;         ///< passes merged in every tile; asked for
  double samples_per_second = 0;
  double seconds_left = 0;     ///< NaN: unknown
  double relative_error = 0;   ///< NaN: unknown
  double latency_seconds = 0;  ///< from asking for samples to the first tile of them; NaN: none yet
  double frames_per_second = 0;
  int analytic_frames = 0;  ///< frames of the closed form averaged into its antialiasing
  std::vector<WorkerView> workers;
  std::vector<std::string>
      messages;  ///< newest last; what begins with "error:" or "warning:" is shown as such
};

}  // namespace penumbra
