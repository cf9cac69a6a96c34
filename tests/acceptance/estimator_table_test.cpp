// All strategies for direct light have the same expectation, for all combinations of kinds of lights: every
// pair of strategies that MIS combines, at a point of a floor whose reflected radiance is known by quadrature
// in double.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/unit_square.h"

namespace penumbra::estimator_table_test {
namespace {

using glm::dvec3;

constexpr double kSignificance = 0.01;
constexpr double kRounding = 64.0 / (1 << 24);  ///< relative; see furnace_test.cpp
constexpr double kPi = std::numbers::pi;
constexpr int kPixels = 8;
constexpr std::uint32_t kSamples = 256;  ///< of each pixel, all of which see the same point
const dvec3 kViewer(0.6, 1.1, -0.4);

/// f cos of the floor's BSDF for light from the unit direction wi, above the floor or below it.
double scattered(const BsdfModel& model, const dvec3& wi) {
  if (wi.y <= 0) return 0;
  const dvec3 wo = glm::normalize(kViewer), mirror(-wo.x, wo.y, -wo.z);
  if (const auto* diffuse = std::get_if<DiffuseBsdf>(&model))
    return diffuse->reflectance.value.y / kPi * wi.y;
  const PhongBsdf& phong = std::get<PhongBsdf>(model);
  const double lobe = std::pow(std::max(glm::dot(wi, mirror), 0.0), double(phong.exponent.value));
  return (phong.diffuse.value.y / kPi +
          phong.specular.value.y * (phong.exponent.value + 2) / (2 * kPi) * lobe) *
         wi.y;
}

double integral(const std::function<double(double, double)>& value) {
  return unit_square_integral(600, value);
}

/// What a surface of radiance 1 adds whose point at (u, v) stands for `area`; its front has this normal.
double by_area(const BsdfModel& bsdf, const dvec3& at, const dvec3& normal, double area) {
  const double d2 = glm::dot(at, at);
  const dvec3 wi = at / std::sqrt(d2);
  return scattered(bsdf, wi) * std::max(-glm::dot(normal, wi), 0.0) / d2 * area;
}

/// A kind of light, where it is the only one of it, and what it adds. None hides another.
struct LightKind {
  std::string name;
  std::function<void(SceneDescription&)> add;
  std::function<double(const BsdfModel&)> reflected;
};

const dvec3 kCorner(-0.9, 1.1, -1.2), kAlongU(0.1, 0.5, 0.7), kAlongV(-0.9, 1.3, -0.4);
const dvec3 kOutlineAt(-1.2, 0.55, 0.9), kOutlineX(0.6, 0, 0.8), kOutlineY(0.2, 0.5, -0.15);
const dvec3 kA(0.5, 1.3, 0.9), kB(-0.7, 1.5, 1.0), kC(0.1, 2.1, 0.2);
const dvec3 kSphereCenter(1.9, 1.4, 0.3), kPoint(0.3, 0.7, -1.1);
const dvec3 kDiskCenter(0.3, 1.9, -0.9), kDiskNormal = glm::normalize(dvec3(-0.2, -0.9, 0.5));
constexpr double kSphereRadius = 0.8, kDiskRadius = 0.5, kIntensity = 0.6;

/// Turned so that it faces the origin.
std::array<dvec3, 3> facing(const dvec3& a, const dvec3& b, const dvec3& c) {
  return glm::dot(glm::cross(b - a, c - a), a) < 0 ? std::array{a, b, c} : std::array{a, c, b};
}

double reflected_of_sphere(const BsdfModel& bsdf) {
  const double d2 = glm::dot(kSphereCenter, kSphereCenter);
  const double versine = 1 - std::sqrt(1 - kSphereRadius * kSphereRadius / d2);
  const dvec3 n = kSphereCenter / std::sqrt(d2), s = glm::normalize(glm::cross(n, dvec3(0, 0, 1)));
  const dvec3 t = glm::cross(n, s);
  return 2 * kPi * versine * integral([&](double u, double v) {
           const double z = 1 - u * versine, r = std::sqrt(1 - z * z), phi = 2 * kPi * v;
           return scattered(bsdf, z * n + r * std::cos(phi) * s + r * std::sin(phi) * t);
         });
}

double reflected_of_disk(const BsdfModel& bsdf) {
  const dvec3 s = glm::normalize(glm::cross(kDiskNormal, dvec3(0, 0, 1))), t = glm::cross(kDiskNormal, s);
  return integral([&](double u, double v) {
    const double r = kDiskRadius * std::sqrt(u), phi = 2 * kPi * v;
    return by_area(bsdf, kDiskCenter + r * std::cos(phi) * s + r * std::sin(phi) * t, kDiskNormal,
                   kPi * kDiskRadius * kDiskRadius);
  });
}

/// A dented quadrilateral: its triangles have a corner each where the other is not.
const std::array<std::array<dvec3, 3>, 2> kOutline{
    facing(kOutlineAt - 0.1 * kOutlineY, kOutlineAt + 0.4 * kOutlineX - 0.5 * kOutlineY,
           kOutlineAt + 0.5 * kOutlineY),
    facing(kOutlineAt - 0.1 * kOutlineY, kOutlineAt + 0.5 * kOutlineY,
           kOutlineAt - 0.3 * kOutlineX - 0.4 * kOutlineY)};

double reflected_of_triangle(const BsdfModel& bsdf, const std::array<dvec3, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const dvec3 at = a, ab = b - a, ac = c - a, n = glm::cross(ab, ac);
  return integral([&](double x, double y) {
    return by_area(bsdf, at + x * (1 - y) * ab + x * y * ac, glm::normalize(n), x * glm::length(n));
  });
}

/// Of radiance 1 from everywhere above.
double reflected_of_sky(const BsdfModel& bsdf) {
  return 2 * kPi * integral([&](double u, double v) {
           const double r = std::sqrt(1 - u * u), phi = 2 * kPi * v;
           return scattered(bsdf, dvec3(r * std::cos(phi), u, r * std::sin(phi)));
         });
}

Shape light_of(const decltype(Shape::geometry)& geometry) {
  Shape shape;
  shape.name = "light";
  shape.geometry = geometry;
  shape.radiance = glm::vec3(1);
  return shape;
}

std::vector<LightKind> kinds() {
  const auto [p, pu, pv] = facing(kCorner, kCorner + kAlongU, kCorner + kAlongV);
  const dvec3 corner = p, u = pu - p, v = pv - p, uv = glm::cross(u, v);
  return {
      {"rectangle",
       [=](SceneDescription& scene) {
         scene.shapes.push_back(parallelogram(corner, u, v, kBlackBsdf, 1.0f));
       },
       [=](const BsdfModel& bsdf) {
         return integral([&](double x, double y) {
           return by_area(bsdf, corner + x * u + y * v, glm::normalize(uv), glm::length(uv));
         });
       }},
      {"triangle",
       [](SceneDescription& scene) {
         scene.shapes.push_back(triangles(facing(kA, kB, kC), kBlackBsdf, 1.0f));
       },
       [](const BsdfModel& bsdf) { return reflected_of_triangle(bsdf, facing(kA, kB, kC)); }},
      {"triangles",
       [](SceneDescription& scene) {
         const auto& [s, t] = kOutline;
         scene.shapes.push_back(triangles(std::array{s[0], s[1], s[2], t[0], t[1], t[2]}, kBlackBsdf, 1.0f));
       },
       [](const BsdfModel& bsdf) {
         return reflected_of_triangle(bsdf, kOutline[0]) + reflected_of_triangle(bsdf, kOutline[1]);
       }},
      {"sphere",
       [](SceneDescription& scene) {
         scene.shapes.push_back(light_of(Sphere{kSphereCenter, kSphereRadius}));
       },
       reflected_of_sphere},
      {"disk",
       [](SceneDescription& scene) {
         scene.shapes.push_back(light_of(Disk{kDiskCenter, kDiskNormal, kDiskRadius}));
       },
       reflected_of_disk},
      {"point",
       [](SceneDescription& scene) {
         scene.emitters.emplace_back(PointLight{kPoint, glm::vec3(float(kIntensity))});
       },
       [](const BsdfModel& bsdf) {
         const double d2 = glm::dot(kPoint, kPoint);
         return kIntensity / d2 * scattered(bsdf, kPoint / std::sqrt(d2));
       }},
      {"constant",
       [](SceneDescription& scene) { scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)}); },
       reflected_of_sky},
  };
}

