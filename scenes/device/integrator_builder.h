// The integrator's part of a scene's header: what the settings come to on the device.
#pragma once

#include "kernels/host/error.h"
#include "kernels/scene_types.h"
#include "scenes/device/light_builder.h"
#include "scenes/integrators.h"

namespace penumbra {

/// Whether the settings need the closed form of polygon lights, if only to choose among lights.
bool wants_polygons(const IntegratorSettings& integrator);

/// Whether how lights are chosen is left open.
bool chooses_as_it_likes(const IntegratorSettings& integrator);

/// How lights are sampled that do not say it themselves. `narrow`: surfaces have lobes of which control
/// variates and samples know, and which are narrower than most lights.
EmitterSampling default_sampling(const IntegratorSettings& integrator, bool narrow = false);

/// Fills in the integrator's fields of the header, `features` among them; `lights` are complete.
/// `scene_radius`: of a sphere about all shapes. Errors: settings that contradict each other or the scene.
Expected<void> set_integrator(const IntegratorSettings& integrator, const LightBuilder& lights,
                              double scene_radius, SceneHeader& header);

}  // namespace penumbra
