// glTF scenes of ours, exported by Blender, against Cycles' pictures of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>

#include "scenes/settings.h"
#include "scheduler/record/film_image.h"
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
    "Cycles darkens the diffuse lobes of leaning normals by a shadowing term, see below; glTF 2.0, appendix "
    "B, has none";
constexpr const char* kLeaning[] = {"nmap", "nmapmirror", "nmapuvm_tan"};
constexpr PictureException kExceptions[] = {
    {"alphatex", kBeforeFiltering},
    {"texmap", kBeforeFiltering},
    {"texmirror",
     "what rough microfacets reflect among each other is diffuse (Kulla and Conty 2017), in Cycles as narrow "
     "as the "
     "rest (Turquin 2019): it shows where a texture is nearly black"},
    {"area", "KHR_lights_punctual has no lights with an area, and Blender's lamp is left out"},
    {"glass",
     "without KHR_materials_volume a transmitting surface is infinitely thin; Blender's sphere is solid"},
    {"ior", "the refractive index is not in the file: Blender writes KHR_materials_ior for glass alone"},
    {kLeaning[0], kLeaningNormals},
    {kLeaning[1], kLeaningNormals},
    {kLeaning[2], kLeaningNormals},
    {"nmapstr",
     "Blender's strength interpolates normals; glTF 2.0, 3.9.3: scaledNormal = normalize((value * 2.0 - 1.0) "
     "* vec3(scale, scale, 1.0))"},
    {"spot",
     "the falloff between the cones is the squared linear one that KHR_lights_punctual recommends, not "
     "Blender's"},
    {"world", "glTF 2.0 has no environment, and Blender's world is left out"},
};

/// The scene of that name as Cycles rendered it: glTF has no resolution and no filter.
SceneDescription scene_like(const std::filesystem::path& folder, const std::string& name,
                            const statistics::Image& theirs) {
  SceneDescription scene = read_or_throw(folder / (name + ".glb"));
  resize_film(scene, theirs.width, theirs.height);
  EXPECT_TRUE(apply_setting(scene, "film.rfilter", "box"));
  return scene;
}

class CyclesPictures : public testing::TestWithParam<std::string> {};

TEST_P(CyclesPictures, Agree) {
  PENUMBRA_NEED_ORACLE("cycles");
  const auto folder = *find_oracle("cycles");
  const auto reference = folder / (GetParam() + "_ref.exr");
  const SceneDescription scene = scene_like(folder, GetParam(), read_rgb(reference));
  expect_agreement(compare_with_picture(scene, reference, kCyclesSamples, kSamples), GetParam(), kExceptions);
}

/// The pictures, or one test that says that there are none.
std::vector<std::string> names() {
  auto found = picture_names("cycles", "glb");
  if (found.empty()) found.emplace_back("none");
  return found;
}

/// What a leaning normal sees of a light: Conty Estevez, Lecocq and Stein 2019, "A Microfacet-Based Shadowing
/// Function to Solve the Bump Terminator Problem". Both cosines are to the surface's own normal.
double bump_shadowing(double cosine_of_normal, double cosine_of_light) {
  const auto tangent2 = [](double cosine) { return 1 / (cosine * cosine) - 1; };
  const double alpha2 = std::min(tangent2(cosine_of_normal) / 8, 1.0);
  return 2 / (1 + std::sqrt(1 + alpha2 * tangent2(cosine_of_light)));
}

/// On a floor whose normals lean by up to 49 degrees, lit by a sun. The term does not darken microfacets,
/// which have a few per cent of the light. From 45 degrees on the viewer's mirror direction is below the
/// floor, and Cycles turns their normals.
TEST(CyclesPicturesOfLeaningNormals, AreDarkerByTheShadowingTerm) {
  PENUMBRA_NEED_ORACLE("cycles");
  constexpr double kError = 2e-3;          // the microfacets' part of the term's 1 %, and noise
  const double sun = 3 / std::sqrt(14.0);  // from (1, 3, 2)
  const auto folder = *find_oracle("cycles");
  for (const char* name : kLeaning) {
    const statistics::Image theirs = read_rgb(folder / (std::string(name) + "_ref.exr"));
    SceneDescription scene = scene_like(folder, name, theirs);
    scene.sampler.spp = kSamples;
    scene.film.denoise = Denoise::kLayers;
    const Image ours = image_of_film(render_or_throw(scene), theirs.width, theirs.height);
    double sum = 0, shadowed = 0, reference = 0;
    for (int y = 0; y < theirs.height; ++y)
      for (int x = 0; x < theirs.width; ++x) {
        const auto at = [&](const char* channel) { return double(ours.at(x, y, *ours.channel(channel))); };
        const double length = std::hypot(at("normal.X"), at("normal.Y"), at("normal.Z"));
        const double red = at("R");
        sum += red;
        shadowed += length > 0 ? red * bump_shadowing(at("normal.Y") / length, sun) : red;
        reference += theirs.at(x, y, 0);
      }
    EXPECT_GT(sum / reference, 1 + 3 * kError) << name;
    EXPECT_NEAR(shadowed / reference, 1, kError) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, CyclesPictures, testing::ValuesIn(names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace penumbra::cycles_pictures_test
