// What may change in a scene while a device keeps it: the camera, and other parameters that a viewer may
// adjust. No kernel and no table depends on them, except the tables of light edges and the camera's own
// motion, which are ignored once the camera is another one. A new parameter only needs a new field in either
// list, here and on the wire.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "kernels/scene_types.h"

namespace penumbra {

struct View {
  Camera camera;
  Adjustable adjustable;
};

#define REQUIRE_FLOATS(type, name) \
  static_assert(std::is_same_v<type, float> || std::is_same_v<type, vec3>, #name " of a view");
CAMERA_FIELDS(REQUIRE_FLOATS)
ADJUSTABLE_FIELDS(REQUIRE_FLOATS)
#undef REQUIRE_FLOATS

/// The numbers of a part, or of a field, of a view.
template <typename Part>
std::array<float, sizeof(Part) / sizeof(float)> as_floats(const Part& part) {
  return std::bit_cast<std::array<float, sizeof(Part) / sizeof(float)>>(part);
}

inline View view_of(const SceneHeader& h) { return {h.camera, h.adjustable}; }

/// A hash of a camera, to detect whether two cameras are the same (false positives: one in 2^32).
inline std::uint32_t camera_key(const Camera& camera) {
  std::uint32_t key = 2166136261u;  // FNV-1a over words
  for (const float value : as_floats(camera)) key = (key ^ std::bit_cast<std::uint32_t>(value)) * 16777619u;
  return key;
}

/// Sets camera and adjustable parameters. The tables of light edges and the camera's motion are ignored
/// unless the camera is the scene's own.
inline void apply_view(const View& view, SceneHeader& h) {
  h.camera = view.camera;
  h.adjustable = view.adjustable;
  const bool own = camera_key(view.camera) == h.own_camera;
  h.sees_edges = own && (h.features & FEATURE_LIGHT_EDGES) != 0u ? 1 : 0;
  h.camera_moves = own && h.tables.camera_states.count > 0 ? 1 : 0;
}

/// Whether they are equal to the bit.
inline bool is_same(const View& a, const View& b) { return std::memcmp(&a, &b, sizeof(View)) == 0; }

/// The name of the first field that is not finite, or null.
inline const char* non_finite_field(const View& view) {
#define LOOK_AT_FIELD(part, name)                \
  for (const float value : as_floats(part.name)) \
    if (!std::isfinite(value)) return #part "." #name;
#define LOOK_AT_CAMERA(type, name) LOOK_AT_FIELD(camera, name)
#define LOOK_AT_ADJUSTABLE(type, name) LOOK_AT_FIELD(adjustable, name)
  const auto& [camera, adjustable] = view;
  CAMERA_FIELDS(LOOK_AT_CAMERA)
  ADJUSTABLE_FIELDS(LOOK_AT_ADJUSTABLE)
#undef LOOK_AT_CAMERA
#undef LOOK_AT_ADJUSTABLE
#undef LOOK_AT_FIELD
  return nullptr;
}

}  // namespace penumbra
