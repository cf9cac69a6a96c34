// The reflection of TinyRender materials for each value of `illum`, against a sum over the light in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/acceptance/tinyrender_reference.h"
#include "tests/scenes/tinyrender_text.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

constexpr double kRadiance = 10, kDiffuse = 0.5, kSpecular = 0.4, kExponent = 20;
/// The light: x and z from -half to half at this height, shining down.
constexpr double kHeight = 1.5, kHalf = 0.5;

/// Kd / pi + Ks (n + 2) / 2 pi cos^n, towards the eye from a point of the floor y = 0; either may be 0.
double reflected(const glm::dvec3& point, const glm::dvec3& eye, double diffuse, double specular) {
  constexpr int kCells = 400;  // an integrand this smooth is known to 1e-5 with them
  const glm::dvec3 to_eye = glm::normalize(eye - point), mirrored(-to_eye.x, to_eye.y, -to_eye.z);
  double sum = 0;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      const glm::dvec3 area_light(kHalf * ((2 * i + 1.0) / kCells - 1), kHeight,
                                  kHalf * ((2 * j + 1.0) / kCells - 1));
      const glm::dvec3 d = area_light - point, w = glm::normalize(d);
      const double lobe = std::pow(std::max(glm::dot(w, mirrored), 0.0), kExponent);
      const double value =
          diffuse / std::numbers::pi + specular * (kExponent + 2) / (2 * std::numbers::pi) * lobe;
      sum += kRadiance * value * w.y * w.y / glm::dot(d, d);
    }
  return sum * 4 * kHalf * kHalf / (kCells * kCells);
}

class TinyRenderIllum : public TinyRenderText {
 protected:
  static std::string floor_of(const std::string& illum) {
    return "newmtl white\nKd .5 .5 .5\nKs .4 .4 .4\nNs 20\n" + illum + "newmtl area_light\nKe 10 10 10\n";
  }
  static constexpr const char* kRoom =
      "mtllib m.mtl\nv -90 0 -90\nv -90 0 90\nv 90 0 90\nv 90 0 -90\nusemtl white\nf 1 2 3 4\n"
      "v -.5 1.5 -.5\nv .5 1.5 -.5\nv .5 1.5 .5\nv -.5 1.5 .5\nusemtl area_light\nf 5 6 7 8\n";

  void expect_floor(const std::string& illum, double diffuse, double specular) {
    SCOPED_TRACE(illum);
    use(kRoom, floor_of(illum));
    SceneDescription scene = good_toml(scene_with(kDirect, "eye = [0.5, 1, 3]\nat = [0, 0, 0]\nfov = 30"));
    const PinholeCamera camera{{0.5, 1, 3}, {0, 0, 0}, 30, scene.film.width, scene.film.height};
    sample_pixel_centres(scene);
    scene.sampler.spp = 1;
    scene.integrator = integrator_of(IntegratorKind::kPolygonAnalytic);
    const statistics::Image image = mean_image(render_or_throw(scene));
    double darkest = 1e9, brightest = 0;
    for (const int x : {2, 9, 15, 22, 28})
      for (const int y : {9, 12, 15, 18}) {
        const double expected = reflected(camera.floor_point(x, y), camera.eye, diffuse, specular);
        EXPECT_NEAR(image.at(x, y, 1), expected, 1e-4 * expected) << x << ", " << y;
        darkest = std::min(darkest, expected);
        brightest = std::max(brightest, expected);
      }
    EXPECT_GT(brightest, 1.5 * darkest) << "one value everywhere would prove little";
  }
};

TEST_F(TinyRenderIllum, SevenIsDiffuseAlone) { expect_floor("illum 7\n", kDiffuse, 0); }

TEST_F(TinyRenderIllum, EightIsDiffuseAndPhong) { expect_floor("illum 8\n", kDiffuse, kSpecular); }

TEST_F(TinyRenderIllum, AllOthersButTheMirrorArePhongWhichIsBothToo) {
  expect_floor("", kDiffuse, kSpecular);
  for (const int illum : {-1, 0, 1, 2, 3, 4, 6, 9, 10, 11})
    expect_floor("illum " + std::to_string(illum) + "\n", kDiffuse, kSpecular);
}

// A ray from the eye goes on from the floor to the light, of which it shows Ks, or beside it.
TEST_F(TinyRenderIllum, FiveIsAMirror) {
  use(kRoom, floor_of("illum 5\n"));
  SceneDescription scene = good_toml(scene_with(kDirect, "eye = [0.5, 1, 3]\nat = [0, 0, 0.8]\nfov = 50"));
  const PinholeCamera camera{{0.5, 1, 3}, {0, 0, 0.8}, 50, scene.film.width, scene.film.height};
  sample_pixel_centres(scene);
  scene.sampler.spp = 1;
  scene.integrator = integrator_of(IntegratorKind::kPath);
  param::max_depth(scene.integrator) = 3;
  const statistics::Image image = mean_image(render_or_throw(scene));
  int lit = 0, unlit = 0;
  for (int y = scene.film.height / 2; y < scene.film.height; ++y)
    for (int x = 0; x < scene.film.width; ++x) {
      const glm::dvec3 floor = camera.floor_point(x, y), out = (floor - camera.eye) * glm::dvec3(1, -1, 1);
      if (!(out.y > 0)) continue;
      const glm::dvec3 at = floor + out * (kHeight / out.y);
      const double outside = std::max(std::abs(at.x), std::abs(at.z)) - kHalf;
      if (std::abs(outside) < 1e-3) continue;
      ++(outside < 0 ? lit : unlit);
      EXPECT_NEAR(image.at(x, y, 1), outside < 0 ? kSpecular * kRadiance : 0, 1e-5) << x << ", " << y;
    }
  EXPECT_GT(lit, 20);
  EXPECT_GT(unlit, 20);
}

TEST_F(TinyRenderIllum, AMirrorWithoutKsReflectsAll) {
  use(kRoom, "newmtl white\nillum 5\nnewmtl area_light\nKe 10 10 10\n");
  const SceneDescription scene = good_toml(scene_with(kDirect));
  EXPECT_EQ(std::get<ConductorBsdf>(scene.bsdfs.at(0).model).specular_reflectance.value, glm::vec3(1.0f));
}

}  // namespace
}  // namespace penumbra
