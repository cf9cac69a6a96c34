// The scheduler's end of the wire: accepts workers, passes their messages to one consumer, sends them jobs
// and units.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/farm/acceptor.h"
#include "scheduler/farm/access.h"
#include "scheduler/farm/arrivals.h"
#include "scheduler/farm/offered_asset.h"
#include "scheduler/farm/service_maker.h"
#include "scheduler/plan/work_unit.h"
#include "scheduler/watch/watch_board.h"
#include "worker/device.h"

namespace penumbra {

struct ListenOptions {
  std::string address;  ///< of this scheduler's own workers, e.g. "unix:/run/user/1000/penumbra-x/socket"
  /// A second address, for viewers and foreign workers: "unix:/path", or "127.0.0.1:port" (also
  /// "[::1]:port"), where a token is required; with keys any host's. Port 0 is any free port. Connections
  /// there never keep the scheduler's own workers out.
  std::string more = {};
  std::shared_ptr<const Keys> keys = {};  ///< of `more`, where it is TCP: TLS, and their tokens
  bool comes_back = false;  ///< workers that are sent away at the end are told to look for it again
  /// Bytes of the largest unit's samples: larger messages are not taken.
  std::size_t largest_result = std::size_t(1) << 20;
  AcceptorLimits limits = {};  ///< of `more`
  ServiceMaker service = {};   ///< further calls at `more`
};

/// gRPC's threads read, check, decode and write, of workers as their streams need it; `next` gives the
/// arrivals to the one thread that drives the plan. Sending to a worker that is gone does nothing: its Gone
/// is on the way.
class Server {
 public:
  /// Errors: an address that is taken, makes no sense, or is of other hosts too,
  /// which would need encryption.
  static Expected<std::unique_ptr<Server>> listen(const ListenOptions& options);
  /// Dismisses the remaining workers, breaks all streams that do not end very soon, and waits for the
  /// threads.
  ~Server();

  /// Where `ListenOptions::more` can be reached, with the port that was chosen; empty if there was none.
  [[nodiscard]] const std::string& more_address() const;
  /// The tokens for calls over TCP; empty if there are none. Those of keys are not to be printed.
  [[nodiscard]] const Tokens& tokens() const;

  /// Offers data to workers, under its manifest's hash.
  void add_asset(OfferedAsset asset);
  /// What nobody needs any more.
  void remove_asset(const std::string& hash);
  /// A job that can be watched from now on; `interactive` ones take Control.
  void show_job(JobId job, std::shared_ptr<WatchBoard> board, bool interactive);
  /// It is over; its board is to be closed.
  void hide_job(JobId job);

  void send_job(WorkerId worker, JobId job, const std::string& scene_hash, const DeviceOptions& device);
  void forget_job(WorkerId worker, JobId job);
  /// `layers`: that the result must have.
  void send_unit(WorkerId worker, const UnitId& id, const RenderUnit& unit, const FilmLayers& layers);
  /// Another camera for the job's units that follow; those of older views are dropped by the worker, and
  /// their results here.
  void send_view(WorkerId worker, JobId job, const WatchView& view);
  /// The number of the job's next view, where it begins anew without a watcher's wish.
  [[nodiscard]] std::uint32_t next_view_number(JobId job);
  /// Its later messages are ignored.
  void dismiss(WorkerId worker, const std::string& reason);
  /// Sends a worker away that cannot do the job; it says the reason to its user and fails.
  void refuse(WorkerId worker, const std::string& reason);

  /// Lets the one who waits for the next arrival have one, Rung. From any thread.
  void wake();
  /// Nothing that arrives from here on is wanted: no stream waits for room any more.
  void stop_taking();
  /// The next arrival, waiting for it at most so long.
  std::optional<Arrival> next(std::chrono::milliseconds patience);

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state);
  Expected<void> listen_for_own(const ListenOptions& options);
  Expected<void> listen_for_all(const ListenOptions& options);
  std::unique_ptr<State> state_;
};

}  // namespace penumbra
