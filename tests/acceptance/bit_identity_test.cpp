// One scene, one image: the same bytes from every instruction set, from a block of one path, and from OpenCL,
// with the portable intersector; with Embree the same image, and nearly all of it the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

struct SceneCase {
  std::string name;
  std::string file;  ///< below scenes/, or below the oracles
  bool is_oracle = false;
  bool is_diffuse = true;
  void (*change)(SceneDescription&) = nullptr;
};

void PrintTo(const SceneCase& scene_case, std::ostream* out) { *out << scene_case.name; }

void by_projection(SceneDescription& scene) {
  scene.integrator.emitter_sampling = EmitterSampling::kProjected;
}

void by_solid_angle(SceneDescription& scene) {
  scene.integrator.emitter_sampling = EmitterSampling::kSolidAngle;
}

void closed_form(SceneDescription& scene) { scene.integrator.kind = IntegratorKind::kPolygonAnalytic; }

void control_variate(SceneDescription& scene) {
  scene.integrator.kind = IntegratorKind::kPolygonCv;
  scene.integrator.emitter_sampling = EmitterSampling::kArea;
  scene.integrator.vis_samples = 3;
}

void ratio(SceneDescription& scene) {
  control_variate(scene);
  scene.integrator.estimator = CvEstimator::kRatio;
}

void path_with_control_variate(SceneDescription& scene) {
  scene.integrator.kind = IntegratorKind::kPath;
  scene.integrator.next_event = NextEvent::kCv;
  scene.integrator.max_depth = 5;
}

/// Lobes of low and high, whole and broken exponents.
void make_glossy(SceneDescription& scene) {
  const float exponents[] = {0, 1, 8.5f, 30, 777.25f, 1e4f};
  for (std::size_t i = 0; i < scene.bsdfs.size(); ++i)
    scene.bsdfs[i].model = PhongBsdf{glm::vec3(0.3f), glm::vec3(0.2f, 0.4f, 0.5f), exponents[i % 6]};
}

void glossy_closed_form(SceneDescription& scene) {
  make_glossy(scene);
  closed_form(scene);
}

void glossy_path_with_control_variate(SceneDescription& scene) {
  make_glossy(scene);
  path_with_control_variate(scene);
  scene.integrator.alpha = 0.75f;
  scene.integrator.emitter_sampling = EmitterSampling::kSolidAngle;
}

void glossy_choice(SceneDescription& scene) {
  make_glossy(scene);
  scene.integrator.kind = IntegratorKind::kDirect;
  scene.integrator.bsdf_samples = 0;
  scene.integrator.light_choice = LightChoice::kAnalytic;
}

const std::vector<SceneCase> kScenes{
    {"Cornell", "cornell/cornell.xml"},
    {"CornellSmall", "cornell-small/cornell-small.xml"},
    {"VeachMis", "veach-mis/veach-mis.xml", false, false},
    {"Furnace", "furnace/furnace.xml"},
    {"UnitSphere", "furnace/unit-sphere.xml"},
    {"PolygonLights", "polygon-lights/polygon-lights.xml"},
    {"CornellProjected", "cornell/cornell.xml", false, true, by_projection},
    {"PolygonLightsProjected", "polygon-lights/polygon-lights.xml", false, true, by_projection},
    {"CornellSolidAngle", "cornell/cornell.xml", false, true, by_solid_angle},
    {"CornellAnalytic", "cornell/cornell.xml", false, true, closed_form},
    {"CornellControlVariate", "cornell/cornell.xml", false, true, control_variate},
    {"CornellRatio", "cornell/cornell.xml", false, true, ratio},
    {"CornellPathControlVariate", "cornell/cornell.xml", false, true, path_with_control_variate},
    {"CornellGlossyAnalytic", "cornell/cornell.xml", false, false, glossy_closed_form},
    {"CornellGlossyPathControlVariate", "cornell/cornell.xml", false, false,
     glossy_path_with_control_variate},
    {"CornellGlossyChoice", "cornell/cornell.xml", false, false, glossy_choice},
    {"BitterliCornellBox", "bitterli/cornell-box/scene.xml", true},
    {"MitsubaCbox", "mitsuba/scenes/cbox/cbox-rgb.xml", true},
};

SceneDescription small_scene(const SceneCase& scene_case) {
  const auto file =
      scene_case.is_oracle ? *oracle_folder("") / scene_case.file : project_file("scenes/" + scene_case.file);
  SceneDescription scene = read_or_throw(file);
  resize_film(scene, 40, 30);  // no multiple of a block, a vector or a tile
  scene.sampler.spp = 6;
  if (scene_case.change) scene_case.change(scene);
  return scene;
}

