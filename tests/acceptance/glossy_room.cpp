#include "tests/acceptance/glossy_room.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/acceptance/scene_pieces.h"

namespace penumbra {

BsdfModel rough_conductor(float alpha, int distribution, float alpha_v) {
  RoughConductorBsdf bsdf;
  bsdf.eta = glm::vec3(0.2f, 0.9f, 1.1f);
  bsdf.k = glm::vec3(3.9f, 2.4f, 2.2f);
  bsdf.distribution = distribution;
  bsdf.alpha_u = alpha;
  bsdf.alpha_v = alpha_v > 0 ? alpha_v : alpha;
  return bsdf;
}

SceneDescription glossy_room(const BsdfModel& bsdf, int width, int height) {
  SceneDescription scene = empty_scene(width, height, 64, 0);
  scene.camera = look_at({0, 0.7, -3.5}, {0, 0.5, 0}, {0, 1, 0}, 45);
  scene.integrator = direct_integrator(1, 1);
  scene.bsdfs.push_back({"glossy", bsdf});
  const int glossy = int(scene.bsdfs.size()) - 1, grey = add_diffuse(scene, 0.3f);
  scene.shapes.push_back(parallelogram({-3, 0, 2}, {6, 0, 0}, {0, 0, -6}, glossy));
  scene.shapes.push_back(parallelogram({-3, 0, 2}, {0, 3, 0}, {6, 0, 0}, glossy));
  for (const double x : {-0.9, 0.7}) {
    scene.shapes.push_back(parallelogram({x, 0, 0.4}, {0.15, 0, 0}, {0, 0.8, 0}, grey));
    scene.shapes.back().back_bsdf = grey;
  }
  scene.shapes.push_back(parallelogram({-1.2, 1.9, 0.2}, {1, 0, 0}, {0, 0.3, 0.9}, kBlackBsdf, 3.0f));
  std::vector<glm::dvec3> star;
  const glm::dvec3 middle(1.3, 1.2, 1.6);
  const auto tip = [&](int k) {
    const double angle = k * std::numbers::pi / 5, radius = k % 2 == 0 ? 0.5 : 0.2;
    return middle + glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), 0);
  };
  for (int k = 0; k < 10; ++k) {
    star.push_back(middle);
    star.push_back(tip(k + 1));
    star.push_back(tip(k));
  }
  scene.shapes.push_back(triangles(star, kBlackBsdf, 8.0f));
  return scene;
}

}  // namespace penumbra
