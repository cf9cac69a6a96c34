// The worker's end of the wire: connects to a scheduler, fetches the scene, renders the units it is given.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/keys/key_folder.h"
#include "worker/device.h"

namespace penumbra {

using DeviceFactory =
    std::function<Expected<std::unique_ptr<Device>>(const DeviceScene& scene, const DeviceOptions& options)>;

struct WorkerClientOptions {
  std::string address;                    ///< "unix:/path" or "host:port"
  std::string token;                      ///< of workers; none over a Unix socket
  std::shared_ptr<const Keys> keys = {};  ///< of an encrypted connection
  /// Seconds for which a scheduler is looked for that is not there yet, or no more; from its last sign of
  /// life.
  double retry_for = 10;
  /// Whether another connection is tried when one is lost; not by a worker that a scheduler has started,
  /// which ends with it.
  bool reconnects = false;
  std::vector<Isa> isas;  ///< what this machine has, for the scheduler's choice
  // Settings of this machine's owner, which replace those of the job.
  std::optional<Backend> backend;
  std::optional<Isa> isa;
  std::optional<int> threads;
  std::optional<std::string> opencl_device;

  DeviceFactory make_device;
  /// Called from another thread when the connection has broken for good, perhaps in the middle of a unit,
  /// which cannot be interrupted: a process wants to end here. May be empty; then `run_worker` returns after
  /// the unit.
  std::function<void(const Error&)> on_connection_lost = {};
  /// What is waited for, for people; may be empty.
  std::function<void(const std::string&)> on_waiting = {};
};

/// Works until the scheduler has no more work. Where the connection breaks, or the scheduler is stopped to be
/// started again, it fails, or tries another one with pauses that grow. Fails if no scheduler is found for
/// `retry_for` seconds; at once if it refuses this worker (version, token), or if no job could be done here
/// (no such device, damaged scene). Results leave from a thread of their own, so that the next unit does not
/// wait for the network.
Expected<void> run_worker(const WorkerClientOptions& options);

}  // namespace penumbra