class BitIdentity : public testing::TestWithParam<SceneCase> {
 protected:
  void SetUp() override {
    if (GetParam().is_oracle && !oracle_folder(GetParam().file)) {
      GTEST_SKIP() << "the third-party scene " << GetParam().file << " is not here";
    }
  }
};

std::vector<Isa> machine_isas() {
  std::vector<Isa> isas{Isa::kSse2, Isa::kAvx2, Isa::kAvx512};
  std::erase_if(isas, [](Isa isa) { return isa > best_isa(); });
  return isas;
}

/// The first pixel in which two films differ, for the message.
std::string first_difference(const FilmAccumulator& a, const FilmAccumulator& b) {
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      const PixelStatistics &p = a.at(x, y), &q = b.at(x, y);
      for (int c = 0; c < 3; ++c) {
        if (p.mean[c] != q.mean[c] || p.m2[c] != q.m2[c]) {
          return testing::PrintToString(std::tuple(x, y, c, p.mean[c], q.mean[c]));
        }
      }
    }
  }
  return "only in features or counts";
}

TEST_P(BitIdentity, EveryBackendGivesTheSameBytes) {
  const DeviceScene scene = build_or_throw(small_scene(GetParam()));
  TestDevice device = native_device();
  device.options.threads = 1;
  device.options.isa = Isa::kSse2;
  const FilmAccumulator reference = render_or_throw(scene, device);
  ASSERT_GT(reference.at(20, 15).count, 0u);
  const auto expect_same = [&](const TestDevice& other, const std::string& name) {
    const FilmAccumulator film = render_or_throw(scene, other);
    EXPECT_EQ(film.hash(), reference.hash()) << name << " differs: " << first_difference(reference, film);
  };
  for (Isa isa : machine_isas()) {
    device.options.isa = isa;
    for (int threads : {1, 2}) {
      device.options.threads = threads;
      expect_same(device, std::string(isa_name(isa)) + " with " + std::to_string(threads) + " threads");
    }
  }
  device.options.block_of_one = true;
  expect_same(device, "a block of one path");
  expect_same(opencl_device(), "OpenCL");
}

TEST_P(BitIdentity, EmbreeGivesTheSameImage) {
  const SceneDescription description = small_scene(GetParam());
  const FilmAccumulator portable = render_or_throw(build_or_throw(description));
  const DeviceScene embree_scene = build_or_throw(description, true);
  ASSERT_EQ(embree_scene.header.intersector, INTERSECTOR_EMBREE);
  const FilmAccumulator embree = render_or_throw(embree_scene);
  int equal = 0;
  for (int y = 0; y < portable.height(); ++y) {
    for (int x = 0; x < portable.width(); ++x) {
      equal += std::ranges::equal(portable.at(x, y).mean, embree.at(x, y).mean);
    }
  }
  const double share = double(equal) / (portable.width() * portable.height());
  RecordProperty("bit_equal_share", std::to_string(share));
  EXPECT_GE(share, GetParam().is_diffuse ? 0.999 : 0.99);
}

TEST_P(BitIdentity, EmbreeAgreesFromOtherSeeds) {
  SceneDescription description = small_scene(GetParam());
  description.sampler.spp = 64;
  TestDevice embree = native_device();
  embree.embree = true;
  constexpr int kBatches = 6, kBlock = 10;
  const statistics::Estimate by_us = block_estimate(description, kBatches, 1, kBlock);
  const statistics::Estimate by_embree = block_estimate(description, kBatches, 1000, kBlock, embree);
  // Twelve blocks, whose channels go together: none outside, and the mean of z^2 of twelve independent
  // values. What rounds to the same everywhere has an error of the rounding alone.
  statistics::ImageTestLimits limits{.accepted_fraction = 1, .mean_square = 1 + 4 * std::sqrt(2.0 / 12)};
  statistics::Estimate ours = by_us;
  for (std::size_t i = 0; i < ours.mean.values.size(); ++i) {
    ours.standard_error.values[i] =
        std::hypot(ours.standard_error.values[i], ours.mean.values[i] * 32.0 / (1 << 24));
  }
  const auto result = statistics::z_test(ours, by_embree, limits);
  EXPECT_TRUE(result.passed) << result.summary();
}

INSTANTIATE_TEST_SUITE_P(Scenes, BitIdentity, testing::ValuesIn(kScenes),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace penumbra
