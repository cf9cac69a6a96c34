// Lights that move: at every time they are what a scene that stands still at that time has, built here in
// extended precision from the states on both sides. So are their samples, densities and photons.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "kernels/light/light_emission.h"
#include "kernels/light/light_unshadowed.h"
#include "kernels/light/lobe_projection.h"
#include "scenes/emitters.h"
#include "tests/kernels/light_scenes.h"
#include "tests/kernels/polygon/polygon_lights.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::moving_light_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSignificance = 0.001;
// Places between states are rounded once more than those of the still scene, to a few 1e-7; where light is
// not at a grazing angle, densities amplify that by less than a hundred.
constexpr double kPlaceTolerance = 3e-6, kDensityTolerance = 2e-4;
constexpr float kLeastCosine = 0.1f;
constexpr float kGrazing = 500;  // densities above are those of light at a grazing angle

const vec3 kHere = make_vec3(0.3f, -0.2f, 0.1f);
constexpr float kTimes[] = {0.0f, 0.21f, 0.5f, 0.618f, 1.0f};

/// What describes a light at a time: places, directions, and a radius and a length.
struct Pose {
  std::array<Exact3, 3> places;
};

Pose between(const Pose& a, const Pose& b, long double f) {
  Pose p;
  for (std::size_t k = 0; k < 3; ++k) p.places[k] = a.places[k] + f * (b.places[k] - a.places[k]);
  return p;
}

struct Mover {
  std::string name;
  std::array<Pose, 3> states;
  std::function<SceneTables(const Pose&)> at;  ///< the scene of a pose, whose directions need not be unit

  /// The scene that stands still at a time, by linear interpolation.
  [[nodiscard]] SceneTables still(double time) const {
    const double at_state = time * 2;
    const int from = at_state < 1 ? 0 : 1;
    return at(between(states[std::size_t(from)], states[std::size_t(from) + 1], at_state - from));
  }

  /// The scene of the middle, with its states.
  [[nodiscard]] SceneTables moving() const {
    SceneTables tables = at(states[1]);
    tables.header.features |= FEATURE_MOTION;
    Shutter shutter{};
    shutter.still_triangles = shutter.still_quadrics = 0;
    tables.shutter.push_back(shutter);
    // In the reverse order, to use strides.
    tables.light_motions.push_back({2, -1, 2});
    if (!tables.quadrics.empty()) tables.quadric_motions.push_back({2, -1, 2});
    for (const int k : {2, 1, 0}) {
      const SceneTables state = at(states[std::size_t(k)]);
      const Light& light = state.lights[0];
      const Beam beam = state.beams.empty() ? Beam{} : state.beams[0];
      tables.light_states.push_back({light.p0, light.p1, light.p2, beam.x, beam.y, beam.z});
      if (!state.quadrics.empty()) tables.quadric_states.push_back(state.quadrics[0]);
    }
    return tables;
  }
};

/// With texture coordinates.
SceneTables with_uvs(SceneTables tables) {
  const bool flat = !tables.triangles.empty();
  if (flat) tables.vertex_uvs.push_back({0.1f, 0.2f, 0.7f, 0.3f, 0.4f, 0.9f});
  tables.light_triangles.push_back(flat ? LightTriangles{0, 0, -1} : LightTriangles{-1, -1, 0});
  tables.header.features |= FEATURE_UV;
  return tables;
}

SceneTables triangle_at_pose(const Pose& p, int sampling) {
  SceneTables tables = triangle_light(rounded(p.places[0]), rounded(p.places[1]), rounded(p.places[2]),
                                      sampling == EMITTER_SOLID_ANGLE);
  if (sampling == EMITTER_PROJECTED) tables.header.features |= FEATURE_PROJECTED;
  tables.lights[0].sampling = sampling;
  return with_uvs(tables);
}

/// Centre, pole, and radius, length and turn.
SceneTables quadric_at_pose(const Pose& p, int kind, float orientation, bool by_solid_angle) {
  const vec3 pole = rounded(normalize(p.places[1]));
  Quadric q = quadric_about(kind, rounded(p.places[0]), pole, float(p.places[2].x), orientation);
  q.length = kind == QUADRIC_CYLINDER ? float(p.places[2].y) : 1;
  return with_uvs(quadric_light(q, by_solid_angle));
}

