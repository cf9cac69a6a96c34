// Lights with textures or a spread, spot lights, projectors, directional lights and suns: at a point of a
// floor, every strategy gives the reflected radiance of quadrature in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/unit_square.h"

namespace penumbra {
namespace {

using glm::dvec3;

constexpr double kPi = std::numbers::pi;
constexpr double kSignificance = 0.01, kRounding = 64.0 / (1 << 24), kReflectance = 0.8;
constexpr int kPixels = 8, kWidth = 6, kHeight = 5;
constexpr std::uint32_t kSamples = 512;  ///< of each pixel, all of which see the same point
const dvec3 kViewer(0.6, 1.1, -0.4);

/// Texels of which few are bright, or not.
double texel(bool sparse, int x, int y) {
  x = std::clamp(x, 0, kWidth - 1);
  y = std::clamp(y, 0, kHeight - 1);
  if (sparse) return (x + 2 * y) % 7 == 3 ? 5.0 + x : 0.125;
  return 0.5 + 0.125 * ((3 * x + y) % 5);
}

/// Bilinear between the centres of texels, clamped at the edges.
double image(bool sparse, double u, double v) {
  const double x = u * kWidth - 0.5, y = v * kHeight - 0.5;
  const int i = int(std::floor(x)), k = int(std::floor(y));
  const double s = x - i, t = y - k;
  return (1 - t) * ((1 - s) * texel(sparse, i, k) + s * texel(sparse, i + 1, k)) +
         t * ((1 - s) * texel(sparse, i, k + 1) + s * texel(sparse, i + 1, k + 1));
}

/// Returns its index.
int add_image(SceneDescription& scene, bool sparse) {
  Bitmap bitmap{"image", kWidth, kHeight, 1, TexelType::kFloat, {}};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      bitmap.words.push_back(std::bit_cast<std::uint32_t>(float(texel(sparse, x, y))));
  scene.bitmaps.push_back(std::make_shared<const Bitmap>(std::move(bitmap)));
  BitmapTexture texture;
  texture.bitmap = int(scene.bitmaps.size()) - 1;
  texture.wrap_u = texture.wrap_v = WRAP_CLAMP;
  scene.textures.push_back({"image", texture});
  return int(scene.textures.size()) - 1;
}

/// By midpoints, whose error is below 1e-4 here.
double integral(const std::function<double(double, double)>& value) {
  return unit_square_integral(900, value);
}
constexpr double kQuadrature = 2e-4;

/// What the floor reflects of irradiance 1 across the unit direction towards it.
double reflected(const dvec3& wi) { return kReflectance / kPi * std::max(wi.y, 0.0); }

double of_point(const dvec3& at, double intensity) {
  return reflected(glm::normalize(at)) * intensity / glm::dot(at, at);
}

/// Of a surface's point of radiance 1 that stands for `area`.
double of_area(const dvec3& at, const dvec3& normal, double area) {
  const double d2 = glm::dot(at, at);
  return reflected(at / std::sqrt(d2)) * std::max(-glm::dot(normal, at) / std::sqrt(d2), 0.0) / d2 * area;
}

Shape shape_of(const decltype(Shape::geometry)& geometry, int texture) {
  Shape shape;
  shape.name = "light";
  shape.geometry = geometry;
  shape.radiance = glm::vec3(0.5f);
  shape.radiance_texture = texture;
  return shape;
}

struct EmitterCase {
  std::string name;
  std::function<void(SceneDescription&)> add;
  std::function<double()> reflected;  ///< quadrature is left to the tests that need it
  bool found = true;                  ///< by rays
};
void PrintTo(const EmitterCase& tested, std::ostream* out) { *out << tested.name; }

void add_textured_shapes(std::vector<EmitterCase>& cases) {
  const dvec3 a(0.5, 1.3, 0.9), u(-0.4, 0.8, -0.7), v(-1.2, 0.2, 0.1), n = glm::cross(u, v);
  const dvec3 z = glm::normalize(dvec3(-0.2, -0.9, 0.5)), x = glm::normalize(glm::cross(dvec3(0, 0, 1), z)),
              y = glm::cross(z, x);
  const dvec3 disk(0.3, 1.9, -0.9), sphere(1.1, 1.4, 0.3), cylinder(-0.7, 1.6, 0.2);
  constexpr double kDisk = 0.7, kSphere = 0.8, kCylinder = 0.3, kLength = 1.1;
  const dvec3 facing = glm::dot(n, a) < 0 ? glm::normalize(n) : -glm::normalize(n);
  const bool turned = glm::dot(n, a) > 0;
  for (const bool sparse : {false, true}) {
    const std::string suffix = sparse ? "Sparse" : "Even";
    Mesh rectangle, triangle;
    rectangle.positions = {a, a + u, a + u + v, a + v};
    rectangle.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    rectangle.triangles = turned ? std::vector<glm::uvec3>{{0, 2, 1}, {0, 3, 2}}
                                 : std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}};
    triangle = rectangle;
    triangle.triangles.pop_back();
    const auto add = [&](const std::string& name, const decltype(Shape::geometry)& geometry,
                         const std::function<double(double, double)>& value) {
      cases.push_back({suffix + name,
                       [=](SceneDescription& scene) {
                         scene.shapes.push_back(shape_of(geometry, add_image(scene, sparse)));
                       },
                       [=] { return 0.5 * integral(value); }});
    };
    add("Rectangle", rectangle, [=](double s, double t) {
      return image(sparse, s, t) * of_area(a + s * u + t * v, facing, glm::length(n));
    });
    // Of the first half, t <= s, by (s, s t).
    add("Triangle", triangle, [=](double s, double t) {
      return image(sparse, s, s * t) * of_area(a + s * u + s * t * v, facing, s * glm::length(n));
    });
    add("Disk", Disk{disk, z, kDisk, x, y}, [=](double s, double t) {
      const double r = kDisk * s, phi = 2 * kPi * t;
      const dvec3 at = disk + r * (std::cos(phi) * x + std::sin(phi) * y);
      return image(sparse, s, t) * of_area(at, z, 2 * kPi * r * kDisk);
    });
    add("Sphere", Sphere{sphere, kSphere, x, y, z}, [=](double s, double t) {
      const double theta = kPi * t, phi = 2 * kPi * s;
      const dvec3 out = std::sin(theta) * (std::cos(phi) * x + std::sin(phi) * y) + std::cos(theta) * z;
      return image(sparse, s, t) *
             of_area(sphere + kSphere * out, out, 2 * kPi * kPi * kSphere * kSphere * std::sin(theta));
    });
    // In a frame of its own, not the one about its axis in which points on it are chosen.
    add("Cylinder", Cylinder{cylinder, z, kCylinder, kLength, x, y}, [=](double s, double t) {
      const double phi = 2 * kPi * s;
      const dvec3 out = std::cos(phi) * x + std::sin(phi) * y;
      return image(sparse, s, t) *
             of_area(cylinder + kCylinder * out + t * kLength * z, out, 2 * kPi * kCylinder * kLength);
    });
  }
}

