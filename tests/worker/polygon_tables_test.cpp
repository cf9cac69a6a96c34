// Polygon light tables that arrive over the network. An index of an entry that does not exist is refused,
// field by field. Scenes with non-finite values are traced all the same, and the non-finite samples are
// counted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <climits>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "kernels/host/device_scene.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"
#include "tests/worker/device_scenes.h"

namespace penumbra::polygon_tables_test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

SceneDescription with_fitted_alpha(SceneDescription scene) {
  param::alpha(scene.integrator).reset();
  return scene;
}

class PolygonTables : public testing::Test {
 protected:
  const DeviceScene scene_ = build_or_throw(with_fitted_alpha(polygon_lights()));
  const SceneHeader& h_ = scene_.header;

  /// Here and after a journey.
  static void expect_refused(const DeviceScene& scene, const std::string& because) {
    const auto checked = check_device_scene(scene);
    ASSERT_FALSE(checked) << "not refused: " << because;
    EXPECT_NE(checked.error().message.find("device scene: "), std::string::npos);
    EXPECT_NE(checked.error().message.find(because), std::string::npos) << checked.error().message;
    EXPECT_FALSE(DeviceScene::deserialize(scene.serialize()));
  }
  void refuse_header(const std::function<void(SceneHeader&)>& change, const std::string& because) const {
    DeviceScene changed = scene_;
    change(changed.header);
    expect_refused(changed, because);
  }
  void refuse_polygon(int index, int Polygon::*field, int value, const std::string& because) const {
    expect_refused(with_record<Polygon>(scene_, h_.tables.polygons, std::size_t(index),
                                        [&](Polygon& p) { p.*field = value; }),
                   because);
  }
  [[nodiscard]] std::span<const Polygon> polygons() const {
    return table<Polygon>(scene_, h_.tables.polygons);
  }
  [[nodiscard]] std::span<const PolygonCorner> corners() const {
    return table<PolygonCorner>(scene_, h_.tables.polygon_corners);
  }

  /// Whatever is accepted can be rendered: to finite radiance, with samples that are none counted.
  static SampleBuffer render(const DeviceScene& scene) {
    const auto checked = check_device_scene(scene);
    EXPECT_TRUE(checked) << checked.error().message;
    DeviceOptions options;
    options.isa = best_isa();
    const auto device = make_device(scene, options);
    if (!device) throw std::runtime_error(device.error().message);
    const auto buffer = (*device)->render({0, 0, scene.header.film.width, scene.header.film.height, 0, 4});
    if (!buffer) throw std::runtime_error(buffer.error().message);
    std::set<int> planes;
    for (int plane = 0; plane < kRadiancePlanes; ++plane)
      for (const float value : buffer->plane(plane))
        if (!std::isfinite(value)) planes.insert(plane);
    EXPECT_THAT(planes, testing::IsEmpty()) << "planes with values that are not finite";
    return *buffer;
  }
};

TEST_F(PolygonTables, AreWhatTheSceneIsMeantToHave) {
  EXPECT_EQ(h_.tables.polygons.count, 3);
  EXPECT_EQ(h_.tables.lights.count, 2 + 4 + 1 + 1);
  EXPECT_EQ(h_.tables.polygon_corners.count, 5 + 7 + 4);
  EXPECT_EQ(h_.integrator.estimator, ESTIMATOR_AUTO);
  EXPECT_EQ(h_.integrator.light_choice, CHOICE_ANALYTIC);
  EXPECT_EQ(polygons()[1].two_sided, 1);
  const SampleBuffer buffer = render(scene_);
  EXPECT_EQ(non_finite_count(buffer.flagged), 0u);
}

TEST_F(PolygonTables, HeaderFields) {
  for (const int value : {-1, ESTIMATOR_AUTO + 1, INT_MAX, INT_MIN})
    refuse_header([=](SceneHeader& h) { h.integrator.estimator = value; }, "unknown estimator");
  for (const int value : {-1, CHOICE_TREE + 1, INT_MAX, INT_MIN})
    refuse_header([=](SceneHeader& h) { h.integrator.light_choice = value; }, "unknown choice of lights");
  refuse_header([](SceneHeader& h) { --h.tables.polygon_corners.count; }, "names corners that are not there");
  refuse_header([](SceneHeader& h) { h.tables.polygon_corners.count = 0; },
                "names corners that are not there");
  refuse_header([](SceneHeader& h) { --h.tables.polygons.count; }, "names a polygon that is not there");
  refuse_header([](SceneHeader& h) { h.tables.polygons.count = 0; }, "names a polygon that is not there");
}

