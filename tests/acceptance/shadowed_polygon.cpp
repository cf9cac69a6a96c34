#include "tests/acceptance/shadowed_polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {

using glm::dvec3;

double projected_solid_angle(const PolygonPoints& polygon) {
  const PolygonPoints above = std::ranges::any_of(polygon, [](const dvec3& p) { return p.y < 0; })
                                  ? clipped(polygon, dvec3(0, 1, 0))
                                  : polygon;
  double sum = 0;
  for (std::size_t i = 0; i < above.size(); ++i) {
    const dvec3 &a = above[i], &b = above[(i + 1) % above.size()];
    const dvec3 cross = glm::cross(a, b);
    const double length = glm::length(cross);
    if (length > 0) sum += std::atan2(length, glm::dot(a, b)) * cross.y / length;
  }
  return -0.5 * sum;  // counter-clockwise from the front is clockwise from outside the sphere of directions
}

PolygonPoints clipped(const PolygonPoints& polygon, const dvec3& normal) {
  PolygonPoints result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double at_a = glm::dot(normal, a), at_b = glm::dot(normal, b);
    if (at_a >= 0) result.push_back(a);
    if ((at_a >= 0) != (at_b >= 0)) result.push_back(a + (at_a / (at_a - at_b)) * (b - a));
  }
  return result;
}

PolygonPoints ShadowedPolygon::visible() const {
  if (!occluder) return light;
  const std::array<dvec3, 4>& o = *occluder;
  dvec3 normal = glm::cross(o[0], o[1]);
  if (glm::dot(normal, o[2]) > 0) normal = -normal;
  return clipped(light, normal);
}

ShadowedPolygon large_light(std::optional<double> edge) {
  ShadowedPolygon scene;
  scene.light = {{-1.6, 1.375, 1.25}, {-1.6, 1.375, -1.25}, {0.85, 0.625, -1.25}, {0.85, 0.625, 1.25}};
  if (edge) {
    constexpr double kHeight = 0.3;
    scene.occluder = {dvec3(*edge, kHeight, -1), dvec3(*edge, kHeight, 1), dvec3(1, kHeight, 1),
                      dvec3(1, kHeight, -1)};
  }
  return scene;
}

ShadowedPolygon small_light() {
  return {{{-1.4, 1, 0.15}, {-1.4, 1, -0.15}, {-1.09, 1, -0.15}, {-1.09, 1, 0.15}},
          std::array{dvec3(-0.8735839, 0.3, 1), dvec3(0.1264161, 0.3, -1), dvec3(2.1264161, 0.3, -1),
                     dvec3(1.1264161, 0.3, 1)}};
}

namespace {

// Gauss-Legendre on [0, 1] with 4 points (Abramowitz and Stegun 25.4.30).
constexpr std::array<double, 4> kNodes{0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                       0.93056815579702629};
constexpr std::array<double, 4> kWeights{0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                         0.17392742256872693};
constexpr int kCells = 128;  // an eighth of the width of a lobe with exponent 1000, for these lights

double brdf(const BsdfModel& model, double lobe_cosine) {
  if (const auto* diffuse = std::get_if<DiffuseBsdf>(&model))
    return diffuse->reflectance.value.y / std::numbers::pi;
  const PhongBsdf& phong = std::get<PhongBsdf>(model);
  const double n = phong.exponent.value;
  return phong.diffuse.value.y / std::numbers::pi +
         phong.specular.value.y * (n + 2) / (2 * std::numbers::pi) * std::pow(std::max(lobe_cosine, 0.0), n);
}

}  // namespace

