// Events that arrive from workers, and from viewers of an interactive render.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "kernels/host/sample_buffer.h"
#include "kernels/host/view.h"
#include "scheduler/watch/watch_board.h"
#include "worker/device.h"
#include "worker/protocol/asset_manifest.h"
#include "worker/work_unit.h"

namespace penumbra {

/// A worker's first event is Connected, its last one Gone. Texts are UTF-8 and of limited length.
namespace arrivals {

struct Connected {
  WorkerId worker;
  std::string host;
  int pid;                ///< as reported by the worker; only for messages
  std::string key;        ///< identifies the process; see WorkerProcesses::claim
  std::string peer;       ///< the address of the connection, for messages
  std::vector<Isa> isas;  ///< instruction sets that the worker claims to support, ascending
};
struct Compiling {  ///< the worker compiles kernels before it is ready
  WorkerId worker;
  std::string device;  ///< for messages
};
struct Ready {
  WorkerId worker;
  JobId job;
  std::string device;  ///< for messages
  DevicePreparation preparation;
  SceneBytes scene;
};
struct Leaving {  ///< the worker is about to end for a reason of its own; it will not finish its units
  WorkerId worker;
  std::string reason;  ///< for messages
};
struct Beat {  ///< heartbeat: the worker is alive
  WorkerId worker;
  /// Grows with progress: the number of parts of units that it has finished so far, and of parts of results
  /// that have come.
  std::uint64_t parts;
};
struct JobFailed {  ///< the worker cannot render this job at all
  WorkerId worker;
  JobId job;
  std::string message;
};
struct Result {  ///< a valid result: its size matches the unit and its checksum is correct
  WorkerId worker;
  UnitId unit;
  std::uint32_t view;  ///< the job's view when the unit was issued
  SampleBuffer buffer;
  std::uint64_t hash;  ///< equal for results with equal contents
  double busy_seconds;
  std::uint64_t peak_memory_bytes;
  std::shared_ptr<void> room;  ///< held while the buffer exists; see ResultRoom
};
struct BadResult {
  WorkerId worker;
  UnitId unit;
  std::uint32_t view;  ///< the job's view when the unit was issued
  std::string why;
};
struct UnitFailed {
  WorkerId worker;
  UnitId unit;
  std::uint32_t view;  ///< the job's view when the unit was issued
  std::string message;
};
struct Gone {
  WorkerId worker;
};
struct JobsNotified {};  ///< the job source has news (see JobSignal)
struct ViewChanged {     ///< a viewer changed the view; view numbers only increase
  JobId job;
  WatchView view;
};
struct SamplesWanted {  ///< a viewer requests this many samples per pixel of the view
  JobId job;
  std::uint32_t view;
  std::uint32_t spp;
};

}  // namespace arrivals

using Arrival = std::variant<arrivals::Connected, arrivals::Compiling, arrivals::Ready, arrivals::Beat,
                             arrivals::JobFailed, arrivals::Result, arrivals::BadResult, arrivals::UnitFailed,
                             arrivals::Leaving, arrivals::Gone, arrivals::JobsNotified, arrivals::ViewChanged,
                             arrivals::SamplesWanted>;

}  // namespace penumbra
