// Mitsuba 3's own test scenes, unedited, against its reference images, compared as in its test suite: some
// two million samples per image, a z-test for each pixel in XYZ with the reference's variance, a significance
// of 1% for the image (Sidak), and 99.75% of the values must pass.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "scheduler/image/image.h"
#include "tests/support/oracles.h"
#include "tests/support/render_scene.h"
#include "tests/support/statistics.h"

namespace penumbra {
namespace {

constexpr int kSamples = 2'000'000;      // of an image
constexpr double kLeastVariance = 1e-4;  // of one sample
constexpr double kAcceptedShare = 0.9975;
constexpr double kSignificance = 0.01;

using Triple = std::array<double, 3>;

/// Rec. 709 to XYZ.
Triple to_xyz(const Triple& rgb) {
  constexpr double kMatrix[3][3] = {
      {0.412453, 0.357580, 0.180423}, {0.212671, 0.715160, 0.072169}, {0.019334, 0.119193, 0.950227}};
  Triple xyz{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) xyz[i] += kMatrix[i][j] * rgb[j];
  return xyz;
}

/// An image's colours in XYZ. Of a variance too: the references' variances are of XYZ, written as if they
/// were a colour.
class XyzImage {
 public:
  explicit XyzImage(const std::filesystem::path& path) : file_(read_image(path)) {
    if (!file_) throw std::runtime_error(file_.error().message);
    const auto channels = file_->beauty_channels();
    if (!channels) throw std::runtime_error(path.string() + " has no colour channels");
    channels_ = *channels;
  }
  [[nodiscard]] Triple at(int x, int y) const {
    return to_xyz(
        {file_->at(x, y, channels_[0]), file_->at(x, y, channels_[1]), file_->at(x, y, channels_[2])});
  }
  [[nodiscard]] int width() const { return file_->data.width; }
  [[nodiscard]] int height() const { return file_->data.height; }

 private:
  decltype(read_image(std::filesystem::path())) file_;
  std::remove_cvref_t<decltype(*file_->beauty_channels())> channels_;
};

struct ReferenceCase {
  std::string name;
  std::string folder, scene, reference;
  TestDevice (*device)();
  std::vector<std::pair<std::string, std::string>> defines = {};  ///< as for -D
};
void PrintTo(const ReferenceCase& tested, std::ostream* out) { *out << tested.name; }

class MitsubaReference : public testing::TestWithParam<ReferenceCase> {};

TEST_P(MitsubaReference, PixelsAgree) {
  const ReferenceCase& tested = GetParam();
  const std::string folder = "mitsuba/tests/scenes/" + tested.folder;
  PENUMBRA_NEED_ORACLE(folder);
  const auto root = *find_oracle(folder);
  SceneDescription scene = read_or_throw(root / (tested.scene + ".xml"), tested.defines);
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
  const XyzImage reference(root / "refs" / (tested.reference + "_ref_rgb.exr"));
  const XyzImage variance(root / "refs" / (tested.reference + "_ref_rgb_var.exr"));
  const int pixels = scene.film.width * scene.film.height;
  ASSERT_EQ(reference.width(), scene.film.width);
  ASSERT_EQ(reference.height(), scene.film.height);
  const auto samples = std::uint32_t(kSamples / pixels);
  scene.sampler.spp = samples;
  const statistics::Image ours = mean_image(render_or_throw(scene, tested.device()));
  const double limit = statistics::sidak_limit(kSignificance, std::size_t(pixels));
  int accepted = 0;
  double worst = 0;
  std::string where;
  for (int y = 0; y < scene.film.height; ++y)
    for (int x = 0; x < scene.film.width; ++x) {
      const Triple a = to_xyz({ours.at(x, y, 0), ours.at(x, y, 1), ours.at(x, y, 2)});
      const Triple b = reference.at(x, y), v = variance.at(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        const double z = std::abs(a[c] - b[c]) * std::sqrt(samples / std::max(v[c], kLeastVariance));
        accepted += z <= limit ? 1 : 0;
        if (!(z <= worst)) {
          worst = z;
          where = "(" + std::to_string(x) + ", " + std::to_string(y) + ")";
        }
      }
    }
  const double share = accepted / (3.0 * pixels);
  EXPECT_GE(share, kAcceptedShare) << "farthest off by " << worst << " standard errors at " << where;
  RecordProperty("accepted", std::to_string(share));
}

const ReferenceCase kReferences[] = {
    {"ArealightNative", "bsdf_spheres", "test_arealight_path", "test_arealight", native_device},
    {"EnvmapNative", "bsdf_spheres", "test_envmap_path", "test_envmap", native_device},
    {"EnvmapOpenCl", "bsdf_spheres", "test_envmap_path", "test_envmap", opencl_device},
    {"PointlightNative", "bsdf_spheres", "test_pointlight_path", "test_pointlight", native_device},
    {"InstancingNative", "instancing", "test_instancing_path", "test_instancing", native_device},
    {"InstancingOpenCl", "instancing", "test_instancing_path", "test_instancing", opencl_device},
    {"NormalmapNative", "bsdf_spheres", "test_normalmap_path", "test_normalmap", native_device},
    {"RoughdielectricNative", "bsdf_spheres", "test_roughdielectric_path", "test_roughdielectric",
     native_device},
    {"RoughplasticNative", "bsdf_spheres", "test_roughplastic_linear_path", "test_roughplastic_linear",
     native_device},
    {"TexturedDiffuseNative", "bsdf_spheres", "test_textured_diffuse_path", "test_textured_diffuse",
     native_device},
    {"TexturedRoughconductorNative", "bsdf_spheres", "test_textured_roughconductor_path",
     "test_textured_roughconductor", native_device},
    {"TexturedPrincipledNative", "bsdf_spheres", "test_texturedprincipled1_path", "test_texturedprincipled1",
     native_device},
    {"TexturedPrincipledOpenCl", "bsdf_spheres", "test_texturedprincipled1_path", "test_texturedprincipled1",
     opencl_device},
    {"MediumEnvmapNative", "participating_media", "test_homo_null_envmap_volpath", "test_homo_null_envmap",
     native_device},
    {"MediumEnvmapOpenCl", "participating_media", "test_homo_null_envmap_volpath", "test_homo_null_envmap",
     opencl_device},
    {"MediumBehindPanesNative", "participating_media", "test_homo_area_light_volpath", "test_homo_area_light",
     native_device},
    {"MediumAndSurfacesNative", "participating_media", "test_surf_area_light_volpath", "test_surf_area_light",
     native_device},
    // Its reference is that of a path tracer too, as its file says.
    {"VariousEmittersNative",
     "various_emitters",
     "test_various_emitters_ptracer",
     "test_various_emitters",
     native_device,
     {{"integrator", "path"}}},
    {"VariousEmittersOpenCl",
     "various_emitters",
     "test_various_emitters_ptracer",
     "test_various_emitters",
     opencl_device,
     {{"integrator", "path"}}}};

INSTANTIATE_TEST_SUITE_P(Scenes, MitsubaReference, testing::ValuesIn(kReferences),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace penumbra
