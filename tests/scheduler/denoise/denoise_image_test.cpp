#include "scheduler/denoise/denoise_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "scheduler/image/image_files.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Every channel has noise of standard deviation 0.1 around 0.5; variances are 0.01.
Image image_of(int width, int height, std::vector<std::string> channels, float scale = 1) {
  Image image;
  image.data = image.display = {0, 0, width, height};
  image.channels = std::move(channels);
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0.5f, 0.1f);
  for (std::size_t i = 0; i < image.pixels(); ++i)
    for (const std::string& name : image.channels) {
      const float value = noise(random);
      image.values.push_back(name.find("variance") != std::string::npos ? 0.01f * scale * scale
                                                                        : value * scale);
    }
  return image;
}

const std::vector<std::string> kAllChannels = {"R",
                                               "G",
                                               "B",
                                               "A",
                                               "variance.R",
                                               "variance.G",
                                               "variance.B",
                                               "albedo.R",
                                               "albedo.G",
                                               "albedo.B",
                                               "normal.X",
                                               "normal.Y",
                                               "normal.Z",
                                               "depth.Z",
                                               "albedo_variance.R",
                                               "albedo_variance.G",
                                               "albedo_variance.B",
                                               "normal_variance.X",
                                               "normal_variance.Y",
                                               "normal_variance.Z",
                                               "depth_variance.Z",
                                               "half_a.R",
                                               "half_a.G",
                                               "half_a.B",
                                               "half_b.R",
                                               "half_b.G",
                                               "half_b.B",
                                               "samples.Y"};

DenoiseOptions options_of(Denoise method) {
  DenoiseOptions options;
  options.method = method;
  options.device.isa = best_isa();
  return options;
}

TEST(DenoiseImage, KeepsOtherLayersAndRenamesTheNoisyVariance) {
  Image noisy = image_of(20, 10, kAllChannels);
  noisy.metadata = {{"penumbra:scene", std::string("a.xml")},
                    {"compression", std::string("zip")},
                    {"openexr:lineOrder", std::string("x")}};
  for (const Denoise method : {Denoise::kNlMeans, Denoise::kNfor}) {
    const auto outcome = denoise_image(noisy, options_of(method));
    ASSERT_TRUE(outcome) << outcome.error().message;
    EXPECT_THAT(outcome->remarks, IsEmpty());
    const Image& image = outcome->image;
    EXPECT_THAT(image.channels, Contains("noisy_variance.R"));
    EXPECT_THAT(image.channels, Contains("error.B"));
    EXPECT_THAT(image.channels, Not(Contains("variance.R")));
    for (const char* kept : {"A", "albedo.G", "depth.Z", "half_a.R", "samples.Y"})
      EXPECT_EQ(image.at(7, 3, *image.channel(kept)), noisy.at(7, 3, *noisy.channel(kept))) << kept;
    EXPECT_NE(image.at(7, 3, 0), noisy.at(7, 3, 0));
    EXPECT_EQ(image.metadata.size(), 2u);
    EXPECT_EQ(std::get<std::string>(*image.attribute("penumbra:denoised_by")), method_name(method));
  }
}

TEST(DenoiseImage, SaysWhichLayersAreMissing) {
  const auto remarks = [](std::vector<std::string> channels) {
    const auto outcome = denoise_image(image_of(9, 8, std::move(channels)), options_of(Denoise::kNfor));
    EXPECT_TRUE(outcome);
    std::string all;
    for (const std::string& remark : outcome->remarks) all += remark + "\n";
    return all;
  };
  EXPECT_THAT(remarks({"R", "G", "B"}), HasSubstr("noise is estimated from neighbouring pixels"));
  EXPECT_THAT(remarks({"R", "G", "B"}), HasSubstr("layers that it lacks: albedo, normal, depth"));
  EXPECT_THAT(
      remarks({"R", "G", "B", "variance.R", "variance.G", "variance.B", "albedo.R", "albedo.G", "albedo.B"}),
      HasSubstr("layers without variance, taken as free of noise: albedo"));
  EXPECT_THAT(
      remarks({"R", "G", "B", "half_a.R", "half_a.G", "half_a.B", "half_b.R", "half_b.G", "half_b.B"}),
      HasSubstr("that of its halves is used"));
}

TEST(DenoiseImage, FindsTheLayersOfOtherRenderers) {
  const std::vector<std::string> blender = {"ViewLayer.Combined.R",         "ViewLayer.Combined.G",
                                            "ViewLayer.Combined.B",         "ViewLayer.Denoising Albedo.R",
                                            "ViewLayer.Denoising Albedo.G", "ViewLayer.Denoising Albedo.B",
                                            "ViewLayer.Denoising Normal.X", "ViewLayer.Denoising Normal.Y",
                                            "ViewLayer.Denoising Normal.Z", "ViewLayer.Denoising Depth.Z"};
  const std::vector<std::string> pbrt = {"R",        "G",    "B",    "Albedo.R", "Albedo.G",
                                         "Albedo.B", "Ns.X", "Ns.Y", "Ns.Z"};
  for (const auto& channels : {blender, pbrt}) {
    const Image image = image_of(5, 4, channels);
    const auto input = denoise_input(image, nullptr);
    ASSERT_TRUE(input) << input.error().message;
    EXPECT_EQ(input->input.features.plane(1)[6], image.values[6 * channels.size() + 4]);
    EXPECT_EQ(input->input.features.plane(5)[6], image.values[6 * channels.size() + 8]);
  }
}