/// At `at`, with its z axis towards `target`.
glm::dmat4 placed(const dvec3& at, const dvec3& target) {
  const dvec3 z = glm::normalize(target - at), x = glm::normalize(glm::cross(dvec3(0.3, 1, 0.2), z));
  return {glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0), glm::dvec4(at, 1)};
}

void add_beams(std::vector<EmitterCase>& cases) {
  const dvec3 at(0.5, 1.2, 0.4), target(0.2, 0.1, 0.1);
  const glm::dmat4 to_world = placed(at, target);
  const dvec3 w = glm::transpose(glm::dmat3(to_world)) * glm::normalize(-at);  // to the origin
  const double angle = std::acos(w.z) * 180 / kPi;
  for (const SpotFalloff falloff : {SpotFalloff::kLinear, SpotFalloff::kSmoothstep})
    for (const bool textured : {false, true}) {
      SpotLight spot;
      spot.intensity = glm::vec3(2);
      spot.cutoff_angle = 1.7 * angle;
      spot.beam_width = 0.4 * angle;
      spot.falloff = falloff;
      spot.to_world = to_world;
      const auto cosine = [](double degrees) { return std::cos(degrees * kPi / 180); };
      const double t = falloff == SpotFalloff::kLinear
                           ? 0.7 / 1.3
                           : (w.z - cosine(1.7 * angle)) / (cosine(0.4 * angle) - cosine(1.7 * angle));
      const double share = falloff == SpotFalloff::kLinear ? t : t * t * (3 - 2 * t);
      const double wide = std::tan(1.7 * angle * kPi / 180);
      const double shown =
          textured ? image(false, 0.5 + 0.5 * w.x / w.z / wide, 0.5 + 0.5 * w.y / w.z / wide) : 1;
      cases.push_back({std::string(textured ? "Textured" : "") +
                           (falloff == SpotFalloff::kLinear ? "Spot" : "SmoothSpot"),
                       [=](SceneDescription& scene) {
                         SpotLight light = spot;
                         if (textured) light.texture.texture = add_image(scene, false);
                         scene.emitters.emplace_back(light);
                       },
                       [value = of_point(at, 2 * share * shown)] { return value; }, false});
    }
  ProjectorLight projector;
  projector.fov = 2.4 * angle;
  projector.scale = 3;
  projector.to_world = to_world;
  const double x = std::tan(1.2 * angle * kPi / 180), y = x * kHeight / kWidth;
  const double shown = image(false, 0.5 - 0.5 * w.x / w.z / x, 0.5 - 0.5 * w.y / w.z / y);
  cases.push_back({"Projector",
                   [=](SceneDescription& scene) {
                     ProjectorLight light = projector;
                     light.irradiance.texture = add_image(scene, false);
                     scene.emitters.emplace_back(light);
                   },
                   [value = of_point(at, 3 * kPi * shown / std::pow(w.z, 3))] { return value; }, false});
  DirectionalLight sun;
  sun.irradiance = glm::vec3(1.5f);
  sun.direction = dvec3(0.5, -2, 1);
  cases.push_back({"Directional", [=](SceneDescription& scene) { scene.emitters.emplace_back(sun); },
                   [value = 1.5 * reflected(-glm::normalize(sun.direction))] { return value; }, false});
}

