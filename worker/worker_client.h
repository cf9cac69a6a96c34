// The worker's side of the protocol: connects to a scheduler, downloads scenes, and renders the units that it
// gets.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "worker/device.h"
#include "worker/keys/key_folder.h"
#include "worker/piece_cache.h"

namespace penumbra {

using DeviceFactory =
    std::function<Expected<std::unique_ptr<Device>>(const DeviceScene& scene, const DeviceOptions& options)>;

struct WorkerClientOptions {
  std::string address;                    ///< "unix:/path", "host:port", or "file:path"; see address_file.h
  std::string token;                      ///< access token of workers; empty over a Unix socket
  std::shared_ptr<const Keys> keys = {};  ///< for an encrypted connection
  /// Seconds during which the worker tries to reach a scheduler that does not answer, since its last sign of
  /// life.
  double retry_for = 10;
  /// Whether to reconnect after a lost connection; not for a worker that a scheduler has started, which ends
  /// with it.
  bool reconnects = false;
  std::vector<Isa> isas;  ///< supported by this machine, for the scheduler's choice
  // Settings of this machine's user, which override those of the job.
  std::optional<Backend> backend;
  std::optional<Isa> isa;
  std::optional<int> threads;
  std::optional<std::string> opencl_device;

  std::filesystem::path cache;                   ///< folder for pieces of scenes; empty: no cache
  std::uint64_t cache_bytes = kPieceCacheBytes;  ///< size limit of that folder

  DeviceFactory make_device;
  /// On a stop request, the worker tells the scheduler that it leaves and why, and returns its unit at once.
  /// When the request returns, this is done. The current unit cannot be interrupted, so a process should end
  /// then; otherwise `run_worker` returns after the unit.
  std::stop_token leave = {};
  std::string leave_reason = "it was told to end";
  /// Called from another thread when the connection is lost for good, possibly during a unit, which cannot be
  /// interrupted: a process should end here. May be empty; then `run_worker` returns after the unit.
  std::function<void(const Error&)> on_connection_lost = {};
  /// Called with a text for users: what the worker waits for and how much longer, when that changes and every
  /// `reminder` seconds; that the render had ended before. May be empty.
  std::function<void(const std::string&)> on_waiting = {};
  double reminder = 120;
};

/// Works until the scheduler has no more work, or an address file says that the render has ended. If the
/// connection is lost, or the scheduler restarts, it returns an error or reconnects with growing pauses.
/// Errors: no scheduler is found for `retry_for` seconds; at once if the scheduler refuses this worker
/// (version, token), is on another host and there are no keys, or if no job could be rendered here (no such
/// device, damaged scene). An address file is read again for each attempt, and a new address in it is tried
/// at once. Results are sent by a thread of their own, so that the next unit does not wait for the network.
Expected<void> run_worker(const WorkerClientOptions& options);

}  // namespace penumbra
