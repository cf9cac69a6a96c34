#include "scheduler/image/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

Image image_of(int width, int height, std::vector<float> values) {
  Image image;
  image.data = image.display = {0, 0, width, height};
  image.channels = {"R", "G", "B"};
  image.values = std::move(values);
  return image;
}

/// R, G, B and the variance of each.
Image with_variance(const Image& image, float variance) {
  Image result = image;
  result.channels = {"R", "G", "B", "variance.R", "variance.G", "variance.B"};
  result.values.clear();
  for (std::size_t i = 0; i < image.values.size(); i += 3) {
    result.values.insert(result.values.end(), image.values.begin() + std::ptrdiff_t(i),
                         image.values.begin() + std::ptrdiff_t(i + 3));
    result.values.insert(result.values.end(), 3, variance);
  }
  return result;
}

Comparison compared(const Image& image, const Image& reference, const CompareOptions& options = {}) {
  return compare_images({.image = image, .reference = reference}, options).value();
}

CompareOptions with_flip(FlipKind kind) {
  CompareOptions options;
  options.flip = kind;
  return options;
}

// d: (1, 0, -2) and (0, 0, 0.5).
const Image kImage = image_of(2, 1, {2, 3, 1, 0, 0, 0.5f}), kReference = image_of(2, 1, {1, 3, 3, 0, 0, 0});

TEST(Compare, HoldsEveryMetric) {
  const Comparison c = compared(kImage, kReference);
  EXPECT_DOUBLE_EQ(c.mse.overall, 5.25 / 6);
  EXPECT_DOUBLE_EQ(c.relative_mse.overall, (1 / 1.01 + 4 / 9.01 + 0.25 / 0.01) / 6);
  EXPECT_DOUBLE_EQ(c.trimmed_relative_mse.overall, c.relative_mse.overall);
  EXPECT_DOUBLE_EQ(c.bias.overall, -0.25 / 3);
  EXPECT_EQ(c.largest_at.x, 0);
  EXPECT_EQ(c.largest_at.channel, 2u);
  EXPECT_DOUBLE_EQ(c.mean_ratio(0), 2);
  ASSERT_TRUE(c.flip);
  EXPECT_TRUE(c.flip->hdr);
  EXPECT_FALSE(c.z_test);
  EXPECT_THAT(c.z_test_left_out, HasSubstr("neither image has a variance"));
}

TEST(Compare, FlipFitsTheImages) {
  Image png = kImage;
  png.metadata = {{"oiio:ColorSpace", "sRGB"}};
  EXPECT_FALSE(compared(png, png).flip->hdr);
  EXPECT_TRUE(compared(png, png, with_flip(FlipKind::kRadiance)).flip->hdr);
  EXPECT_FALSE(compared(kImage, kReference, with_flip(FlipKind::kNone)).flip);
  CompareOptions options;
  options.layer = "R";
  EXPECT_FALSE(compared(kImage, kReference, options).flip);
  options = {};
  options.pixels_per_degree = -1;
  EXPECT_FALSE(compare_images({.image = kImage, .reference = kReference}, options));
}

TEST(Compare, VarianceComesFromTheImagesOrFromFiles) {
  const Image a = with_variance(kImage, 4), b = with_variance(kReference, 12);
  EXPECT_NEAR(compared(a, b).z_test->largest.z, -2 / 4.0, 1e-6);
  EXPECT_NEAR(compared(a, kReference).z_test->largest.z, -2 / 2.0, 1e-6);
  EXPECT_NEAR(compared(kImage, b).z_test->largest.z, -2 / std::sqrt(12.0), 1e-6);
  const Image file = image_of(2, 1, std::vector<float>(6, 1.0f)), small = image_of(1, 1, {1, 1, 1});
  const auto overruled =
      compare_images({.image = a, .reference = b, .variance = &file, .reference_variance = &file});
  ASSERT_TRUE(overruled);
  EXPECT_NEAR(overruled->z_test->largest.z, -2 / std::sqrt(2.0), 1e-6);
  const auto wrong = compare_images({.image = a, .reference = b, .variance = &small});
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("variance: the variance is of 1 x 1"));
  // The mean of two references of variance 12 has 6.
  const auto halves = compare_images({.image = a, .reference = b, .second_reference = &b});
  ASSERT_TRUE(halves);
  EXPECT_NEAR(halves->z_test->largest.z, -2 / std::sqrt(10.0), 1e-6);
  EXPECT_THAT(comparison_text(*halves), HasSubstr("the mean of two references"));
}

