#include "worker/photon_maps.h"

#include <algorithm>
#include <utility>

namespace penumbra {
namespace {

// A worker may go on with an old pass while it has begun a new one.
constexpr std::size_t kKeptMaps = 2;

bool is_same(const PhotonTask& a, const PhotonTask& b) {
  return a.map == b.map && a.sequence == b.sequence && a.paths == b.paths;
}

}  // namespace

Expected<const MadePhotonMaps*> PhotonMaps::of_unit(const SceneHeader& header, const RenderUnit& unit) {
  if (header.integrator.photons == PHOTONS_NONE) return nullptr;
  const PhotonTask task = photon_task(header.integrator, unit.first_sample, unit.sequence);
  const auto known = std::ranges::find_if(kept_, [&](const auto& kept) { return is_same(kept.task, task); });
  if (known != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, known);
    return &kept_.front();
  }
  while (kept_.size() >= kKeptMaps) kept_.pop_back();
  Expected<std::vector<Photon>> photons = trace_(task);
  if (!photons) return std::unexpected(photons.error());
  kept_.push_front({task, build_photon_maps(header, task, *photons), ++made_});
  return &kept_.front();
}

}  // namespace penumbra