SceneTables directional_at_pose(const Pose& p, int kind) {
  SceneTables tables;
  tables.header.environment = -1;
  tables.header.sun_count = kind == LIGHT_SUN ? 1 : 0;
  Light light = only_light(kind);
  light.p1 = rounded(normalize(p.places[1]));
  light.area = 0.05f;
  tables.lights.push_back(light);
  return tables;
}

struct Frame {
  Exact3 x, y, z;
};
/// With the z axis along `z` and x on the side of `x`; not mirrored.
Frame frame_along(const Exact3& z, const Exact3& x) {
  Frame f;
  f.z = normalize(z);
  f.x = normalize(x - dot(x, f.z) * f.z);
  f.y = cross(f.z, f.x);
  return f;
}

SceneTables beam_at_pose(const Pose& p, int kind) {
  SceneTables tables = point_light(rounded(p.places[0]));
  const Frame f = frame_along(p.places[1], p.places[2]);
  tables.lights[0].kind = kind;
  tables.lights[0].sampling = EMITTER_SOLID_ANGLE;
  if (kind == LIGHT_ROUND_SPOT) tables.lights[0].p2 = make_vec3(0.25f, 1, 0);
  Beam beam{};
  beam.x = rounded(f.x), beam.y = rounded(f.y), beam.z = rounded(f.z);
  beam.u_by_x = 0.4f;
  beam.v_by_y = -0.3f;
  beam.falloff = SPOT_LINEAR;
  beam.beam_width = 0.2f;
  beam.cutoff = 1.4f;
  beam.inverse_width = 1 / 1.2f;
  tables.beams.push_back(beam);
  return tables;
}

SceneTables envmap_at_pose(const Pose& p) {
  constexpr int kWidth = 6, kHeight = 5;
  const Frame f = frame_along(p.places[1], p.places[2]);
  Bitmap image{"map", kWidth, kHeight, 3, TexelType::kFloat, {}};
  for (int i = 0; i < kWidth * kHeight * 3; ++i) image.words.push_back(FLOAT_BITS(float(1 + i * 7 % 11)));
  EnvironmentMapLight map;
  map.image = std::make_shared<const Bitmap>(std::move(image));
  // The image's pole is its y axis.
  const auto column = [](const Exact3& v) { return glm::dvec4(v.x, v.y, v.z, 0); };
  map.to_world = glm::dmat4(column(f.x), column(f.z), column(-1.0L * f.y), glm::dvec4(0, 0, 0, 1));
  map.scale = 1;
  SceneTables tables;
  Light light =
      map.light({[](const glm::dvec3& at) { return to_vec3(at); }, 1.0, tables, nullptr, false}).light;
  light.pmf = 1;
  tables.lights.push_back(light);
  tables.header.environment = 0;
  return tables;
}

const std::array<Pose, 3> kTriangle{{{{{{-1, -1, 1.5L}, {0, 1.5L, 2}, {1.5L, -1, 1}}}},
                                     {{{{-1.2L, -0.8L, 1.8L}, {0.3L, 1.1L, 2.4L}, {1.9L, -1.1L, 1.2L}}}},
                                     {{{{-0.6L, -0.9L, 2.2L}, {0.8L, 0.9L, 2.1L}, {1.6L, -0.4L, 1.7L}}}}}};
/// Beyond the receiver's height of 1, with poles that turn down to it.
const std::array<Pose, 3> kRound{{{{{{0, 0.4L, 2}, {0.1L, 0.3L, -1}, {0.6L, 0.9L, 0}}}},
                                  {{{{0.7L, 0.2L, 2.3L}, {-0.3L, 0.2L, -0.9L}, {0.8L, 1.2L, 0}}}},
                                  {{{{1, -0.5L, 1.9L}, {-0.4L, -0.3L, -1}, {0.7L, 0.7L, 0}}}}}};
