// Plastics whose coatings absorb, against random walks of light between the boundary and the base.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/acceptance/media_pieces.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra::coatings_test {
namespace {

constexpr double kIndex = 1.5, kBase = 0.8;

/// A boundary of microfacets between directions of z > 0 outside and z < 0 inside; alpha 0: smooth.
class Walk {
 public:
  Walk(double alpha, double depth, std::uint64_t seed) : alpha_(alpha), depth_(depth), random_(seed) {}

  /// An estimate of what comes back of light from `wo` above.
  double albedo(const glm::dvec3& wo) {
    glm::dvec3 w = wo;
    double weight = cross(w);
    if (weight == 0 || w.z > 0) return weight;
    for (;;) {
      weight *= kBase * std::exp(depth_ / w.z);
      const double r = std::sqrt(random_.uniform()), phi = 2 * std::numbers::pi * random_.uniform();
      // Towards the boundary, which sees it from `up`, below.
      const glm::dvec3 up(r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(1 - r * r, 1e-12)));
      weight *= std::exp(-depth_ / up.z);
      w = -up;
      weight *= cross(w);
      if (weight == 0 || w.z > 0) return weight;
      if (weight < 1e-7) return 0;
    }
  }

 private:
  /// The light that is seen in the direction w, by facets with Smith's separable masking: w becomes where it
  /// goes. Returns its weight.
  double cross(glm::dvec3& w) {
    const bool above = w.z > 0;
    const double u = random_.uniform(), phi = 2 * std::numbers::pi * random_.uniform();
    const double tangent = alpha_ * std::sqrt(u / (1 - u)), cosine = 1 / std::sqrt(1 + tangent * tangent);
    const glm::dvec3 m(tangent * cosine * std::cos(phi), tangent * cosine * std::sin(phi), cosine);
    const glm::dvec3 n = above ? m : -m;
    const double c = glm::dot(w, n), eta = above ? kIndex : 1 / kIndex;
    if (c <= 0) return 0;
    const double beyond = 1 - (1 - c * c) / (eta * eta), t = std::sqrt(std::max(beyond, 0.0));
    const double s = (c - eta * t) / (c + eta * t), p = (eta * c - t) / (eta * c + t);
    const bool reflects = beyond <= 0 || random_.uniform() < 0.5 * (s * s + p * p);
    const glm::dvec3 to = reflects ? 2 * c * n - w : (c / eta - t) * n - w / eta;
    if ((to.z > 0) != (above == reflects)) return 0;
    const double weight = masking(w) * masking(to) * c / (std::abs(w.z) * cosine);
    w = to;
    return weight;
  }
  [[nodiscard]] double masking(const glm::dvec3& v) const {
    return 2 / (1 + std::sqrt(1 + alpha_ * alpha_ * (1 / (v.z * v.z) - 1)));
  }

  double alpha_, depth_;
  RandomNumbers random_;
};

/// What a plate under an even sky reflects to a viewer at that cosine.
statistics::Sample rendered(const BsdfModel& model, double cosine) {
  SceneDescription scene = media::narrow_view(200'000, {.method = PathIntegrator{.max_depth = 2}});
  scene.bsdfs.push_back({"coated", model});
  const glm::dvec3 along(cosine, 0, std::sqrt(1 - cosine * cosine));
  scene.shapes.push_back(
      parallelogram(glm::dvec3(0, -1, 2) - along, {0, 2, 0}, 2.0 * along, int(scene.bsdfs.size()) - 1));
  scene.emitters.emplace_back(ConstantEnvironment{});
  return pixel_sample(render_or_throw(scene, media::big_passes()), 0, 0, 0);
}

void expect_walk(const BsdfModel& model, double alpha, double depth, double tolerance) {
  for (const double cosine : {1.0, 0.5, 0.2}) {
    Walk walk(alpha, depth, 7);
    statistics::Sample walks;
    for (int i = 0; i < 400'000; ++i) walks.add(walk.albedo({std::sqrt(1 - cosine * cosine), 0, cosine}));
    const statistics::Sample ours = rendered(model, cosine);
    // 4 standard errors: 1e-4 that any of 18 is beyond.
    const double error = 4 * std::hypot(ours.standard_error(), walks.standard_error());
    EXPECT_NEAR(ours.mean(), walks.mean(), error + tolerance) << depth << " at " << cosine;
  }
}

TEST(Coatings, OfPlasticAbsorbByTheirDepth) {
  for (const float depth : {0.0f, 0.01f, 0.5f})
    // Without a coating, Egan and Hilgeman's fit of the reflectance from inside is off by 1e-4 at this index.
    expect_walk(PlasticBsdf{.diffuse = glm::vec3(float(kBase)),
                            .int_ior = float(kIndex),
                            .ext_ior = 1,
                            .nonlinear = true,
                            .optical_depth = depth},
                0, double(depth), 2e-4);
}

TEST(Coatings, OfRoughPlasticAbsorbByTheirDepth) {
  for (const float depth : {0.0f, 0.01f, 0.5f})
    // Mitsuba's rule of 64 points for the reflectance from inside, and curves that are straight in between.
    expect_walk(RoughPlasticBsdf{.diffuse = glm::vec3(float(kBase)),
                                 .int_ior = float(kIndex),
                                 .ext_ior = 1,
                                 .nonlinear = true,
                                 .distribution = DISTRIBUTION_GGX,
                                 .alpha = TexturedNumber(0.3f),
                                 .optical_depth = depth},
                0.3, double(depth), 5e-3);
}

}  // namespace
}  // namespace penumbra::coatings_test
