// A device that renders nothing, and the faults that its worker process can show.
#pragma once

#include <memory>
#include <string>

#include "kernels/host/device_scene.h"
#include "worker/device.h"

namespace penumbra {

/// A scene that carries only a film size and whether there are feature layers; as valid as a real one on the
/// wire.
DeviceScene fake_scene(int film_width, int film_height, bool features);

/// What a fake worker does. The scheduler passes nothing but an address to its workers, so the behaviour
/// travels in environment variables, one for each field: PENUMBRA_FAKE_ and the name in capitals. A "claim"
/// is a file that the first process to create it owns: exactly one of all workers, including those started
/// later, behaves so. Of vanish_claim there are three, with a number each.
struct FakeBehaviour {
  int delay_ms = 0;               ///< for each unit
  std::string crash_at = {};      ///< "x,y,first_sample": at this unit the process is killed by a signal
  std::string fail_at = {};       ///< likewise: the device reports an error
  std::string hang_claim = {};    ///< hangs for ever in its second unit
  std::string lie_claim = {};     ///< returns wrong values, which still look like a result
  std::string damage_claim = {};  ///< returns a buffer of the wrong size
  std::string nan_claim = {};     ///< returns a NaN among the values and counts none
  int liar_delay_ms = 0;          ///< how late the liar is with its first unit
  int die_at_start = 0;           ///< 1: the process ends before it connects
  std::string vanish_claim = {};  ///< closes its connection while it prepares its job, and stays
  int deadly_scene = 0;           ///< the process dies when it prepares one whose camera has this x
  int prepare_ms = 0;             ///< for a job, of those that do not vanish
  int no_device = 0;              ///< 1: the device cannot be made
  int fail_always = 0;            ///< 1: every unit fails
  int isas = 3;                   ///< how many instruction sets the worker says it has, from sse2 on

  void to_environment() const;  ///< of this process and its future children
  static FakeBehaviour from_environment();
};

/// fake_samples() of each unit, shifted by the x of the camera's origin, save for what the behaviour says.
Expected<std::unique_ptr<Device>> make_fake_device(const DeviceScene& scene, const DeviceOptions& options,
                                                   const FakeBehaviour& behaviour);

}  // namespace penumbra
