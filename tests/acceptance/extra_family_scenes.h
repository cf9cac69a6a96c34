// Rooms with surfaces that have closed forms and surfaces of extra families that have none, and renders of
// them.
#pragma once

#include <utility>
#include <vector>

#include "scenes/scene_description.h"
#include "tests/support/extra_families/extra_family_kernels.h"
#include "tests/support/image_test.h"
#include "tests/support/statistics.h"

namespace penumbra {

struct RoomOptions {
  bool mirror = true;           ///< the back wall, in which the camera sees a light; else glossy
  bool front_pane = false;      ///< a window between camera and room
  bool light_pane = false;      ///< windows between the lights and the room
  bool many_triangles = false;  ///< more than are tested one by one
  bool crude = false;           ///< what has no closed form, and the floor, have control lobes
};

/// A description whose BSDFs are extra families in part.
struct ExtraFamilyScene {
  SceneDescription description;
  std::vector<ExtraFamily> extra_families;

  [[nodiscard]] DeviceScene build() const;
};

/// A room with two polygon lights and something that throws shadows: floor diffuse, left wall Phong, right
/// wall the same without a closed form. Paths without a depth limit.
ExtraFamilyScene extra_family_room(const RoomOptions& options = {});

/// Glass of that index in a vacuum: the indices of what it is from outside and from inside.
std::pair<int, int> add_glass(SceneDescription& scene, float index);

/// The same room with balls of glass that reflects and refracts, and no mirror.
ExtraFamilyScene room_with_glass();

/// A sphere that refracts and loses nothing, in an environment of radiance 1.
ExtraFamilyScene glass_ball(float index);

/// All planes of the whole film, in one unit.
std::vector<float> render_extra_families(const NativeKernel& kernel, const DeviceScene& scene);

/// `batches` renders with seeds from `first_seed` on.
statistics::Estimate extra_family_estimate(const ExtraFamilyScene& scene, int batches,
                                           std::uint32_t first_seed, int block);

/// All samples of a channel of the film together.
statistics::Sample extra_family_sample(const ExtraFamilyScene& scene, int channel);

}  // namespace penumbra
