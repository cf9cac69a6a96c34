// glTF scenes of ours, exported by Blender, against Cycles' pictures of them.
#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "scenes/settings.h"
#include "tests/acceptance/mitsuba_reference.h"
#include "tests/acceptance/picture_oracle.h"
#include "tests/support/oracles.h"

namespace penumbra {
namespace {

constexpr std::uint32_t kCyclesSamples = 256, kSamples = 256;

/// What glTF cannot carry.
constexpr PictureException kExceptions[] = {
    {"area",
     "Blender exports no area lamps: KHR_lights_punctual defines lights that are 'infinitely small points'"},
    {"world", "Blender exports no world: glTF 2.0 has no environment"},
};

class CyclesPictures : public testing::TestWithParam<std::string> {};

TEST_P(CyclesPictures, Agree) {
  PENUMBRA_NEED_ORACLE("cycles");
  const auto folder = *find_oracle("cycles");
  SceneDescription scene = read_or_throw(folder / (GetParam() + ".glb"));
  const auto reference = folder / (GetParam() + "_ref.exr");
  // glTF has no resolution and no filter.
  const statistics::Image theirs = read_rgb(reference);
  resize_film(scene, theirs.width, theirs.height);
  ASSERT_TRUE(apply_setting(scene, "film.rfilter", "box"));
  expect_agreement(compare_with_picture(scene, reference, kCyclesSamples, kSamples), GetParam(), kExceptions);
}

/// The pictures, or one test that says that there are none.
std::vector<std::string> names() {
  auto found = picture_names("cycles", "glb");
  if (found.empty()) found.emplace_back("none");
  return found;
}

INSTANTIATE_TEST_SUITE_P(Scenes, CyclesPictures, testing::ValuesIn(names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace penumbra