double reflected_radiance(const PolygonPoints& polygon, const BsdfModel& bsdf, const dvec3& viewer) {
  const PolygonPoints above = clipped(polygon, dvec3(0, 1, 0));
  const dvec3 mirror = glm::normalize(dvec3(-viewer.x, viewer.y, -viewer.z));
  double sum = 0;
  for (std::size_t k = 1; k + 1 < above.size(); ++k) {
    const dvec3 corner = above[0], e1 = above[k] - above[0], e2 = above[k + 1] - above[k];
    const dvec3 normal = glm::cross(e1, e2);  // its length is twice the area
    for (int i = 0; i < kCells * 4; ++i) {
      const double u = (i / 4 + kNodes[std::size_t(i % 4)]) / kCells;
      for (int j = 0; j < kCells * 4; ++j) {
        const double v = (j / 4 + kNodes[std::size_t(j % 4)]) / kCells;
        const dvec3 p = corner + u * (e1 + v * e2);  // Duffy's map of the square to the triangle
        const double r2 = glm::dot(p, p), r = std::sqrt(r2);
        const double at_light = std::max(-glm::dot(p, normal) / r, 0.0) * u;
        sum += kWeights[std::size_t(i % 4)] * kWeights[std::size_t(j % 4)] *
               brdf(bsdf, glm::dot(mirror, p) / r) * (p.y / r) * at_light / r2;
      }
    }
  }
  return sum / (double(kCells) * kCells);
}

SceneDescription receiver_scene(const BsdfModel& bsdf, const dvec3& viewer, int pixels, std::uint32_t seed) {
  SceneDescription scene = empty_scene(pixels, pixels, 1, seed);
  scene.camera = look_at(viewer, dvec3(0), dvec3(0, 0, 1), 1e-6);
  scene.bsdfs.push_back({"receiver", bsdf});
  // The origin is on no edge.
  scene.shapes.push_back(parallelogram({-2, 0, -2.5}, {0, 0, 4.5}, {4, 0, 0}, 0));
  return scene;
}

void add_light(SceneDescription& scene, const ShadowedPolygon& light, const glm::vec3& radiance) {
  Mesh mesh;
  mesh.positions = light.light;
  for (unsigned k = 1; k + 1 < light.light.size(); ++k) mesh.triangles.emplace_back(0, k, k + 1);
  Shape shape;
  shape.name = "light";
  shape.geometry = std::move(mesh);
  shape.radiance = radiance;
  scene.shapes.push_back(std::move(shape));
  if (!light.occluder) return;
  const std::array<dvec3, 4>& o = *light.occluder;
  scene.shapes.push_back(parallelogram(o[0], o[1] - o[0], o[3] - o[0], kBlackBsdf));
}

statistics::Sample pass_means(SceneDescription scene, std::uint32_t samples, int channel) {
  scene.sampler.spp = samples;
  TestDevice device = native_device();
  device.samples_per_pass = samples;
  const FilmAccumulator film = render_or_throw(scene, device);
  EXPECT_EQ(non_finite_count(film.flagged()), 0u);
  statistics::Sample means;
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x) means.add(film.at(x, y).mean[channel]);
  return means;
}

void ManyTests::add(const statistics::TestResult& result, const std::string& name) {
  z_.push_back(statistics::student_to_normal(result.statistic, result.dof));
  p_.push_back(result.p);
  names_.push_back(name);
}

void ManyTests::expect_passed(double significance) const {
  ASSERT_FALSE(z_.empty());
  const double each = statistics::sidak_significance(significance, z_.size());
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < z_.size(); ++i) {
    EXPECT_GT(p_[i], each) << names_[i] << ": z = " << z_[i];
    sum += z_[i];
    squares += z_[i] * z_[i];
  }
  const double n = double(z_.size());
  EXPECT_GT(statistics::chi_square_p(squares, n), significance) << "mean of z^2 is " << squares / n;
  EXPECT_GT(2 * statistics::normal_cdf(-std::abs(sum) / std::sqrt(n)), significance)
      << "mean of z is " << sum / n;
}

IntegratorSettings polygon_cv(std::optional<float> alpha, EmitterSampling sampling, int vis_samples) {
  IntegratorSettings settings;
  use(settings, IntegratorKind::kPolygonCv);
  param::alpha(settings) = alpha;
  param::emitter_sampling(settings) = sampling;
  param::vis_samples(settings) = vis_samples;
  return settings;
}

IntegratorSettings emitter_only(EmitterSampling sampling, int samples, LightChoice choice) {
  IntegratorSettings settings = direct_integrator(samples, 0);
  param::emitter_sampling(settings) = sampling;
  param::light_choice(settings) = choice;
  return settings;
}

}  // namespace penumbra
