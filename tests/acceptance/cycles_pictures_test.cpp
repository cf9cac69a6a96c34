// glTF scenes of ours, exported by Blender, against Cycles' pictures of them.
#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "scenes/settings.h"
#include "tests/acceptance/mitsuba_reference.h"
#include "tests/acceptance/picture_oracle.h"
#include "tests/support/oracles.h"

namespace penumbra::cycles_pictures_test {
namespace {

constexpr std::uint32_t kCyclesSamples = 256, kSamples = 1024;

/// What glTF, or Blender's exporter, does not carry, or carries as something else.
constexpr const char* kBeforeFiltering =
    "Cycles interpolates sRGB values; glTF 2.0, 3.9.2: they 'MUST be decoded to real linear values before "
    "they are used for any computations'";
constexpr const char* kLeaningNormals =
    "1.1 % brighter where normals lean, by an unknown part of Cycles; appendix B has the BSDF of the bent "
    "normal";
constexpr PictureException kExceptions[] = {
    {"alphatex", kBeforeFiltering},
    {"texmap", kBeforeFiltering},
    {"area", "KHR_lights_punctual has no lights with an area, and Blender's lamp is left out"},
    {"glass",
     "without KHR_materials_volume a transmitting surface is infinitely thin; Blender's sphere is solid"},
    {"ior", "the refractive index is not in the file: Blender writes KHR_materials_ior for glass alone"},
    {"nmap", kLeaningNormals},
    {"nmapmirror", kLeaningNormals},
    {"nmapuvm_tan", kLeaningNormals},
    {"nmapstr",
     "Blender's strength interpolates normals; glTF 2.0, 3.9.3: scaledNormal = normalize((value * 2.0 - 1.0) "
     "* vec3(scale, scale, 1.0))"},
    {"spot",
     "the falloff between the cones is the squared linear one that KHR_lights_punctual recommends, not "
     "Blender's"},
    {"world", "glTF 2.0 has no environment, and Blender's world is left out"},
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
}  // namespace penumbra::cycles_pictures_test
