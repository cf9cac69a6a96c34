// What comes from workers, and from watchers of an interactive render.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "kernels/host/sample_buffer.h"
#include "kernels/host/view.h"
#include "scheduler/plan/work_unit.h"
#include "scheduler/protocol/asset_manifest.h"
#include "scheduler/watch/watch_board.h"
#include "worker/device.h"

namespace penumbra {

/// The first arrival of a worker is Connected, the last is Gone. Texts are UTF-8 and of bounded length.
namespace arrivals {

struct Connected {
  WorkerId worker;
  std::string host;
  int pid;                ///< as the worker reports it; only for messages
  std::string key;        ///< identifies the process, see WorkerProcesses::claim
  std::string peer;       ///< where it is connected from, for people
  std::vector<Isa> isas;  ///< instruction sets that it says it has, ascending
};
struct Compiling {  ///< kernels, before it is ready
  WorkerId worker;
  std::string device;  ///< for people
};
struct Ready {
  WorkerId worker;
  JobId job;
  std::string device;  ///< for people
  DevicePreparation preparation;
  SceneBytes scene;
};
struct Leaving {  ///< the worker will end, for a reason of its own; units that it has will not come
  WorkerId worker;
  std::string reason;  ///< for people
};
struct Beat {  ///< the worker is alive
  WorkerId worker;
  std::uint64_t parts;  ///< of units that it has done so far
};
struct JobFailed {  ///< the worker cannot do this job at all
  WorkerId worker;
  JobId job;
  std::string message;
};
struct Result {  ///< checked: its size is the unit's, its checksum is right
  WorkerId worker;
  UnitId unit;
  std::uint32_t view;  ///< of the job, when the unit was given out
  SampleBuffer buffer;
  std::uint64_t hash;  ///< equal for results of equal content
  double busy_seconds;
  std::uint64_t peak_memory_bytes;
};
struct BadResult {
  WorkerId worker;
  UnitId unit;
  std::uint32_t view;  ///< of the job, when the unit was given out
  std::string why;
};
struct UnitFailed {
  WorkerId worker;
  UnitId unit;
  std::uint32_t view;  ///< of the job, when the unit was given out
  std::string message;
};
struct Gone {
  WorkerId worker;
};
struct Rung {};       ///< the source of jobs has something new
struct ViewChanged {  ///< by a watcher; numbers only grow
  JobId job;
  WatchView view;
};
struct SamplesWanted {  ///< by a watcher: so many of each pixel of the view
  JobId job;
  std::uint32_t view;
  std::uint32_t spp;
};

}  // namespace arrivals

using Arrival = std::variant<arrivals::Connected, arrivals::Compiling, arrivals::Ready, arrivals::Beat,
                             arrivals::JobFailed, arrivals::Result, arrivals::BadResult, arrivals::UnitFailed,
                             arrivals::Leaving, arrivals::Gone, arrivals::Rung, arrivals::ViewChanged,
                             arrivals::SamplesWanted>;

}  // namespace penumbra