constexpr int kPointKind = 5, kConstantKind = 6;

struct Method {
  std::string name;
  IntegratorSettings integrator;
  bool finds_points = true;
};

/// Every integrator, and with `mis` of one every heuristic and every other way of choosing directions.
std::vector<Method> methods() {
  std::vector<Method> all;
  const auto add = [&](std::string name, IntegratorSettings settings, bool finds_points = true) {
    limit_depth(settings, 2);
    all.push_back({std::move(name), settings, finds_points});
  };
  const std::array directions{BsdfSampling::kBsdf, BsdfSampling::kCosine, BsdfSampling::kUniform};
  const std::array names{"bsdf", "cosine", "uniform"};
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const auto direct = [&](const std::string& name, int n_g, int n_f, MisHeuristic heuristic) {
      IntegratorSettings settings = direct_integrator(n_g, n_f, heuristic);
      param::bsdf_sampling(settings) = directions[k];
      add("direct, " + name + " with " + names[k], settings, n_g > 0);
    };
    direct("directions alone", 0, 1, MisHeuristic::kBalance);
    direct("balance", 1, 1, MisHeuristic::kBalance);
    direct("power", 1, 1, MisHeuristic::kPower);
    direct("balance of 3 and 2", 3, 2, MisHeuristic::kBalance);
    direct("power of 1 and 3", 1, 3, MisHeuristic::kPower);
  }
  add("direct, emitters alone", direct_integrator(1, 0));
  IntegratorSettings by_contribution = direct_integrator(2, 0);
  param::light_choice(by_contribution) = LightChoice::kAnalytic;
  add("direct, emitters alone, by contribution", by_contribution);
  for (NextEvent next : {NextEvent::kSample, NextEvent::kCv}) {
    const std::string suffix = next == NextEvent::kCv ? " with control variates" : "";
    const auto path = [&](const std::string& name, DirectSampling sampling, MisHeuristic heuristic) {
      IntegratorSettings settings = path_integrator(sampling);
      param::heuristic(settings) = heuristic;
      param::next_event(settings) = next;
      if (next == NextEvent::kCv) param::alpha(settings) = 0.7f;
      add(name + suffix, settings);
    };
    if (next == NextEvent::kSample) path("path_mats", DirectSampling::kBsdfOnly, MisHeuristic::kBalance);
    path("path_ems", DirectSampling::kEmitterOnly, MisHeuristic::kBalance);
    path("path_mis, balance", DirectSampling::kMis, MisHeuristic::kBalance);
    path("path_mis, power", DirectSampling::kMis, MisHeuristic::kPower);
  }
  IntegratorSettings area = direct_integrator(2, 0);
  use(area, IntegratorKind::kPolygonArea);
  add("polygon_area", area);
  add("polygon_cv", polygon_cv(0.7f, EmitterSampling::kAuto, 2));
  return all;
}