TEST(DenoiseImage, DoesNotDependOnTheExposure) {
  const Image noisy = image_of(30, 20, kAllChannels);
  Image bright = noisy;
  for (std::size_t i = 0; i < bright.values.size(); ++i) {
    const std::string& name = bright.channels[i % bright.channels.size()];
    const bool is_radiance = name.size() == 1 ? name != "A" : name.starts_with("half");
    if (is_radiance) bright.values[i] *= 0x1p40f;
    if (name.starts_with("variance")) bright.values[i] *= 0x1p80f;
  }
  for (const Denoise method : {Denoise::kNlMeans, Denoise::kNfor}) {
    const auto a = denoise_image(noisy, options_of(method)), b = denoise_image(bright, options_of(method));
    ASSERT_TRUE(a && b);
    for (int x = 0; x < 30; ++x) EXPECT_EQ(a->image.at(x, 11, 1) * 0x1p40f, b->image.at(x, 11, 1));
  }
}

TEST(DenoiseImage, TakesValuesThatAreNotFinite) {
  for (const Denoise method : {Denoise::kNlMeans, Denoise::kNfor}) {
    Image image = image_of(24, 20, kAllChannels);
    for (std::size_t i = 0; i < image.values.size(); i += 97)
      image.values[i] = i % 2 == 0 ? kNan : std::numeric_limits<float>::infinity();
    auto outcome = denoise_image(image, options_of(method));
    ASSERT_TRUE(outcome);
    for (int i = 0; i < 24 * 20; ++i)
      for (std::size_t c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(outcome->image.at(i % 24, i / 24, c)));
    std::ranges::fill(image.values, kNan);
    outcome = denoise_image(image, options_of(method));
    ASSERT_TRUE(outcome);
    EXPECT_EQ(outcome->image.at(3, 3, 0), 0);
  }
}

TEST(DenoiseImage, TakesExtremeValues) {
  for (const Denoise method : {Denoise::kNlMeans, Denoise::kNfor})
    for (const float value : {1e-38f, 1e38f, -1e30f, 0.0f}) {
      Image image = image_of(12, 10, kAllChannels);
      for (std::size_t i = 0; i < image.values.size(); i += 31) image.values[i] = value;
      const auto outcome = denoise_image(image, options_of(method));
      ASSERT_TRUE(outcome);
      for (int i = 0; i < 120; ++i) EXPECT_TRUE(std::isfinite(outcome->image.at(i % 12, i / 12, 0))) << value;
    }
}

TEST(DenoiseImage, TakesASinglePixel) {
  for (const Denoise method : {Denoise::kNlMeans, Denoise::kNfor}) {
    const Image pixel = image_of(1, 1, kAllChannels);
    const auto outcome = denoise_image(pixel, options_of(method));
    ASSERT_TRUE(outcome);
    const float mean =
        (pixel.at(0, 0, *pixel.channel("half_a.R")) + pixel.at(0, 0, *pixel.channel("half_b.R"))) / 2;
    EXPECT_NEAR(outcome->image.at(0, 0, 0), mean, 1e-6);
  }
}

TEST(DenoiseImage, TakesDamagedFilesOrRefusesThem) {
  const TemporaryFolder folder;
  const auto good = encode_exr(image_of(16, 12, kAllChannels), {.compression = ExrCompression::kNone});
  ASSERT_TRUE(good);
  std::mt19937 random(1);
  int taken = 0;
  for (int i = 0; i < 200; ++i) {
    std::string bad(good->begin(), good->end());
    for (int k = 0; k < 1 + i % 5; ++k) bad[random() % bad.size()] = char(random());
    if (i % 7 == 0) bad.resize(random() % bad.size());
    write_text(folder / "bad.exr", bad);
    const auto image = read_image(folder / "bad.exr");
    if (!image || image->pixels() > 1000) continue;
    for (const Denoise method : {Denoise::kNlMeans, Denoise::kNfor})
      if (const auto outcome = denoise_image(*image, options_of(method))) {
        EXPECT_EQ(outcome->image.pixels(), image->pixels());
        ++taken;
      }
  }
  EXPECT_GT(taken, 10) << "what is damaged are mostly pixels";
}

TEST(DenoiseImage, NeedsColours) {
  const auto outcome = denoise_image(image_of(4, 4, {"depth.Z", "albedo.R"}), options_of(Denoise::kNfor));
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().message, HasSubstr("no channels R, G, B"));
}

}  // namespace
}  // namespace penumbra
