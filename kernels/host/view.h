// The camera, and what else may change of a scene while its device goes on: no table and no kernel depends on
// it.
#pragma once

#include <cmath>
#include <cstring>

#include "kernels/scene_types.h"

namespace penumbra {

struct View {
  vec3 origin, x, y, z;  ///< as the header's camera_*
  float alpha = 1;       ///< of the control variate, where the scene has one of a given alpha
};

inline View view_of(const SceneHeader& h) {
  return {h.camera.origin, h.camera.x, h.camera.y, h.camera.z, h.adjustable.alpha};
}

inline void apply_view(const View& view, SceneHeader& h) {
  h.camera.origin = view.origin;
  h.camera.x = view.x;
  h.camera.y = view.y;
  h.camera.z = view.z;
  h.adjustable.alpha = view.alpha;
}

/// To the bit.
inline bool is_same(const View& a, const View& b) { return std::memcmp(&a, &b, sizeof(View)) == 0; }

/// Whether all components are finite.
inline bool is_finite(const View& view) {
  for (const vec3& v : {view.origin, view.x, view.y, view.z})
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return false;
  return std::isfinite(view.alpha);
}

}  // namespace penumbra
