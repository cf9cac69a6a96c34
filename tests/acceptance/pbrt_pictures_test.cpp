// Our own scenes, about one feature of the format each, against pictures that pbrt-v4 made of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scenes/scene_reader.h"
#include "tests/acceptance/picture_oracle.h"
#include "tests/support/oracles.h"

namespace penumbra::pbrt_pictures_test {
namespace {

constexpr const char* kFolder = "pbrt";
constexpr std::uint32_t kReferenceSamples = 1024, kSamples = 256;

constexpr PictureException kExceptions[] = {
    {"m_cdiff",
     "light that goes to and fro is no linear function of the reflectance, so that spectra are darker in red "
     "by a tenth, as between Mitsuba 3's spectral and RGB variants of its plastic"},
    {"med_cam", "pbrt's picture has fireflies, beside a point light in a medium"},
};

/// Scenes of which the level alone is compared, because pbrt renders spectra, which differ from our colours
/// where colours are strong.
constexpr PictureException kColourExceptions[] = {
    {"cam_sw", "parts of the texture have next to no blue"},
    {"m_cdiff_r", "light goes to and fro between coloured layers"},
    {"m_cond_au", "a metal's indices are spectra"},
    {"m_cond_def", "a metal's indices are spectra"},
    {"m_cond_noremap", "a metal's indices are spectra"},
    {"m_diel_bk7", "the glass disperses"},
    {"m_diff", "a red surface in coloured light"},
    {"m_dtrans", "a coloured sheet in coloured light"},
    {"m_spec_refl", "a reflectance given as a spectrum, in coloured light"},
};

class PbrtPictures : public testing::TestWithParam<std::string> {};

TEST_P(PbrtPictures, AreOurs) {
  PENUMBRA_NEED_ORACLE(kFolder);
  const std::filesystem::path folder = *find_oracle(kFolder);
  const auto scene = read_scene(folder / (GetParam() + ".pbrt"), {});
  if (!scene) {
    EXPECT_NE(std::ranges::find(kExceptions, GetParam(), &PictureException::name), std::end(kExceptions))
        << scene.error().message;
    EXPECT_NE(scene.error().message.find("not read"), std::string::npos) << scene.error().message;
    return;
  }
  const PictureAgreement agreement =
      compare_with_picture(*scene, folder / (GetParam() + "_ref.exr"), kReferenceSamples, kSamples);
  if (std::ranges::find(kColourExceptions, GetParam(), &PictureException::name) !=
      std::end(kColourExceptions))
    EXPECT_LE(std::abs(agreement.mean - 1.0), agreement.mean_tolerance) << agreement.summary();
  else
    expect_agreement(agreement, GetParam(), kExceptions);
}

INSTANTIATE_TEST_SUITE_P(All, PbrtPictures, testing::ValuesIn(picture_names(kFolder, "pbrt")),
                         [](const auto& name) { return name.param; });
// Where the references are not there, the list of names is empty.
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PbrtPictures);

/// A clear line where the references are not there.
TEST(PbrtPicturesFolder, IsThere) { PENUMBRA_NEED_ORACLE(kFolder); }

}  // namespace
}  // namespace penumbra::pbrt_pictures_test