const std::array<Pose, 3> kAxes{{{{{{0, 0.4L, 2}, {0.1L, 0.3L, -1}, {1, 0.2L, 0.1L}}}},
                                 {{{{0.7L, 0.2L, 2.3L}, {-0.3L, 0.2L, -0.9L}, {0.9L, 0.4L, -0.1L}}}},
                                 {{{{1, -0.5L, 1.9L}, {-0.4L, -0.3L, -1}, {0.8L, 0.6L, 0.1L}}}}}};

std::vector<Mover> movers() {
  std::vector<Mover> all;
  // Directions are unit and frames orthonormal at the states: so are those of lights.
  const auto as_it_is = [](const Pose& p) { return p; };
  const auto with_pole = [](const Pose& p) {
    return Pose{{p.places[0], normalize(p.places[1]), p.places[2]}};
  };
  const auto with_frame = [](const Pose& p) {
    const Frame f = frame_along(p.places[1], p.places[2]);
    return Pose{{p.places[0], f.z, f.x}};
  };
  const auto add = [&](const char* name, const std::array<Pose, 3>& states, auto prepare, auto make) {
    all.push_back({name, {prepare(states[0]), prepare(states[1]), prepare(states[2])}, make});
  };
  add("TriangleByArea", kTriangle, as_it_is, [](const Pose& p) { return triangle_at_pose(p, EMITTER_AREA); });
  add("TriangleBySolidAngle", kTriangle, as_it_is,
      [](const Pose& p) { return triangle_at_pose(p, EMITTER_SOLID_ANGLE); });
  for (const bool cone : {false, true})
    add(cone ? "SphereByCone" : "SphereByArea", kRound, with_pole,
        [=](const Pose& p) { return quadric_at_pose(p, QUADRIC_SPHERE, 1, cone); });
  add("Disk", kRound, with_pole, [](const Pose& p) { return quadric_at_pose(p, QUADRIC_DISK, 1, false); });
  add("Cylinder", kRound, with_pole,
      [](const Pose& p) { return quadric_at_pose(p, QUADRIC_CYLINDER, 1, false); });
  add("Point", kAxes, as_it_is, [](const Pose& p) { return point_light(rounded(p.places[0])); });
  for (const int kind : {LIGHT_DIRECTIONAL, LIGHT_SUN})
    add(kind == LIGHT_SUN ? "Sun" : "Directional", kAxes, with_frame,
        [=](const Pose& p) { return directional_at_pose(p, kind); });
  add("RoundSpot", kAxes, with_frame, [](const Pose& p) { return beam_at_pose(p, LIGHT_ROUND_SPOT); });
  add("Spot", kAxes, with_frame, [](const Pose& p) { return beam_at_pose(p, LIGHT_SPOT); });
  add("Projector", kAxes, with_frame, [](const Pose& p) { return beam_at_pose(p, LIGHT_PROJECTOR); });
  add("EnvironmentMap", kAxes, with_frame, envmap_at_pose);
  return all;
}

Surface receiver_in_medium(float time) {
  Surface s = surface_in_medium(kHere);
  s.time = time;
  return s;
}

void expect_near(const vec3& a, const vec3& b, double tolerance) {
  ASSERT_NEAR(a.x, b.x, tolerance);
  ASSERT_NEAR(a.y, b.y, tolerance);
  ASSERT_NEAR(a.z, b.z, tolerance);
}

class MovingLight : public testing::TestWithParam<int> {
 protected:
  const Mover mover_ = movers()[std::size_t(GetParam())];
};
INSTANTIATE_TEST_SUITE_P(All, MovingLight, testing::Range(0, 13),
                         [](const auto& tested) { return movers()[std::size_t(tested.param)].name; });

TEST(MovingLights, AreAllTested) { EXPECT_EQ(movers().size(), 13u); }