/// Suns of which one is cut by the horizon, and spot lights with a radius: their spheres, whose radiance in
/// each direction is the intensity over the section.
void add_lamps(std::vector<EmitterCase>& cases) {
  for (const auto& [name, degrees, height] :
       {std::tuple{"Sun", 12.0, 1.5}, {"SunAtTheHorizon", 70.0, 0.3}, {"SunOfHalfTheSky", 180.0, 1.0}}) {
    DirectionalLight sun;
    sun.irradiance = glm::vec3(1.5f);
    sun.direction = dvec3(0.5, -height, 0.7);
    sun.angle = degrees;
    const dvec3 z = -glm::normalize(sun.direction), x = glm::normalize(glm::cross(dvec3(0, 0, 1), z)),
                y = glm::cross(z, x);
    const double half = degrees * kPi / 360, versine = 1 - std::cos(half);
    const double radiance = 1.5 / (kPi * std::pow(std::sin(half), 2));
    cases.push_back({name, [=](SceneDescription& scene) { scene.emitters.emplace_back(sun); },
                     [=] {
                       return 2 * kPi * versine * radiance * integral([&](double s, double t) {
                                const double cosine = 1 - versine * s, sine = std::sqrt(1 - cosine * cosine);
                                const double phi = 2 * kPi * t;
                                return reflected(cosine * z + sine * (std::cos(phi) * x + std::sin(phi) * y));
                              });
                     }});
  }
  const dvec3 at(0.5, 1.2, 0.4), target(0.2, 0.1, 0.1);
  const glm::dmat4 to_world = placed(at, target);
  const dvec3 x(to_world[0]), y(to_world[1]), z(to_world[2]);
  constexpr double kRadius = 0.35, kCutoff = 40, kBeam = 5;
  for (const bool textured : {false, true}) {
    SpotLight spot;
    spot.intensity = glm::vec3(2);
    spot.cutoff_angle = kCutoff;
    spot.beam_width = kBeam;
    spot.radius = kRadius;
    spot.to_world = to_world;
    const auto radiance = [=](const dvec3& point) {
      const dvec3 w = -glm::normalize(point);  // in which it shines on the origin
      const double cosine = glm::dot(w, z), angle = std::acos(cosine) * 180 / kPi;
      const double share = std::clamp((kCutoff - angle) / (kCutoff - kBeam), 0.0, 1.0);
      const double wide = std::tan(kCutoff * kPi / 180) * cosine;
      const double shown =
          textured ? image(false, 0.5 + 0.5 * glm::dot(w, x) / wide, 0.5 + 0.5 * glm::dot(w, y) / wide) : 1;
      return 2 * share * shown / (kPi * kRadius * kRadius);
    };
    cases.push_back({textured ? "TexturedRoundSpot" : "RoundSpot",
                     [=](SceneDescription& scene) {
                       SpotLight light = spot;
                       if (textured) light.texture.texture = add_image(scene, false);
                       scene.emitters.emplace_back(light);
                     },
                     [=] {
                       return integral([&](double s, double t) {
                         const double theta = kPi * t, phi = 2 * kPi * s;
                         const dvec3 out =
                             std::sin(theta) * (std::cos(phi) * x + std::sin(phi) * y) + std::cos(theta) * z;
                         const dvec3 point = at + kRadius * out;
                         if (glm::dot(out, point) >= 0) return 0.0;  // the far side
                         return radiance(point) *
                                of_area(point, out, 2 * kPi * kPi * kRadius * kRadius * std::sin(theta));
                       });
                     },
                     false});
  }
}

