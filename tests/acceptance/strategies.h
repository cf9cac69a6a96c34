// All strategies of the integrators for direct light, each with a name.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "scenes/scene_description.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {

struct Strategy {
  std::string name;
  IntegratorSettings integrator;
};

inline void PrintTo(const Strategy& strategy, std::ostream* out) { *out << strategy.name; }

inline std::vector<Strategy> direct_strategies() {
  const auto emitter = [](EmitterSampling sampling) {
    IntegratorSettings settings = direct_integrator(1, 0);
    param::emitter_sampling(settings) = sampling;
    return settings;
  };
  const auto direction = [](BsdfSampling sampling) {
    IntegratorSettings settings = direct_integrator(0, 1);
    param::bsdf_sampling(settings) = sampling;
    return settings;
  };
  IntegratorSettings mis_uniform = direct_integrator(2, 1);
  param::bsdf_sampling(mis_uniform) = BsdfSampling::kUniform;
  param::emitter_sampling(mis_uniform) = EmitterSampling::kSolidAngle;
  IntegratorSettings mis_projected = direct_integrator(1, 1);
  param::emitter_sampling(mis_projected) = EmitterSampling::kProjected;
  return {
      {"EmitterArea", emitter(EmitterSampling::kArea)},
      {"EmitterSolidAngle", emitter(EmitterSampling::kSolidAngle)},
      {"EmitterProjected", emitter(EmitterSampling::kProjected)},
      {"DirectionBsdf", direction(BsdfSampling::kBsdf)},
      {"DirectionCosine", direction(BsdfSampling::kCosine)},
      {"DirectionUniform", direction(BsdfSampling::kUniform)},
      {"MisBalance", direct_integrator(1, 1, MisHeuristic::kBalance)},
      {"MisPower", direct_integrator(1, 1, MisHeuristic::kPower)},
      {"MisManySamples", direct_integrator(3, 2, MisHeuristic::kPower)},
      {"MisUniformAndSolidAngle", mis_uniform},
      {"MisProjected", mis_projected},
  };
}

inline std::vector<Strategy> path_strategies() {
  IntegratorSettings power = path_integrator(DirectSampling::kMis);
  param::heuristic(power) = MisHeuristic::kPower;
  IntegratorSettings projected = path_integrator(DirectSampling::kMis);
  param::emitter_sampling(projected) = EmitterSampling::kProjected;
  return {
      {"PathMats", path_integrator(DirectSampling::kBsdfOnly)},
      {"PathEms", path_integrator(DirectSampling::kEmitterOnly)},
      {"PathMis", path_integrator(DirectSampling::kMis)},
      {"PathMisPower", power},
      {"PathMisProjected", projected},
  };
}

inline std::vector<Strategy> all_strategies() {
  std::vector<Strategy> all = direct_strategies();
  for (Strategy& strategy : path_strategies()) all.push_back(std::move(strategy));
  return all;
}

/// Names the parameterised tests.
inline std::string strategy_name(const auto& info) { return info.param.name; }

}  // namespace penumbra