TEST_P(MovingLight, IsAtEachTimeTheStillOne) {
  SceneTables moving = mover_.moving();
  const Scene scene = moving.scene();
  for (const float time : kTimes) {
    const Light expected = mover_.still(double(time)).lights[0];
    const Light light = light_at(&scene, 0, time, FEATURE_MOTION);
    expect_near(light.p0, expected.p0, kPlaceTolerance);
    if (expected.kind != LIGHT_SPHERE) expect_near(light.p1, expected.p1, kPlaceTolerance);  // unused there
    expect_near(light.p2, expected.p2, kPlaceTolerance);
    EXPECT_NEAR(light.area, expected.area, kPlaceTolerance * double(expected.area));
    // Elsewhere, that of the middle.
    EXPECT_EQ(light_at(&scene, 0, time, 0u).p0.x, moving.lights[0].p0.x);
  }
}

TEST_P(MovingLight, SamplesAreThoseOfTheStillOne) {
  SceneTables moving = mover_.moving();
  const Scene scene = moving.scene();
  RandomNumbers random(1);
  int compared = 0;
  for (const float time : kTimes) {
    SceneTables standing = mover_.still(double(time));
    const Scene still = standing.scene();
    for (int i = 0; i < 300; ++i) {
      const float u = random.unit_float(), v = random.unit_float(), fine = random.unit_float();
      const LightSample expected = sample_light(still, surface_in_medium(kHere), u, v, fine);
      const LightSample s = sample_light(scene, receiver_in_medium(time), u, v, fine);
      if (!(expected.tmax > 0) || expected.pdf > kGrazing) continue;
      ASSERT_GT(s.tmax, 0);
      expect_near(s.wi, expected.wi, 30 * kPlaceTolerance);
      ASSERT_NEAR(s.pdf / expected.pdf, 1, 5 * kDensityTolerance);
      ASSERT_NEAR(s.radiance.y, expected.radiance.y, kDensityTolerance * double(expected.radiance.y) + 1e-6);
      ++compared;
    }
  }
  EXPECT_GT(compared, 100);
}

TEST_P(MovingLight, DensityOfASampleIsThatOfTheLightFound) {
  SceneTables moving = mover_.moving();
  const Scene scene = moving.scene();
  const int kind = moving.lights[0].kind;
  const bool found_by_rays = kind == LIGHT_TRIANGLE || kind == LIGHT_SPHERE || kind == LIGHT_DISK ||
                             kind == LIGHT_CYLINDER || is_infinite_light(kind);
  if (!found_by_rays || kind == LIGHT_DIRECTIONAL) GTEST_SKIP() << "no ray finds it";
  RandomNumbers random(2);
  int compared = 0;
  for (const float time : kTimes) {
    SceneTables standing = mover_.still(double(time));
    const Scene still = standing.scene();
    for (int i = 0; i < 300; ++i) {
      const float u = random.unit_float(), v = random.unit_float(), fine = random.unit_float();
      const LightSample light = sample_light(scene, receiver_in_medium(time), u, v, fine);
      if (!(light.tmax > 0)) continue;
      Surface found = surface_at(&still, is_infinite_light(kind) ? -1 : 0, kHere, light.wi);
      found.time = time;
      const bool is_rim =
          !(found.distance > 0) || !found.front || dot3(found.geometric, found.wo) < kLeastCosine;
      if (!is_infinite_light(kind) && is_rim) continue;
      const Emission emission = emission_at(scene, found);
      ASSERT_NEAR(emission.radiance.y / light.radiance.y, 1, kDensityTolerance);
      ASSERT_NEAR(light.pdf / emission.pdf, 1, 5 * kDensityTolerance);
      ++compared;
    }
  }
  EXPECT_GT(compared, 100);
}

TEST_P(MovingLight, PhotonsLeaveTheStillOne) {
  SceneTables moving = mover_.moving();
  moving.header.integrator.emission_radius = 5;
  const Scene scene = moving.scene();
  RandomNumbers random(3);
  for (const float time : kTimes) {
    SceneTables standing = mover_.still(double(time));
    standing.header.integrator.emission_radius = 5;
    const Scene still = standing.scene();
    float number[LANES], v[LANES], fine[LANES], s[LANES], t[LANES];
    for (int j = 0; j < LANES; ++j) {
      number[j] = random.unit_float(), v[j] = random.unit_float(), fine[j] = random.unit_float();
      s[j] = random.unit_float(), t[j] = random.unit_float();
    }
    LightSamples rays, expected;
    emit_rays(&scene, time, number, v, fine, s, t, &rays);
    emit_rays(&still, 0.5f, number, v, fine, s, t, &expected);
    for (int j = 0; j < LANES; ++j) {
      const LightSample ray = load_light_sample(&rays, j), other = load_light_sample(&expected, j);
      ASSERT_EQ(ray.tmax > 0, other.tmax > 0);
      expect_near(ray.origin, other.origin, 30 * kPlaceTolerance);
      expect_near(ray.toward, other.toward, 30 * kPlaceTolerance);
      ASSERT_NEAR(ray.radiance.y, other.radiance.y, kDensityTolerance * double(other.radiance.y));
    }
  }
}