/// Flat lights that shine into a cone: (tan h - tan a) / (tan h - h) of their radiance, by Cycles' softboxes.
void add_spread(std::vector<EmitterCase>& cases) {
  const dvec3 a(0.3, 1.3, 0.6), u(-0.4, 0.3, -0.7), v(-0.9, 0.2, 0.1), n = glm::normalize(glm::cross(v, u));
  const dvec3 disk(0.3, 1.6, -0.5), z = -glm::normalize(disk + dvec3(0.3, 0, 0.1)),
                                    x = glm::normalize(glm::cross(dvec3(0, 0, 1), z)), y = glm::cross(z, x);
  constexpr double kDisk = 0.5;
  for (const double degrees : {30.0, 120.0}) {
    const double h = degrees * kPi / 360;
    const auto share = [h](const dvec3& point, const dvec3& normal) {
      const double cosine = -glm::dot(glm::normalize(point), normal), angle = std::acos(cosine);
      return angle < h ? (std::tan(h) - std::tan(angle)) / (std::tan(h) - h) : 0;
    };
    const auto add = [&](const std::string& name, const decltype(Shape::geometry)& geometry,
                         const std::function<double(double, double)>& value) {
      cases.push_back({name + std::to_string(int(degrees)),
                       [=](SceneDescription& scene) {
                         scene.shapes.push_back(shape_of(geometry, kNoTexture));
                         scene.shapes.back().emission_spread = degrees;
                       },
                       [=] { return 0.5 * integral(value); }});
    };
    Mesh rectangle, triangle;
    rectangle.positions = {a, a + v, a + u + v, a + u};
    rectangle.triangles = {{0, 1, 2}, {0, 2, 3}};
    triangle = rectangle;
    triangle.triangles.pop_back();
    add("SpreadParallelogram", rectangle, [=](double s, double t) {
      const dvec3 at = a + s * u + t * v;
      return share(at, n) * of_area(at, n, glm::length(glm::cross(u, v)));
    });
    // Of the half where t >= s, by (s t, t).
    add("SpreadTriangle", triangle, [=](double s, double t) {
      const dvec3 at = a + s * t * u + t * v;
      return share(at, n) * of_area(at, n, t * glm::length(glm::cross(u, v)));
    });
    add("SpreadDisk", Disk{disk, z, kDisk, x, y}, [=](double s, double t) {
      const double r = kDisk * s, phi = 2 * kPi * t;
      const dvec3 at = disk + r * (std::cos(phi) * x + std::sin(phi) * y);
      return share(at, z) * of_area(at, z, 2 * kPi * r * kDisk);
    });
  }
}