TEST(Compare, LinearAndDisplayReferredImagesAreNotCompared) {
  Image png = kImage;
  png.metadata = {{"oiio:ColorSpace", "sRGB"}};
  const auto mixed = compare_images({.image = png, .reference = kReference});
  ASSERT_FALSE(mixed);
  EXPECT_THAT(
      mixed.error().message,
      AllOf(HasSubstr("the reference is linear and the image is display-referred"), HasSubstr("--ldr")));
  EXPECT_FALSE(compare_images({.image = kImage, .reference = png}));
  EXPECT_FALSE(compare_images({.image = kImage, .reference = kReference, .second_reference = &png}));
}

/// 16 x 16 pixels of `mean` with a deviation of 0.1, from `samples` samples (0: unknown).
Image noisy_image(float mean, float samples, std::uint32_t seed) {
  Image image;
  image.data = image.display = {0, 0, 16, 16};
  image.channels = {
      "R", "G", "B", "variance.R", "variance.G", "variance.B", samples > 0 ? "samples.Y" : "depth.Z"};
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(mean, 0.1f);
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    for (int c = 0; c < 3; ++c) image.values.push_back(normal(random));
    image.values.insert(image.values.end(), 3, 0.01f);
    image.values.push_back(samples);
  }
  return image;
}

Image without_variance(const Image& image) {
  Image result = image;
  for (std::string& name : result.channels) {
    if (name.starts_with("variance")) name = "other" + name;
  }
  return result;
}

TEST(Compare, TheVerdictSaysWhy) {
  const Image a = noisy_image(1, 64, 1), b = noisy_image(1, 64, 2), darker = noisy_image(0.9f, 64, 3);
  EXPECT_EQ(compared(a, b).verdict, Verdict::kAgree);
  EXPECT_THAT(compared(a, b).verdict_reason, HasSubstr("% of the image mean would be found"));
  EXPECT_EQ(compared(a, darker).verdict, Verdict::kDiffer);
  EXPECT_THAT(compared(a, darker).verdict_reason, AllOf(HasSubstr("image mean of "), HasSubstr(", p = ")));
  EXPECT_THAT(comparison_text(compared(a, darker)),
              HasSubstr("verdict: THE IMAGES DIFFER, at significance 0.01"));
  EXPECT_EQ(comparison_json(compared(a, darker))["verdict"], "differ");
  EXPECT_EQ(compared(kImage, kImage).verdict, Verdict::kAgree);

  const auto expect_inconclusive = [](const Comparison& c, const std::string& reason) {
    EXPECT_EQ(c.verdict, Verdict::kInconclusive) << reason;
    EXPECT_THAT(c.verdict_reason, HasSubstr(reason));
    EXPECT_EQ(comparison_json(c)["verdict"], "inconclusive");
    EXPECT_THAT(comparison_text(c), HasSubstr("verdict: inconclusive: "));
  };
  expect_inconclusive(compared(kImage, kReference), "neither image has a variance");
  expect_inconclusive(compared(noisy_image(1, 2, 1), darker), "of A are estimated from 2 samples per pixel");
  expect_inconclusive(compared(a, noisy_image(0.9f, 3, 1)), "of B are estimated from 3 samples per pixel");
  // A deviation of 0.1 beside a mean of 0.01: means over 256 pixels are known to 0.006.
  expect_inconclusive(compared(noisy_image(0.01f, 64, 1), noisy_image(0.01f, 64, 2)), "would not be seen");
  for (const auto& [name, value] : {std::pair("penumbra:integrator", "ppm"),
                                    {"penumbra:integrator", "photonmapper"},
                                    {"penumbra:denoised_by", "nfor"}}) {
    Image marked = darker;
    marked.metadata.emplace_back(name, std::string(value));
    expect_inconclusive(compared(a, marked), std::string(" (") + value + ")");
    expect_inconclusive(compared(marked, a), std::string(" (") + value + ")");
  }
  // Where one image has no variances, agreement holds, but a difference may be the other one's noise.
  EXPECT_EQ(compared(a, without_variance(noisy_image(1, 64, 2))).verdict, Verdict::kInconclusive);
  expect_inconclusive(compared(a, without_variance(darker)), "--exact-reference");
  expect_inconclusive(compared(without_variance(darker), a), "A has no variances");
  CompareOptions exact;
  exact.exact_reference = true;
  EXPECT_EQ(compared(a, without_variance(darker), exact).verdict, Verdict::kDiffer);
}

