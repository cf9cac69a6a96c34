// Camera, film, sampler, filter and integrator of pbrt.
#pragma once

#include "scenes/pbrt/state.h"

namespace penumbra::pbrt {

/// The camera, whose film has to be known: what it needs is kept until then.
struct CameraDirective {
  std::string type = "perspective";
  Parameters parameters;
  glm::dmat4 camera_from_world{1.0};
  MediumNames media;
  SourceLocation location;
};
void read_camera(Context& context, CameraDirective& camera);

void read_film(Context& context, const std::string& type, Parameters& parameters, SourceLocation location);
void read_sampler(Context& context, const std::string& type, Parameters& parameters, SourceLocation location);
void read_filter(Context& context, const std::string& type, Parameters& parameters, SourceLocation location);
void read_integrator(Context& context, const std::string& type, Parameters& parameters,
                     SourceLocation location);
/// In the place of the one that read_integrator has set.
void use_volumetric_integrator(Context& context, SourceLocation location);

}  // namespace penumbra::pbrt
