// Polygon lights that illuminate the origin, unoccluded or from behind an occluder with a straight edge, and
// the arriving light in double: by clipping and Lambert's sum over edges, or by quadrature.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "scenes/scene_description.h"
#include "tests/support/render_scene.h"
#include "tests/support/statistics.h"

namespace penumbra {

/// Corners in order; convex where it is clipped, counter-clockwise as seen from the front.
using PolygonPoints = std::vector<glm::dvec3>;

/// The integral of the cosine with the normal (0, 1, 0) over the solid angle that the planar polygon has from
/// the origin, above the horizon: Lambert's sum over the edges of the clipped polygon. Negative for polygons
/// whose back is seen. Not convex ones may be given as well if they do not cross the horizon.
double projected_solid_angle(const PolygonPoints& polygon);

/// The part of a convex polygon where normal . p >= 0, by Sutherland and Hodgman.
PolygonPoints clipped(const PolygonPoints& polygon, const glm::dvec3& normal);

/// A light, and maybe a quadrilateral that hides what is beyond its edge from occluder[0] to occluder[1].
struct ShadowedPolygon {
  PolygonPoints light;
  std::optional<std::array<glm::dvec3, 4>> occluder = std::nullopt;

  /// What the origin sees of the light.
  [[nodiscard]] PolygonPoints visible() const;
};

/// The large light of ALGORITHMS.md, section 2, behind an occluder at y = 0.3 from x = `edge` on, or bare.
ShadowedPolygon large_light(std::optional<double> edge = std::nullopt);
/// A smaller one, 43 % visible.
ShadowedPolygon small_light();
constexpr double kEdge68 = 0.1024763034, kEdge24 = -0.1086023344, kEdgeUmbra = -0.4;

/// Radiance that a receiver at the origin with normal (0, 1, 0) sends to the direction of `viewer` under
/// uniform radiance 1 from the front of a convex polygon: Gauss-Legendre quadrature over its area. Relative
/// error below 1e-7 for Phong exponents up to 1000 and polygons that do not come near the origin.
double reflected_radiance(const PolygonPoints& polygon, const BsdfModel& bsdf, const glm::dvec3& viewer);

/// A floor y = 0 whose origin all of `pixels` x `pixels` pixels see from `viewer`, without lights.
SceneDescription receiver_scene(const BsdfModel& bsdf, const glm::dvec3& viewer, int pixels,
                                std::uint32_t seed);
void add_light(SceneDescription& scene, const ShadowedPolygon& light, const glm::vec3& radiance);

/// Renders one pass of `samples` samples for each pixel. The means of the pixels are independent and have one
/// distribution, though samples of a pass share an alpha.
statistics::Sample pass_means(SceneDescription scene, std::uint32_t samples, int channel = 1);

/// p-values of many tests of one claim, with independent seeds.
class ManyTests {
 public:
  void add(const statistics::TestResult& result, const std::string& name);
  /// Fails if any deviation, the sum of their squares or their sum is more improbable than `significance`
  /// (the first by Sidak): the sum sees a bias that all have in common.
  void expect_passed(double significance) const;

 private:
  std::vector<double> z_, p_;
  std::vector<std::string> names_;
};

IntegratorSettings polygon_cv(std::optional<float> alpha, EmitterSampling sampling, int vis_samples);
/// Direct light by emitter samples alone.
IntegratorSettings emitter_only(EmitterSampling sampling, int samples,
                                LightChoice choice = LightChoice::kAuto);

}  // namespace penumbra