TEST(Compare, TextSaysWhatEachNumberIs) {
  const Comparison c = compared(with_variance(kImage, 4), kReference);
  EXPECT_THAT(comparison_text(c),
              AllOf(HasSubstr("2 x 1 pixels, layer beauty"), HasSubstr("mean of d^2 / (B^2 + 0.01)"),
                    HasSubstr("B at pixel 0,0"), HasSubstr("HDR-FLIP"),
                    HasSubstr("variances: of A exact; of B none, counts as exact"),
                    Not(HasSubstr("NaN or infinite"))));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(comparison_text(compared(image_of(2, 1, {nan, 0, 0, 1, 1, 1}), kReference)),
              HasSubstr("left out, as NaN or infinite: 1 pixels of A, 0 of B; 1 of 2 compared"));
}

TEST(Compare, JsonHasNullForWhatIsNotKnown) {
  const Comparison c = compared(image_of(1, 1, {0, 1, 1}), image_of(1, 1, {0, 0, 2}));
  const auto json = comparison_json(c);
  EXPECT_TRUE(json["mean_ratio"][0].is_null());
  EXPECT_TRUE(json["mean_ratio"][1].is_null());
  EXPECT_EQ(json["mean_ratio"][2], 0.5);
  EXPECT_EQ(json["mse"], 2.0 / 3);
  EXPECT_EQ(json["per_channel"]["mse"], (std::vector<double>{0, 1, 1}));
  EXPECT_TRUE(json["z_test"].is_null());
  EXPECT_EQ(json["flip"]["kind"], "HDR");
}

TEST(Compare, MapsAreThoseThatThereAre) {
  const Comparison c = compared(kImage, kReference, with_flip(FlipKind::kNone));
  EXPECT_TRUE(error_map(c, "relmse"));
  EXPECT_THAT(error_map(c, "abs")->values, ElementsAre(1, ::testing::FloatEq(0.5f / 3)));
  EXPECT_THAT(error_map(c, "flip").error().message, HasSubstr("not asked for"));
  EXPECT_THAT(error_map(c, "z").error().message, HasSubstr("neither image has a variance"));
  EXPECT_FALSE(error_map(c, "foo"));
  EXPECT_EQ(error_map(compared(kImage, kReference), "flip")->values.size(), 2u);
  EXPECT_EQ(error_map(compared(with_variance(kImage, 1), kReference), "z")->values[0], 2);
}

TEST(CompareLimits, AreParsedAndLookedUp) {
  const auto limit = parse_limit("trimmed_relmse=1e-3");
  ASSERT_TRUE(limit);
  EXPECT_EQ(limit->metric, "trimmed_relmse");
  EXPECT_EQ(limit->value, 1e-3);
  for (const char* wrong :
       {"", "mse", "mse=", "mse=x", "mse=1x", "mse=-1", "mse=nan", "mse=inf", "=1", "foo=1"}) {
    EXPECT_FALSE(parse_limit(wrong)) << wrong;
  }
  EXPECT_THAT(parse_limit("foo=1").error().message, AllOf(HasSubstr("'foo'"), HasSubstr("relmse")));
  const Comparison bare = compared(kImage, kReference, with_flip(FlipKind::kNone));
  const Comparison full = compared(with_variance(kImage, 4), kReference);
  for (const std::string& metric : limit_metrics()) {
    const auto value = limited_value(full, metric);
    ASSERT_TRUE(value) << metric;
    EXPECT_GE(*value, 0) << metric;
  }
  EXPECT_EQ(*limited_value(full, "max"), 2);
  EXPECT_EQ(*limited_value(full, "bias"), 0.75);  // the blue channel's; overall they cancel
  EXPECT_NEAR(*limited_value(full, "max_z"), 1, 1e-6);
  EXPECT_FALSE(limited_value(bare, "flip"));
  EXPECT_THAT(limited_value(bare, "max_z").error().message, HasSubstr("neither image has a variance"));
  // NaN where a channel is black in both: no limit holds then.
  const Image no_red = image_of(1, 1, {0, 1, 1});
  EXPECT_TRUE(std::isnan(*limited_value(compared(no_red, no_red), "relative_bias")));
}

}  // namespace
}  // namespace penumbra