/// The mean of what arrives, at random times, is the mean solid angle over the time, by its closed form.
void expect_mean(const Mover& mover, const std::function<double(const Light&)>& solid_angle) {
  constexpr int kSamples = 50'000, kSteps = 400;
  SceneTables moving = mover.moving();
  const Scene scene = moving.scene();
  RandomNumbers random(4);
  statistics::Sample arriving;
  for (int i = 0; i < kSamples; ++i) {
    const float time = random.unit_float(), u = random.unit_float(), v = random.unit_float();
    const LightSample light = sample_light(scene, receiver_in_medium(time), u, v, random.unit_float());
    arriving.add(light.tmax > 0 ? double(light.radiance.y) / double(light.pdf) : 0);
  }
  double expected = 0;
  for (int k = 0; k < kSteps; ++k)
    expected += solid_angle(mover.still((k + 0.5) / kSteps).lights[0]) / kSteps;
  expected *= double(moving.lights[0].radiance.y);
  EXPECT_GT(statistics::t_test(arriving, expected, 2e-5 * expected).p, kSignificance)
      << arriving.mean() << " instead of " << expected;
}

TEST(MovingLights, OfATriangleArriveAsItsMeanSolidAngleSays) {
  for (const Mover& mover : movers())
    if (mover.name.starts_with("Triangle"))
      expect_mean(mover, [](const Light& light) {
        const Exact3 here = exact(kHere);
        return exact_solid_angle(exact(light.p0) - here, exact(light.p1) - here, exact(light.p2) - here);
      });
}

TEST(MovingLights, OfASphereArriveAsItsMeanSolidAngleSays) {
  for (const Mover& mover : movers())
    if (mover.name.starts_with("Sphere"))
      expect_mean(mover, [](const Light& light) {
        const Exact3 way = exact(light.p0) - exact(kHere);
        const double ratio2 = double(light.p2.x) * double(light.p2.x) / double(dot(way, way));
        return 2 * kPi * (1 - std::sqrt(1 - ratio2));
      });
}

TEST(MovingLights, DirectionsOfATurningMapHaveItsDensity) {
  // Each sample's density is 1 in the mean over the sphere at any time, and directions at one time are
  // distributed by it.
  constexpr int kSide = 8, kSamples = 60'000, kFine = 24;
  const Mover mover = movers().back();
  SceneTables moving = mover.moving();
  const Scene scene = moving.scene();
  RandomNumbers random(5);
  const float time = 0.37f;
  std::vector<double> counts(kSide * kSide), expected(kSide * kSide);
  for (int i = 0; i < kSamples; ++i) {
    const float u = random.unit_float(), v = random.unit_float();
    const vec3 wi = sample_light(scene, receiver_in_medium(time), u, v, random.unit_float()).wi;
    const auto cell = [](double x) { return std::size_t(std::clamp(x, 0.0, 1 - 1e-12) * kSide); };
    ++counts[cell(0.5 + 0.5 * double(wi.z)) * kSide +
             cell(0.5 + std::atan2(double(wi.y), double(wi.x)) / (2 * kPi))];
  }
  for (int row = 0; row < kSide * kFine; ++row)
    for (int column = 0; column < kSide * kFine; ++column) {
      const double z = 2 * (row + 0.5) / (kSide * kFine) - 1, r = std::sqrt(1 - z * z);
      const double turn = 2 * kPi * ((column + 0.5) / (kSide * kFine) - 0.5);
      const vec3 wi = make_vec3(float(r * std::cos(turn)), float(r * std::sin(turn)), float(z));
      Surface s = receiver(kHere, negate(wi));
      s.primitive = NOTHING_HIT;
      s.wo = negate(wi);
      s.time = time;
      expected[std::size_t(row / kFine * kSide + column / kFine)] +=
          double(emission_at(scene, s).pdf) * 4 * kPi / (kSide * kFine * kSide * kFine) * kSamples;
    }
  double sum = 0;
  for (const double e : expected) sum += e;
  EXPECT_NEAR(sum / kSamples, 1, 1e-3);  // of the quadrature
  for (double& e : expected) e *= kSamples / sum;
  EXPECT_GT(statistics::chi_square_test(counts, expected).p, kSignificance);
}

