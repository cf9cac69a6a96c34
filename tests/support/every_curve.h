// Adds curves of every form to a scene.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <string>
#include <utility>

#include "scenes/scene_description.h"
#include "scenes/transform.h"

namespace penumbra {

/// Three strands of each form about `center`, `size` across, of hair and of what the first BSDF is; and a
/// group of all of them, placed turned, mirrored and stretched.
inline void add_every_curve(SceneDescription& scene, const glm::dvec3& center, double size) {
  HairBsdf around, across;
  around.longitudinal_roughness = across.longitudinal_roughness = 0.4f;
  across.offset = HairBsdf::kFromV;
  const int hair = int(scene.bsdfs.size());
  scene.bsdfs.push_back({"round hair", around});
  scene.bsdfs.push_back({"flat hair", across});
  ShapeGroup group{"strands", {}, {}};
  int number = 0;
  for (const CurveForm form :
       {CurveForm::kRound, CurveForm::kBalls, CurveForm::kFlat, CurveForm::kCylinder}) {
    Curves curves{form, {}, {}};
    for (int k = 0; k < 3; ++k, ++number) {
      Curve curve;
      for (int i = 0; i < 6; ++i) {
        const double along = i / 5.0, turn = 1.7 * i + number;
        curve.push_back({{number / 6.0 - 1 + 0.15 * std::sin(turn), 1.6 * along - 0.8, 0.2 * std::cos(turn)},
                         0.02 + 0.03 * (1 - along)});
      }
      curves.curves.push_back(std::move(curve));
      if (is_ribbon(form)) curves.ranges.emplace_back(0.0f, 0.5f + 0.25f * float(k));
    }
    Shape shape;
    shape.name = "strands";
    shape.geometry = std::move(curves);
    shape.front_bsdf = shape.back_bsdf = form == CurveForm::kBalls ? 0 : is_ribbon(form) ? hair + 1 : hair;
    group.shapes.push_back(shape);
    auto& placed = std::get<Curves>(shape.geometry);
    for (Curve& curve : placed.curves)
      for (ControlPoint& at : curve) at = {center + 0.5 * size * at.position, 0.5 * size * at.radius};
    scene.shapes.push_back(std::move(shape));
  }
  const int index = int(scene.groups.size());
  scene.groups.push_back(std::move(group));
  const glm::dmat4 there =
      translation(center) * rotation({0.3, 0.2, 1}, 100) * scaling(glm::dvec3(0.4 * size));
  scene.instances.push_back({"turned", index, there});
  scene.instances.push_back({"mirrored", index, there * scaling({-0.7, 1.1, 0.9})});
}

}  // namespace penumbra
