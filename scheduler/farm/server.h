// The scheduler's side of the connection to workers: accepts them, passes their messages to one consumer,
// sends them jobs and units.
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
#include "scheduler/watch/watch_board.h"
#include "worker/device.h"
#include "worker/work_unit.h"

namespace penumbra {

struct ListenOptions {
  /// The address for this scheduler's own workers: "unix:/run/user/1000/penumbra-x/socket"
  std::string address;
  /// A second address, for viewers and for workers started by others: "unix:/path", or "127.0.0.1:port" (also
  /// "[::1]:port"), where a token is required. With keys it may be an address of any interface. Port 0 means
  /// any free port. Connections there never prevent the scheduler's own workers from connecting.
  std::string more = {};
  std::shared_ptr<const Keys> keys = {};  ///< the keys for `more` if it is TCP: for TLS, and their tokens
  std::string watch_token = {};           ///< without keys: the token for watching; empty: a random one
  bool comes_back = false;  ///< workers dismissed at the end are told that the scheduler will return
  /// Bytes of memory for results that arrive in parts. If that is not enough for all at a time, some wait.
  std::size_t room_for_results = std::size_t(1) << 30;
  AcceptorLimits limits = {};  ///< limits for `more`
  ServiceMaker service = {};   ///< additional calls served at `more`
};

/// gRPC's threads read, check, decode and write messages as the workers' streams require. `next` passes the
/// events to the one thread that drives the plan. Sending to a worker that is gone has no effect; its Gone
/// event is on the way.
class Server {
 public:
  /// Errors: an address that is in use, invalid, or reachable from other hosts without keys.
  static Expected<std::unique_ptr<Server>> listen(const ListenOptions& options);
  /// Sets ListenOptions::comes_back.
  void will_come_back();
  /// Dismisses the remaining workers, breaks streams that do not end soon, and joins the threads.
  ~Server();

  /// The address of `ListenOptions::more` with its actual port; empty if there is none.
  [[nodiscard]] const std::string& more_address() const;
  /// The tokens for calls over TCP; empty if there are none. Tokens from keys must not be printed.
  [[nodiscard]] const Tokens& tokens() const;

  /// Offers data to workers under the hash of its manifest.
  void add_asset(OfferedAsset asset);
  /// Removes an asset that nobody needs any more.
  void remove_asset(const std::string& hash);
  /// Makes a job visible to viewers. An `interactive` job accepts Control.
  void show_job(JobId job, std::shared_ptr<WatchBoard> board, bool interactive);
  /// The job is over. The caller closes its board.
  void hide_job(JobId job);

  void send_job(WorkerId worker, JobId job, const std::string& scene_hash, const DeviceOptions& device);
  void forget_job(WorkerId worker, JobId job);
  /// `layers`: the layers that the result must have.
  void send_unit(WorkerId worker, const UnitId& id, const RenderUnit& unit, const FilmLayers& layers);
  /// Sets another camera for the following units of the job. The worker drops its units of older views, and
  /// their results are dropped here.
  void send_view(WorkerId worker, JobId job, const WatchView& view);
  /// Reserves the job's next view number, for a restart that no viewer requested.
  [[nodiscard]] std::uint32_t next_view_number(JobId job);
  /// Dismisses a worker. Its later messages are ignored.
  void dismiss(WorkerId worker, const std::string& reason);
  /// Sends away a worker that cannot render the job. It prints the reason and exits with an error.
  void refuse(WorkerId worker, const std::string& reason);

  /// Makes next() return a JobsNotified event. May be called from any thread.
  void wake();
  /// Drops all further events, so that no stream waits for room in the mailbox.
  void stop_taking();
  /// The next event, waiting at most `patience`.
  std::optional<Arrival> next(std::chrono::milliseconds patience);

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state);
  Expected<void> listen_for_own(const ListenOptions& options);
  Expected<void> listen_for_all(const ListenOptions& options);
  std::unique_ptr<State> state_;
};

}  // namespace penumbra