/// Each kind by itself, each pair and all.
std::vector<unsigned> combinations() {
  std::vector<unsigned> sets;
  for (unsigned i = 0; i <= kConstantKind; ++i)
    for (unsigned j = i; j <= kConstantKind; ++j) sets.push_back(1u << i | 1u << j);
  sets.push_back((2u << kConstantKind) - 1);
  return sets;
}

struct Table {
  std::string name;
  EmitterSampling sampling;
  BsdfModel bsdf;
};
void PrintTo(const Table& table, std::ostream* out) { *out << table.name; }

class EstimatorTable : public testing::TestWithParam<Table> {};

TEST_P(EstimatorTable, EveryEstimatorHasTheKnownMean) {
  const auto& [name, sampling, bsdf] = GetParam();
  const std::vector<LightKind> all = kinds();
  std::vector<double> reflected;
  for (const LightKind& kind : all) reflected.push_back(kind.reflected(bsdf));
  ManyTests tests;
  std::uint32_t seed = 1;
  for (const unsigned set : combinations()) {
    std::string lights;
    // Beside a sky of their own radiance the other lights' surfaces change nothing.
    const bool sky = (set >> kConstantKind & 1u) != 0;
    double sum = sky ? reflected[kConstantKind] : 0;
    for (int k = 0; k < kConstantKind; ++k)
      if ((set >> k & 1u) != 0 && k != kPointKind && !sky) sum += reflected[std::size_t(k)];
    const double points = (set >> kPointKind & 1u) != 0 ? reflected[kPointKind] : 0;
    for (const Method& method : methods()) {
      SceneDescription scene = receiver_scene(bsdf, kViewer, kPixels, seed++);
      lights.clear();
      for (std::size_t k = 0; k < all.size(); ++k) {
        if ((set >> k & 1u) == 0) continue;
        all[k].add(scene);
        lights += (lights.empty() ? "" : " + ") + all[k].name;
      }
      scene.integrator = method.integrator;
      param::emitter_sampling(scene.integrator) = sampling;
      scene.sampler.spp = kSamples;
      TestDevice device = native_device();
      device.samples_per_pass = kSamples;
      const statistics::Sample sample = film_sample(render_or_throw(scene, device), 1);
      const double expected = sum + (method.finds_points ? points : 0);
      const std::string what = lights + ": " + method.name;
      if (sample.variance() > 0)
        tests.add(statistics::t_test(sample, expected, kRounding * expected), what);
      else
        EXPECT_NEAR(sample.mean(), expected, kRounding * expected) << what;
    }
  }
  tests.expect_passed(kSignificance);
}

const PhongBsdf kGlossy{glm::vec3(0.3f), glm::vec3(0.5f), 12};

std::vector<Table> tables() {
  using enum EmitterSampling;
  std::vector<Table> all;
  const std::array samplings{kAuto, kArea, kSolidAngle, kProjected};
  const std::array names{"Auto", "Area", "SolidAngle", "Projected"};
  for (std::size_t k = 0; k < samplings.size(); ++k) {
    all.push_back({std::string(names[k]) + "Diffuse", samplings[k], DiffuseBsdf{glm::vec3(0.8f)}});
    all.push_back({std::string(names[k]) + "Glossy", samplings[k], kGlossy});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Samplings, EstimatorTable, testing::ValuesIn(tables()),
                         [](const auto& table) { return table.param.name; });

}  // namespace
}  // namespace penumbra::estimator_table_test