TEST(MovingLights, SamplesByProjectedSolidAngleAreThoseOfTheStillOne) {
  const Mover mover{"Projected", kTriangle,
                    [](const Pose& p) { return triangle_at_pose(p, EMITTER_PROJECTED); }};
  SceneTables moving = mover.moving();
  const Scene scene = moving.scene();
  RandomNumbers random(6);
  for (const float time : kTimes) {
    SceneTables standing = mover.still(double(time));
    Surface s = receiver(kHere, make_vec3(0, 0, 1));
    s.time = time;
    const LightReceiver r = receiver_of(s);
    const Light light = light_at(&scene, 0, time, FEATURE_MOTION);
    const auto area = float(light_irradiance(light, r.p.x, r.p.y, r.p.z, 0, 0, 1));
    EXPECT_NEAR(area / light_irradiance(standing.lights[0], r.p.x, r.p.y, r.p.z, 0, 0, 1), 1, 1e-5);
    for (int i = 0; i < 100; ++i) {
      const float u = random.unit_float(), v = random.unit_float();
      LightSamplings here, expected;
      clear_light_samplings(&here);
      clear_light_samplings(&expected);
      sample_projected_light(light, r, area, u, v, &here, 0);
      sample_projected_light(standing.lights[0], r, area, u, v, &expected, 0);
      const vec3 wi = LOAD_LANE_vec3(here.wi, 0);
      expect_near(wi, LOAD_LANE_vec3(expected.wi, 0), 100 * kPlaceTolerance);
      FoundLight found{};
      found.from = kHere;
      found.wi = wi;
      const float pdf = projected_density(light, found, make_vec3(0, 0, 1));
      ASSERT_NEAR(pdf / (here.scale[0] * wi.z), 1, 1e-5);
    }
  }
}

TEST(MovingLights, TextureCoordinatesMoveWithThem) {
  RandomNumbers random(7);
  for (const Mover& mover : movers()) {
    SceneTables moving = mover.moving();
    const Scene scene = moving.scene();
    const int kind = moving.lights[0].kind;
    for (const float time : kTimes)
      for (int i = 0; i < 100; ++i) {
        SceneTables standing = mover.still(double(time));
        const Scene still = standing.scene();
        const Light light = light_at(&scene, 0, time, FEATURE_MOTION);
        const LightReceiver r = receiver_of(receiver_in_medium(time));
        const float u = random.unit_float(), v = random.unit_float();
        SampledPoint point, expected;
        const auto sample = [&](const Scene* of, const Light& own, const LightAxes& axes,
                                SampledPoint* result) {
          if (kind == LIGHT_TRIANGLE)
            *result = sample_triangle_point(of, 0, own, r, u, v, no_light_sampling(), FEATURE_UV);
          else if (kind == LIGHT_SPHERE)
            *result = sample_sphere_point(of, 0, own, axes, r, u, v, FEATURE_UV);
          else if (kind == LIGHT_DISK)
            *result = sample_disk_point(of, 0, own, axes, r, u, v, FEATURE_UV);
          else if (kind == LIGHT_CYLINDER)
            *result = sample_cylinder_point(of, 0, own, axes, r, u, v, FEATURE_UV);
          return kind == LIGHT_TRIANGLE || kind == LIGHT_SPHERE || kind == LIGHT_DISK ||
                 kind == LIGHT_CYLINDER;
        };
        if (!sample(&scene, light, light_axes_at(&scene, 0, time, FEATURE_MOTION), &point)) continue;
        sample(&still, standing.lights[0], still_axes(&still, 0, kind), &expected);
        // The frame about a pole is interpolated too, which is not that about the interpolated pole: they
        // agree at the states.
        const bool framed = kind != LIGHT_TRIANGLE && time != 0.0f && time != 0.5f && time != 1.0f;
        if (framed) continue;
        const double turn = std::abs(double(point.at.u - expected.at.u));
        const double other = std::abs(double(point.at.v - expected.at.v));
        ASSERT_LT(std::min(turn, 1 - turn), 1e-4) << mover.name << " at " << time;
        ASSERT_LT(std::min(other, 1 - other), 1e-4) << mover.name << " at " << time;
      }
  }
}

