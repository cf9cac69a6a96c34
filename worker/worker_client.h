// The worker's end of the wire: connects to a scheduler, fetches the scene, renders the units it is given.
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
#include "worker/piece_cache.h"

namespace penumbra {

using DeviceFactory =
    std::function<Expected<std::unique_ptr<Device>>(const DeviceScene& scene, const DeviceOptions& options)>;

struct WorkerClientOptions {
  std::string address;          ///< "unix:/path" or "host:port"
  std::string token;            ///< what the scheduler printed for workers; none over a Unix socket
  double connect_timeout = 10;  ///< seconds
  std::vector<Isa> isas;        ///< what this machine has, for the scheduler's choice
  // Settings of this machine's owner, which replace those of the job.
  std::optional<Backend> backend;
  std::optional<Isa> isa;
  std::optional<int> threads;
  std::optional<std::string> opencl_device;

  std::filesystem::path cache;                   ///< folder for pieces of scenes; empty: none is used
  std::uint64_t cache_bytes = kPieceCacheBytes;  ///< at most

  DeviceFactory make_device;
  /// When a stop is requested, the worker says that it leaves, and why, and gives back what it has at once.
  /// When the request returns, that is done; the unit in hand cannot be interrupted, so a process wants to
  /// end then. Else `run_worker` returns after it.
  std::stop_token leave = {};
  std::string leave_reason = "it was told to end";
  /// Called from another thread when the connection breaks, perhaps in the middle of a unit, which cannot be
  /// interrupted: a process wants to end here. May be empty; then `run_worker` returns after the unit.
  std::function<void(const Error&)> on_connection_lost;
};

/// Works until the scheduler has no more work. Fails if the connection cannot be made or breaks, if the
/// scheduler refuses this worker, or if no job could be done here (no such device, damaged scene). Results
/// leave from a thread of their own, so that the next unit does not wait for the network.
Expected<void> run_worker(const WorkerClientOptions& options);

}  // namespace penumbra
