// The media that lights are in, for photons: see LIGHT_MEDIA_FIELDS.
#pragma once

#include <vector>

#include "scenes/device/scene_records.h"

namespace penumbra {

/// One entry per light. The media follow from the boundaries between the camera, whose medium is known, and
/// the light, as for a ray. A light has one: that at its middle, before its front. `header`: complete but for
/// the tables, of which those of primitives, lights and boundaries are complete.
std::vector<LightMedia> light_media(const SceneHeader& header, const SceneRecords& records);

}  // namespace penumbra