TEST(MovingLights, ClosedFormsAreThoseOfTheStillOne) {
  // polygon_terms has tests of its own. Here its light is at another place for each lane's time.
  constexpr double kTolerance = 2e-6;  // places are rounded to float
  Mover mover{"Polygon", kTriangle, [](const Pose& p) { return triangle_at_pose(p, EMITTER_AREA); }};
  SceneTables moving = mover.moving();
  moving.header.features |= FEATURE_LTC | FEATURE_POLYGONS;
  moving.ltc_cells.emplace_back();
  RandomNumbers random(8);
  int lit = 0;
  for (int i = 0; i < 200; ++i) {
    Polygon polygon{};
    polygon.two_sided = i % 2;
    moving.lights[0].polygon = 0;
    moving.lights[0].two_sided = polygon.two_sided;
    polygon.light_count = 1;
    moving.polygons = {polygon};
    const Scene scene = moving.scene();
    ShadingPoints points{};
    std::vector<ExactReceiver> receivers;
    for (int j = 0; j < LANES; ++j) {
      ExactReceiver r{exact(kHere) + random.point(.3), random.direction(), {}, -1};
      r.w = random.direction();
      if (random.below(3) != 0) r.exponent = random.between(0, 30);
      if (r.exponent < 0 && random.below(2) != 0)
        r.inverse_x = random.between(1, 3), r.inverse_y = random.between(1, 3), r.shift = 0.2;
      receivers.push_back(r);
      points.time[j] = random.unit_float();
      Receivers& lanes = points.receivers;
      lanes.px[j] = double(r.x.x), lanes.py[j] = double(r.x.y), lanes.pz[j] = double(r.x.z);
      lanes.nx[j] = double(r.n.x), lanes.ny[j] = double(r.n.y), lanes.nz[j] = double(r.n.z);
      lanes.wx[j] = double(r.w.x), lanes.wy[j] = double(r.w.y), lanes.wz[j] = double(r.w.z);
      lanes.exponent[j] = r.exponent;
      const Exact3 t = normalize(r.w - dot(r.w, r.n) * r.n);
      lanes.tx[j] = double(t.x), lanes.ty[j] = double(t.y), lanes.tz[j] = double(t.z);
      lanes.inverse_x[j] = r.inverse_x, lanes.inverse_y[j] = r.inverse_y, lanes.shift[j] = r.shift;
    }
    double irradiance[LANES], lobe[LANES];
    polygon_terms_in_time(&scene, &points, 0, irradiance, lobe);
    for (int j = 0; j < LANES; ++j) {
      const Light still = mover.still(double(points.time[j])).lights[0];
      const PolygonLight there{{{still.p0, still.p1, still.p2}}, polygon.two_sided != 0};
      const PolygonTerms terms = polygon_terms_of(there, receivers[std::size_t(j)]);
      ASSERT_NEAR(irradiance[j], terms.irradiance, kTolerance) << receivers[std::size_t(j)];
      // A Phong lobe's slope grows with its exponent.
      ASSERT_NEAR(lobe[j], terms.lobe, 10 * kTolerance) << receivers[std::size_t(j)];
      lit += terms.irradiance > 1e-3 && terms.lobe > 1e-3;
    }
  }
  EXPECT_GT(lit, 100);
}

}  // namespace
}  // namespace penumbra::moving_light_test
