// Parts of the light of paths, by bounces and by technique: their images add up to the whole image, and equal
// the differences of images with limited depth, sample by sample.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes/device/device_scene_builder.h"
#include "tests/acceptance/suite_scenes.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::path_parts_test {
namespace {

constexpr int kBounces = 4;
// Sums of at most 2 kBounces + 2 terms of one sign in another order, of which means of six samples and of
// passes are taken: each rounds by 2^-24 of the whole at most.
constexpr double kRounding = (2 * kBounces + 2 + 22) / double(1 << 24);

std::vector<SuiteScene> path_scenes() {
  std::vector<SuiteScene> scenes;
  for (const SuiteScene& scene : suite_scenes()) {
    if (scene.is_oracle) continue;
    const SceneDescription description = small_scene(scene);
    const auto* path = description.integrator.get<PathIntegrator>();
    if (path != nullptr && path->next_event == NextEvent::kSample && !keeps_parts(*path))
      scenes.push_back(scene);
  }
  return scenes;
}

class PathParts : public testing::TestWithParam<SuiteScene> {
 protected:
  void SetUp() override {
    scene_ = small_scene(GetParam());
    param::max_depth(scene_.integrator) = kBounces + 1;
    param::rr_depth(scene_.integrator) = 2;
    scene_.film.closed_light_edges = false;  // parts have none
  }
  statistics::Image part(int bounces, PathTechnique technique = PathTechnique::kAll) {
    SceneDescription scene = scene_;
    auto* path = std::get_if<PathIntegrator>(&scene.integrator.method);
    path->only_bounces = bounces;
    path->only_technique = technique;
    return mean_image(render_or_throw(scene));
  }
  statistics::Image up_to(int edges) {
    SceneDescription scene = scene_;
    param::max_depth(scene.integrator) = edges;
    return mean_image(render_or_throw(scene));
  }
  SceneDescription scene_;
};

/// sum = +parts[0] + parts[1] ..., each pixel within the rounding of `whole`.
void expect_sum(const statistics::Image& whole, const std::vector<statistics::Image>& parts,
                const statistics::Image& scale, const char* what) {
  double worst = 0, total = 0;
  for (std::size_t i = 0; i < whole.values.size(); ++i) {
    double sum = 0;
    for (const statistics::Image& part : parts) sum += part.values[i];
    worst = std::max(worst, std::abs(sum - whole.values[i]) / std::max(double(scale.values[i]), 1e-30));
    total += sum;
  }
  EXPECT_LE(worst, kRounding) << what;
  EXPECT_GT(total, 0) << what << ": nothing was compared";
}

TEST_P(PathParts, AddUpToTheWhole) {
  const statistics::Image whole = up_to(kBounces + 1);
  std::vector<statistics::Image> by_bounces;
  for (int bounces = 0; bounces <= kBounces; ++bounces) by_bounces.push_back(part(bounces));
  expect_sum(whole, by_bounces, whole, "bounces");
  expect_sum(whole, {part(-1, PathTechnique::kBsdf), part(-1, PathTechnique::kEmitter)}, whole, "techniques");
  expect_sum(by_bounces[1], {part(1, PathTechnique::kBsdf), part(1, PathTechnique::kEmitter)}, whole,
             "techniques of one bounce");
}

TEST_P(PathParts, AreWhatLimitsOfTheDepthDifferBy) {
  const statistics::Image all = up_to(3);
  expect_sum(all, {up_to(2), part(2)}, all, "two bounces are three edges");
}

INSTANTIATE_TEST_SUITE_P(Scenes, PathParts, testing::ValuesIn(path_scenes()),
                         [](const auto& tested) { return tested.param.name; });

TEST(PathPartsOfAScene, CostNothingWhereNotAskedFor) {
  SceneDescription scene = small_scene(suite_scenes().front());
  EXPECT_EQ(build_or_throw(scene).header.features & FEATURE_PARTS, 0u);
  std::get<PathIntegrator>(scene.integrator.method).only_bounces = 0;
  EXPECT_EQ(build_or_throw(scene).header.features & FEATURE_PARTS, FEATURE_PARTS);
}

}  // namespace
}  // namespace penumbra::path_parts_test
