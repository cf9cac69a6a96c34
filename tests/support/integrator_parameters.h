// Integrator parameters by name, for tests that do not know which integrator a scene has:
// param::max_depth(scene.integrator) = 7 throws if the integrator has no such parameter.
#pragma once

#include <stdexcept>

#include "scenes/integrators.h"

namespace penumbra {

/// In the order of IntegratorMethod.
enum class IntegratorKind {
  kDirect,
  kPath,
  kPolygonAnalytic,
  kPolygonArea,
  kPolygonCv,
  kWhitted,
  kAmbientOcclusion,
  kReflectionOcclusion,
  kVolpath,
  kNormals,
  kPhotonMap,
  kProgressivePhoton
};

inline IntegratorKind kind_of(const IntegratorSettings& settings) {
  return IntegratorKind(settings.method.index());
}

inline IntegratorSettings integrator_of(IntegratorKind kind) {
  return {.method = integrator_methods().at(std::size_t(kind))};
}

/// Parameters that both have keep their values.
inline void use(IntegratorSettings& settings, IntegratorKind kind) {
  use_integrator(settings, integrator_of(kind).method);
}

/// Of a path; other integrators find direct light alone anyway.
inline void limit_depth(IntegratorSettings& settings, int edges) {
  with_parameter(settings, PENUMBRA_PARAMETER(max_depth), [&](int& depth) { depth = edges; });
}

namespace param {

template <typename T, typename Settings, typename Parameter>
T& of(Settings& settings, const Parameter& parameter, const char* name) {
  T* found = nullptr;
  with_parameter(settings, parameter, [&](T& value) { found = &value; });
  if (found == nullptr)
    throw std::logic_error(std::string(method_name(settings.method)) + " has no parameter " + name);
  return *found;
}

#define PENUMBRA_TEST_PARAMETER(type, name)                           \
  inline type& name(IntegratorSettings& settings) {                   \
    return of<type>(settings, PENUMBRA_PARAMETER(name), #name);       \
  }                                                                   \
  inline const type& name(const IntegratorSettings& settings) {       \
    return of<const type>(settings, PENUMBRA_PARAMETER(name), #name); \
  }
PENUMBRA_TEST_PARAMETER(int, max_depth)
PENUMBRA_TEST_PARAMETER(int, rr_depth)
PENUMBRA_TEST_PARAMETER(DirectSampling, direct_sampling)
PENUMBRA_TEST_PARAMETER(int, emitter_samples)
PENUMBRA_TEST_PARAMETER(int, bsdf_samples)
PENUMBRA_TEST_PARAMETER(BsdfSampling, bsdf_sampling)
PENUMBRA_TEST_PARAMETER(EmitterSampling, emitter_sampling)
PENUMBRA_TEST_PARAMETER(MisHeuristic, heuristic)
PENUMBRA_TEST_PARAMETER(LightChoice, light_choice)
PENUMBRA_TEST_PARAMETER(bool, trace_shadows)
PENUMBRA_TEST_PARAMETER(int, vis_samples)
PENUMBRA_TEST_PARAMETER(std::optional<float>, alpha)
PENUMBRA_TEST_PARAMETER(NextEvent, next_event)
PENUMBRA_TEST_PARAMETER(int, branch_depth)
PENUMBRA_TEST_PARAMETER(int, indirect_samples)
PENUMBRA_TEST_PARAMETER(IndirectSampling, indirect_sampling)
PENUMBRA_TEST_PARAMETER(OcclusionSampling, sampling)
PENUMBRA_TEST_PARAMETER(OcclusionWeighting, weighting)
PENUMBRA_TEST_PARAMETER(float, exponent)
PENUMBRA_TEST_PARAMETER(float, ray_length)
PENUMBRA_TEST_PARAMETER(float, background)
#undef PENUMBRA_TEST_PARAMETER

}  // namespace param
}  // namespace penumbra
