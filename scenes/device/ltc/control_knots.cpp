#include "scenes/device/ltc/control_knots.h"

#include <algorithm>
#include <cmath>

#include "kernels/bsdf/control_lanes.h"
#include "kernels/host/device_scene.h"

namespace penumbra {
namespace {

ControlKnot knot_of(const ControlLobes& lobes, double cosine) {
  const double angle = std::acos(std::max(cosine, 1e-6)), shift = double(lobes.shift);
  const double leans = angle - std::atan(shift), sine = std::sin(angle);
  return {.diffuse = lobes.diffuse,
          .lean = sine > 0 ? float(std::sin(leans) / sine) : 0.0f,
          .specular = lobes.specular,
          .width_x = float(double(lobes.width_x) / (1 + shift * shift)),
          .width_y = lobes.width_y};
}

}  // namespace

std::vector<ControlKnot> control_knots(const DeviceScene& device_scene) {
  std::vector<ControlKnot> knots;
  if ((device_scene.header.features & FEATURE_LTC) == 0u) return knots;
  const Scene scene = make_scene(device_scene.header, device_scene.words.data());
  for (const Material& material : table<Material>(device_scene, device_scene.header.tables.materials)) {
    const Closure closure = closure_of(material);
    const bool has = has_ltc_form(closure);
    for (int j = 0; j < kControlKnots; ++j) {
      const double root = double(j) / (kControlKnots - 1), cosine = root * root;
      knots.push_back(knot_of(has ? control_of(&scene, closure, float(cosine)) : no_control_lobes(), cosine));
    }
    // The quotient of two sines that both vanish is replaced by its limit.
    knots.back().lean = knots[knots.size() - 2].lean;
  }
  return knots;
}

}  // namespace penumbra