TEST_F(PolygonTables, ClosedFormsNeedTheirFeatureBit) {
  const auto without = [](SceneHeader& h) { h.features &= ~std::uint64_t(FEATURE_POLYGONS); };
  refuse_header(without, "closed forms without their feature bit");
  for (const int estimator : {ESTIMATOR_ALPHA, ESTIMATOR_AUTO})
    refuse_header(
        [&](SceneHeader& h) {
          without(h);
          h.integrator.light_choice = CHOICE_POWER;
          h.integrator.estimator = estimator;
        },
        "closed forms without their feature bit");
  refuse_header(
      [&](SceneHeader& h) {
        without(h);
        h.integrator.estimator = ESTIMATOR_SAMPLES;
      },
      "closed forms without their feature bit");
}

TEST_F(PolygonTables, Ranges) {
  const std::string no_lights = "names lights that are not there",
                    no_corners = "names corners that are not there";
  for (int k = 0; k < h_.tables.polygons.count; ++k) {
    const Polygon& p = polygons()[std::size_t(k)];
    for (const int value : {-1, h_.tables.lights.count, INT_MAX, INT_MIN})
      refuse_polygon(k, &Polygon::first_light, value, no_lights);
    for (const int value : {-1, 0, h_.tables.lights.count - p.first_light + 1, INT_MAX, INT_MIN})
      refuse_polygon(k, &Polygon::light_count, value, no_lights);
    for (const int value : {-1, h_.tables.polygon_corners.count, INT_MAX, INT_MIN})
      refuse_polygon(k, &Polygon::first_corner, value, no_corners);
    for (const int value : {-1, 0, h_.tables.polygon_corners.count - p.first_corner + 1, INT_MAX, INT_MIN})
      refuse_polygon(k, &Polygon::corner_count, value, no_corners);
    refuse_polygon(k, &Polygon::first_corner, p.first_corner + 1,
                   k + 1 < h_.tables.polygons.count ? "a polygon starts within a loop" : no_corners);
    expect_refused(with_record<PolygonCorner>(scene_, h_.tables.polygon_corners, std::size_t(p.first_corner),
                                              [](PolygonCorner& c) { c.starts = 0; }),
                   "a polygon starts within a loop");
  }
}

TEST_F(PolygonTables, LightsNamePolygonsThatAreThere) {
  for (int k = 0; k < h_.tables.lights.count; ++k)
    for (const int value : {-2, h_.tables.polygons.count, INT_MAX, INT_MIN})
      expect_refused(with_record<Light>(scene_, h_.tables.lights, std::size_t(k),
                                        [&](Light& light) { light.polygon = value; }),
                     "a light names a polygon that is not there");
}

// --- what makes no sense but breaks nothing

TEST_F(PolygonTables, CornersThatAreNoNumbersCanBeRendered) {
  for (const float bad : {kNan, kInfinity, -kInfinity, 1e38f})
    for (int k = 0; k < h_.tables.polygon_corners.count; ++k) {
      SCOPED_TRACE(testing::Message() << bad << " in corner " << k);
      render(with_record<PolygonCorner>(scene_, h_.tables.polygon_corners, std::size_t(k),
                                        [&](PolygonCorner& c) { c.p.y = bad; }));
    }
}