std::vector<EmitterCase> cases() {
  std::vector<EmitterCase> all;
  add_textured_shapes(all);
  add_beams(all);
  add_lamps(all);
  add_spread(all);
  return all;
}

class Emitters : public testing::TestWithParam<EmitterCase> {};
INSTANTIATE_TEST_SUITE_P(All, Emitters, testing::ValuesIn(cases()),
                         [](const auto& tested) { return tested.param.name; });

struct Method {
  std::string name;
  IntegratorSettings integrator;
  bool samples = true;  ///< lights
};

std::vector<Method> methods() {
  std::vector<Method> all;
  const auto add = [&](std::string name, IntegratorSettings settings, bool samples = true) {
    limit_depth(settings, 2);
    all.push_back({std::move(name), settings, samples});
  };
  add("direct, directions alone", direct_integrator(0, 1), false);
  add("direct, emitters alone", direct_integrator(1, 0));
  add("direct, balance", direct_integrator(1, 1));
  add("direct, power of 2 and 3", direct_integrator(2, 3, MisHeuristic::kPower));
  IntegratorSettings by_contribution = direct_integrator(2, 0);
  param::light_choice(by_contribution) = LightChoice::kAnalytic;
  add("direct, emitters by contribution", by_contribution);
  for (const DirectSampling sampling : {DirectSampling::kEmitterOnly, DirectSampling::kMis})
    add("path", path_integrator(sampling));
  add("polygon_cv", polygon_cv(0.7f, EmitterSampling::kAuto, 2));
  return all;
}

TEST_P(Emitters, EveryStrategyHasTheKnownMean) {
  const EmitterCase& tested = GetParam();
  const double reflected = tested.reflected();
  ManyTests tests;
  bool varies = false;  // points give every sample the same
  std::uint32_t seed = 1;
  for (const EmitterSampling sampling : {EmitterSampling::kAuto, EmitterSampling::kArea,
                                         EmitterSampling::kSolidAngle, EmitterSampling::kProjected})
    for (const Method& method : methods()) {
      SceneDescription scene =
          receiver_scene(DiffuseBsdf{glm::vec3(float(kReflectance))}, kViewer, kPixels, seed++);
      tested.add(scene);
      scene.integrator = method.integrator;
      param::emitter_sampling(scene.integrator) = sampling;
      scene.sampler.spp = kSamples;
      TestDevice device = native_device();
      device.samples_per_pass = kSamples;
      const statistics::Sample sample = film_sample(render_or_throw(scene, device), 1);
      const double expected = method.samples || tested.found ? reflected : 0;
      const double rounding = (tested.found || sample.variance() > 0 ? kQuadrature : kRounding) * expected;
      if (sample.variance() > 0) {
        varies = true;
        tests.add(statistics::t_test(sample, expected, rounding), method.name);
      } else {
        EXPECT_NEAR(sample.mean(), expected, rounding) << method.name;
      }
    }
  if (varies) tests.expect_passed(kSignificance / double(cases().size()));
}

}  // namespace
}  // namespace penumbra
