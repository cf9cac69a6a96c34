// The scheduler's end of the wire: accepts workers, hands what they say to one consumer, sends them jobs and
// units.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "kernels/host/error.h"
#include "kernels/host/sample_buffer.h"
#include "kernels/host/view.h"
#include "scheduler/watch/watch_board.h"
#include "scheduler/work_unit.h"
#include "worker/device.h"

namespace penumbra {

/// What comes from workers, and from watchers of an interactive render. The first arrival of a worker is
/// Connected, the last is Gone.
namespace arrivals {

struct Connected {
  WorkerId worker;
  std::string host;
  int pid;
  std::vector<Isa> isas;  ///< instruction sets that it says it has, ascending
};
struct Compiling {  ///< kernels, before it is ready
  WorkerId worker;
  std::string device;  ///< for people
};
struct Ready {
  WorkerId worker;
  std::string device;  ///< for people
  DevicePreparation preparation;
};
struct Beat {  ///< the worker is alive
  WorkerId worker;
  std::uint64_t parts;  ///< of units that it has done so far
};
struct JobFailed {  ///< the worker cannot do this job at all
  WorkerId worker;
  std::string message;
};
struct Result {  ///< checked: its size is the unit's, its checksum is right
  WorkerId worker;
  UnitId unit;
  SampleBuffer buffer;
  std::uint64_t hash;  ///< equal for results of equal content
  double busy_seconds;
  std::uint64_t peak_memory_bytes;
};
struct BadResult {
  WorkerId worker;
  UnitId unit;
  std::string why;
};
struct UnitFailed {
  WorkerId worker;
  UnitId unit;
  std::string message;
};
struct Gone {
  WorkerId worker;
};
struct ViewChanged {  ///< by a watcher; numbers only grow
  WatchView view;
};
struct SamplesWanted {  ///< by a watcher: so many of each pixel of the view
  std::uint32_t view;
  std::uint32_t spp;
};

}  // namespace arrivals

using Arrival = std::variant<arrivals::Connected, arrivals::Compiling, arrivals::Ready, arrivals::Beat,
                             arrivals::JobFailed, arrivals::Result, arrivals::BadResult, arrivals::UnitFailed,
                             arrivals::Gone, arrivals::ViewChanged, arrivals::SamplesWanted>;

struct ListenOptions {
  std::string address;  ///< for everybody, e.g. "unix:/run/user/1000/penumbra-x/socket"
  /// Another one: "unix:/path", or "127.0.0.1:port" (also "[::1]:port"), port 0 for any that is free, where a
  /// token is asked for.
  std::string more = {};
  bool interactive = false;  ///< takes Control
};

/// One thread for each connected worker reads, checks and decodes; `next` gives the arrivals to the one
/// thread that drives the plan. Sending to a worker that is gone does nothing: its Gone is on the way.
class Server {
 public:
  /// Watchers see the board. Errors: an address that is taken, makes no sense, or is of other hosts too,
  /// which would need encryption.
  static Expected<std::unique_ptr<Server>> listen(const ListenOptions& options, WatchBoard& board);
  /// Breaks all streams that do not end by themselves very soon, and waits for the threads.
  ~Server();

  /// Where `ListenOptions::more` can be reached, with the port that was chosen; empty if there was none.
  [[nodiscard]] const std::string& more_address() const;
  /// What TCP connections must know; empty if there are none.
  [[nodiscard]] const std::string& token() const;

  /// Offers data to workers; the result is its content hash.
  std::string add_asset(std::vector<std::uint8_t> bytes);
  void send_job(WorkerId worker, const std::string& scene_hash, const DeviceOptions& device);
  /// `planes`: how many the result must have, see SampleBuffer.
  void send_unit(WorkerId worker, const UnitId& id, const RenderUnit& unit, int planes);
  /// Another camera for the units that follow; those of older views are dropped by the worker, and their
  /// results here.
  void send_view(WorkerId worker, const WatchView& view);
  void dismiss(WorkerId worker, const std::string& reason);
  /// Sends a worker away that cannot do the job; it says the reason to its user and fails.
  void refuse(WorkerId worker, const std::string& reason);

  /// The next arrival, waiting for it at most so long.
  std::optional<Arrival> next(std::chrono::milliseconds patience);

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace penumbra