TEST_F(PolygonTables, OtherNumbersAreCountedOrRendered) {
  const auto with_polygons = [&](const std::function<void(Polygon&)>& change) {
    DeviceScene changed = scene_;
    for (int k = 0; k < h_.tables.polygons.count; ++k)
      changed = with_record<Polygon>(changed, h_.tables.polygons, std::size_t(k), change);
    return changed;
  };
  const auto uncounted = [](const SampleBuffer& buffer) { return non_finite_count(buffer.flagged) == 0; };
  // Squares of deviations are to be finite too.
  for (const float number : {kNan, kInfinity, -1.0f, 0.0f, 1e15f}) {
    SCOPED_TRACE(number);
    const bool finite = std::isfinite(number);
    const vec3 radiance = make_vec3(number, number, number);
    EXPECT_EQ(uncounted(render(with_polygons([&](Polygon& p) { p.radiance = radiance; }))), finite);
    EXPECT_TRUE(uncounted(render(with_polygons([&](Polygon& p) { p.area = p.size = number; }))));
    DeviceScene changed = scene_;
    changed.header.adjustable.alpha = number;
    EXPECT_TRUE(uncounted(render(changed))) << "it is fitted";
    changed.header.integrator.estimator = ESTIMATOR_ALPHA;
    EXPECT_EQ(uncounted(render(changed)), finite);
  }
  for (const int flag : {-1, 2, INT_MAX, INT_MIN}) {
    EXPECT_TRUE(uncounted(render(with_polygons([&](Polygon& p) { p.two_sided = flag; }))));
    EXPECT_TRUE(uncounted(render(with_record<PolygonCorner>(scene_, h_.tables.polygon_corners, 2,
                                                            [&](PolygonCorner& c) { c.starts = flag; }))));
  }
}

TEST_F(PolygonTables, OverlappingRangesCanBeRendered) {
  const auto render_polygon = [&](std::size_t index, const std::function<void(Polygon&)>& change) {
    render(with_record<Polygon>(scene_, h_.tables.polygons, index, change));
  };
  for (std::size_t k = 0; k < polygons().size(); ++k) {
    render_polygon(k, [&](Polygon& p) {  // all lights, the sphere too
      p.first_light = 0;
      p.light_count = h_.tables.lights.count;
    });
    render_polygon(k, [&](Polygon& p) {  // all corners
      p.first_corner = 0;
      p.corner_count = h_.tables.polygon_corners.count;
    });
    render_polygon(k, [&](Polygon& p) { p.first_light = h_.tables.lights.count - 1, p.light_count = 1; });
    for (const int count : {1, 2, 3}) render_polygon(k, [&](Polygon& p) { p.corner_count = count; });
  }
  // Parts that belong to another polygon, or to none.
  for (std::size_t k = 0; k < std::size_t(h_.tables.lights.count); ++k)
    for (int polygon = -1; polygon < h_.tables.polygons.count; ++polygon)
      render(with_record<Light>(scene_, h_.tables.lights, k, [&](Light& light) { light.polygon = polygon; }));
}

TEST_F(PolygonTables, KindsAndSamplingsMayBeMixed) {
  DeviceScene scene = scene_;
  scene.header.light_kinds = ALL_LIGHT_KINDS;
  for (std::size_t k = 0; k < std::size_t(h_.tables.lights.count); ++k) {
    for (const int kind : {-1, 31})
      expect_refused(
          with_record<Light>(scene_, h_.tables.lights, k, [&](Light& light) { light.kind = kind; }),
          "a light of unknown kind");
    expect_refused(
        with_record<Light>(scene_, h_.tables.lights, k, [&](Light& light) { light.kind = LIGHT_DISK; }),
        "a light of a kind that the header does not name");
    for (const int sampling : {-1, EMITTER_PROJECTED + 1})
      expect_refused(
          with_record<Light>(scene_, h_.tables.lights, k, [&](Light& light) { light.sampling = sampling; }),
          "a light of unknown sampling");
    expect_refused(
        with_record<Light>(scene, h_.tables.lights, k, [&](Light& light) { light.kind = LIGHT_ENVMAP; }),
        "an environment map is not there");
    for (int kind = 0; kind < 32; ++kind) {
      if (kind == LIGHT_ENVMAP || (ALL_LIGHT_KINDS >> kind & 1u) == 0u) continue;
      if (kind == LIGHT_SPOT || kind == LIGHT_PROJECTOR) {
        expect_refused(
            with_record<Light>(scene, h_.tables.lights, k, [&](Light& light) { light.kind = kind; }),
            "a light's beam is not there");
        continue;
      }
      if (kind == LIGHT_MEDIUM) {
        expect_refused(
            with_record<Light>(scene, h_.tables.lights, k, [&](Light& light) { light.kind = kind; }),
            "the medium of a light is not there");
        continue;
      }
      for (int sampling = EMITTER_AREA; sampling <= EMITTER_PROJECTED; ++sampling)
        render(with_record<Light>(scene, h_.tables.lights, k, [&](Light& light) {
          light.kind = kind;
          light.sampling = sampling;
        }));
    }
  }
}

}  // namespace
}  // namespace penumbra::polygon_tables_test
