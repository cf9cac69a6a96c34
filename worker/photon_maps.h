// The photon maps of the units that a device renders. Units of one pass share a map; the last maps are kept.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <vector>

#include "kernels/host/device_scene.h"
#include "kernels/host/error.h"
#include "kernels/host/photon_map_builder.h"
#include "worker/device.h"

namespace penumbra {

struct MadePhotonMaps {
  PhotonTask task;
  AlignedVector<std::uint32_t> words;  ///< see photon/photon_map.h
  std::uint64_t number;                ///< each one that the device makes has another
};

class PhotonMaps {
 public:
  /// Traces the photon paths of a task. Photons of one path are in the order of their edges.
  using Trace = std::function<Expected<std::vector<Photon>>(const PhotonTask& task)>;
  explicit PhotonMaps(Trace trace) : trace_(std::move(trace)) {}

  /// The maps for a unit; null if the scene has no photons. Valid until the next call but one.
  Expected<const MadePhotonMaps*> of_unit(const SceneHeader& header, const RenderUnit& unit);

 private:
  Trace trace_;
  std::list<MadePhotonMaps> kept_;  ///< the last used ones are at the front
  std::uint64_t made_ = 0;
};

}  // namespace penumbra
