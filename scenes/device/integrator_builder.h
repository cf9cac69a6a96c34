// Fills in the integrator's part of a scene's header.
#pragma once

#include "kernels/host/error.h"
#include "kernels/scene_types.h"
#include "scenes/device/light_builder.h"
#include "scenes/integrators.h"

namespace penumbra {

/// Whether the settings need the closed form of polygon lights, even if only to choose among lights.
bool wants_polygons(const IntegratorSettings& integrator);

/// Whether BSDF samples find lights, too.
bool finds_lights(const IntegratorSettings& integrator);

/// Whether the settings leave it to the renderer how lights are chosen.
bool light_choice_is_auto(const IntegratorSettings& integrator);

/// How lights are sampled whose shape does not specify it. `narrow`: surfaces have control lobes that are
/// narrower than most lights.
EmitterSampling default_sampling(const IntegratorSettings& integrator, bool narrow = false);

/// Fills in the header's fields of the integrator, including `features`. `lights` must be complete.
/// `scene_radius` is the radius of a bounding sphere of all shapes. Errors: settings that contradict each
/// other or the scene.
Expected<void> set_integrator(const IntegratorSettings& integrator, const LightBuilder& lights,
                              double scene_radius, SceneHeader& header);

/// Error: the integrator cannot tell direct from indirect light, which layers ask for. The header's features
/// and its fields of the integrator must be there.
Expected<void> check_split_light(const IntegratorSettings& integrator, const SceneHeader& header);

}  // namespace penumbra
