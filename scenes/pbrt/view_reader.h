// Reads the camera, film, sampler, filter and integrator of pbrt.
#pragma once

#include "scenes/pbrt/state.h"

namespace penumbra::pbrt {

/// A Camera directive. It is kept until the film is known, because the camera depends on it.
struct CameraDirective {
  std::string type = "perspective";
  Parameters parameters;
  TransformPair camera_from_world;
  MediumNames media;
  SourceLocation location;
};
/// Reads when the camera's shutter is open, before the lights, whose strengths depend on it.
void read_shutter(Context& context, CameraDirective& camera);
/// Without a Camera directive, pbrt's camera is a perspective one at the origin.
void read_camera(Context& context, CameraDirective& camera);
/// Reports an exposure that is not 1, which changes the strengths of all lights.
void check_exposure(Context& context, SourceLocation location);

void read_film(Context& context, const std::string& type, Parameters& parameters, SourceLocation location);
void read_sampler(Context& context, const std::string& type, Parameters& parameters, SourceLocation location);
void read_filter(Context& context, const std::string& type, Parameters& parameters, SourceLocation location);
/// An Integrator directive. It is kept until the film is known, whose size may set the number of photons.
struct IntegratorDirective {
  std::string type = "volpath";
  Parameters parameters;
  SourceLocation location;
};
void read_integrator(Context& context, IntegratorDirective& integrator);
/// Replaces the integrator set by read_integrator with one that supports media.
void use_volumetric_integrator(Context& context, SourceLocation location);

}  // namespace penumbra::pbrt
