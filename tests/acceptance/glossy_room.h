// Glossy surfaces under polygon lights, with shadows, for tests and for the benchmark of variances.
#pragma once

#include "scenes/scene_description.h"

namespace penumbra {

/// Of a grey index of refraction; `alpha_v` of 0 is `alpha`.
BsdfModel rough_conductor(float alpha, int distribution, float alpha_v = 0);

/// A floor and a back wall of that BSDF under a square light and a star, seen at all angles down to grazing;
/// some posts throw shadows. Direct light. Independent samples.
SceneDescription glossy_room(const BsdfModel& bsdf, int width, int height);

}  // namespace penumbra
