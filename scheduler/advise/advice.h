// Chooses the technique with the least error for the same work, by pilot renders. The choice is a pure
// function of the scene and its settings but for seed and samples per pixel.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/device/intersector.h"
#include "scheduler/advise/candidates.h"

namespace penumbra {

/// Errors are predicted for a render of so many samples per pixel.
constexpr int kAdvisedSamples = 64;

struct AdviceRow {
  Technique candidate;
  double error = 0;   ///< relative squared error of a render of kAdvisedSamples
  double work = 0;    ///< per sample, see work.h; of photon maps its pixel's share
  double factor = 0;  ///< expected work to equal error, relative to the chosen row
  double doubt = 0;   ///< standard error of log(factor)
};

struct Advice {
  std::vector<AdviceRow> rows;  ///< the first is the scene's own; those with not_because have no numbers
  std::size_t chosen = 0;
  double seconds = 0;  ///< that the pilots took
  double work = 0;     ///< of all pilots and of building their scenes but the first, see work.h
  double most_work = 0;

  [[nodiscard]] const Technique& choice() const { return rows[chosen].candidate; }
};

struct AdviceOptions {
  IntersectorChoice intersector = IntersectorChoice::kAuto;
  std::filesystem::path hierarchy_cache = {};  ///< as for device scenes
  std::vector<std::string> fixed = {};         ///< keys of settings that the user has chosen
  bool takes_photons = true;                   ///< whether the render allows an integrator with photons
  int threads = 1;                             ///< the advice does not depend on them
};

/// Renders the pilots, for at most some 3 % of the work of a render of kAdvisedSamples or 2 s of a core; the
/// first candidate and photons are always compared, others as far as counted work allows. The scene is as
/// before when it returns. Errors: those of building device scenes and of devices; a scene of which the
/// pilots see no light; settings of which nothing is left to choose.
Expected<Advice> advise(SceneDescription& scene, const AdviceOptions& options);

}  // namespace penumbra
