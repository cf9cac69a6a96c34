#include "scheduler/record/merged_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "scheduler/record/cryptomatte.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAreArray;

// Files hold floats, and sums are in double: a result is the rounded truth.
constexpr double kFloatRounding = 0x1p-23;

const std::vector<std::string> kChannels = {"R",          "G",          "B",        "variance.R",
                                            "variance.G", "variance.B", "depth.Z",  "depth_variance.Z",
                                            "half_a.R",   "half_b.R",   "samples.Y"};

Image image_of(std::uint32_t seed, std::vector<float> values, std::vector<std::string> channels = kChannels) {
  Image image;
  image.data = image.display = {0, 0, int(values.size() / channels.size()), 1};
  image.channels = std::move(channels);
  image.values = std::move(values);
  image.metadata = {{"penumbra:scene_hash", std::string("abc")},
                    {"penumbra:seed", int(seed)},
                    {"penumbra:spp", 16},
                    {"penumbra:command", "penumbra render s.xml --seed " + std::to_string(seed)}};
  return image;
}

/// Pixels with these numbers of samples, and values that have nothing to do with each other.
Image random_image(std::uint32_t seed, const std::vector<float>& counts) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(0.1f, 3.0f);
  std::vector<float> values;
  for (const float count : counts)
    for (std::size_t c = 0; c < kChannels.size(); ++c)
      values.push_back(kChannels[c] == "samples.Y"                                       ? count
                       : count == 0                                                      ? 0
                       : kChannels[c].find("variance") != std::string::npos && count < 2 ? 0
                                                                                         : value(random));
  return image_of(seed, values);
}

struct Merged {
  Image image;
  std::vector<std::string> remarks;
};

Merged merged_of(const std::vector<Image>& images) {
  std::vector<MergeSource> sources;
  for (std::size_t i = 0; i < images.size(); ++i) {
    auto source = merge_source(std::to_string(i) + ".exr", images[i]);
    if (!source) return ADD_FAILURE() << source.error().message, Merged();
    sources.push_back(std::move(*source));
  }
  if (const auto checked = check_sources(sources); !checked)
    return ADD_FAILURE() << checked.error().message, Merged();
  ImageMerge merge(sources);
  for (const MergeSource& source : sources)
    EXPECT_TRUE(merge.add(source, images[std::size_t(std::stoi(source.file.string()))]));
  Expected<Image> image = merge.image();
  if (!image) return ADD_FAILURE() << image.error().message, Merged();
  return {*std::move(image), merge.remarks()};
}

float at(const Image& image, int x, const std::string& channel) {
  return image.at(x, 0, *image.channel(channel));
}

/// The statistics of the union, from sums of samples and of their squares.
TEST(MergedImage, HasTheStatisticsOfAllSamples) {
  const std::vector<Image> images = {random_image(1, {16, 3, 0, 1, 0}), random_image(2, {16, 200, 5, 1, 0}),
                                     random_image(7, {4, 1, 9, 0, 0})};
  const Image merged = merged_of(images).image;
  ASSERT_THAT(merged.channels, UnorderedElementsAreArray(kChannels));
  for (int x = 0; x < 5; ++x)
    for (const auto& [mean, variance] : {std::pair("R", "variance.R"),
                                         {"G", "variance.G"},
                                         {"B", "variance.B"},
                                         {"depth.Z", "depth_variance.Z"}}) {
      long double count = 0, sum = 0, squares = 0;
      for (const Image& image : images) {
        const long double n = at(image, x, "samples.Y"), m = at(image, x, mean);
        count += n;
        sum += n * m;
        squares += at(image, x, variance) * n * (n - 1) + n * m * m;
      }
      EXPECT_EQ(at(merged, x, "samples.Y"), float(count));
      const long double all = count > 0 ? sum / count : 0;
      EXPECT_NEAR(at(merged, x, mean), all, std::abs(all) * kFloatRounding) << x << mean;
      const long double expected = count < 2 ? 0 : (squares - count * all * all) / (count * (count - 1));
      EXPECT_NEAR(at(merged, x, variance), expected, expected * kFloatRounding) << x << variance;
    }
}

/// Images of one sample each are the samples themselves.
TEST(MergedImage, OfSingleSamplesHasTheirVariance) {
  std::vector<Image> images;
  for (std::uint32_t seed = 0; seed < 9; ++seed) images.push_back(random_image(seed, {1, 1}));
  const Image merged = merged_of(images).image;
  for (int x = 0; x < 2; ++x) {
    long double mean = 0, squares = 0;
    for (const Image& image : images) mean += at(image, x, "G") / 9.0L;
    for (const Image& image : images) squares += (at(image, x, "G") - mean) * (at(image, x, "G") - mean);
    EXPECT_NEAR(at(merged, x, "variance.G"), squares / 8 / 9, squares * kFloatRounding);
  }
}

TEST(MergedImage, HalvesAreWeightedByTheirSamples) {
  for (const std::uint32_t per_map : {1u, 3u})
    for (std::uint64_t samples = 0; samples < 70; ++samples) {
      int in_a = 0;
      for (std::uint64_t i = 0; i < samples; ++i) in_a += std::popcount(i / per_map) % 2 == 0 ? 1 : 0;
      EXPECT_EQ(samples_of_half_a(samples, per_map), in_a) << samples << " samples, " << per_map << " a map";
    }
  // Of 3 samples, 0 is in half A, 1 and 2 are in half B; of 1 only A has one.
  const std::vector<Image> images = {random_image(1, {3}), random_image(2, {1}), random_image(3, {16})};
  const Image merged = merged_of(images).image;
  const auto of = [&](std::size_t k, const char* half) { return double(at(images[k], 0, half)); };
  EXPECT_NEAR(at(merged, 0, "half_a.R"), (of(0, "half_a.R") + of(1, "half_a.R") + 8 * of(2, "half_a.R")) / 10,
              3 * kFloatRounding);
  EXPECT_NEAR(at(merged, 0, "half_b.R"), (2 * of(0, "half_b.R") + 8 * of(2, "half_b.R")) / 10,
              3 * kFloatRounding);
}

/// The number of samples then depends on their values, and must not weigh.
TEST(MergedImage, WithATargetErrorImagesHaveFixedWeights) {
  std::vector<Image> images = {random_image(1, {40, 0}), random_image(2, {8, 8})};
  for (Image& image : images) std::get<std::string>(image.metadata[3].second) += " --target-error 0.1";
  const Image merged = merged_of(images).image;
  EXPECT_EQ(at(merged, 0, "samples.Y"), 48);
  EXPECT_NEAR(at(merged, 0, "R"), (at(images[0], 0, "R") + at(images[1], 0, "R")) / 2, 3 * kFloatRounding);
  EXPECT_NEAR(at(merged, 0, "variance.R"),
              (at(images[0], 0, "variance.R") + at(images[1], 0, "variance.R")) / 4, kFloatRounding);
  EXPECT_EQ(at(merged, 1, "R"), at(images[1], 1, "R")) << "an image without samples there does not count";
}

TEST(MergedImage, CryptomatteHasTheSixLargestIds) {
  std::vector<std::string> channels = {"R", "G", "B", "variance.R", "variance.G", "variance.B", "samples.Y"};
  for (const std::string& name : cryptomatte_channels()) channels.push_back(name);
  const auto with = [&](std::uint32_t seed, float samples, std::vector<std::pair<int, float>> objects) {
    std::vector<float> values = {1, 1, 1, 0, 0, 0, samples};
    objects.resize(kCryptomatteRanks);
    for (const auto& [id, coverage] : objects) values.insert(values.end(), {float(id), coverage});
    values.resize(channels.size());
    return image_of(seed, values, channels);
  };
  // 10 samples: 7 of ID 1, 3 of ID 2; 30 samples: 15 of ID 2, 10 of ID 3, 5 of nothing.
  const Merged merged =
      merged_of({with(1, 10, {{1, 0.7f}, {2, 0.3f}}), with(2, 30, {{2, 0.5f}, {3, 1 / 3.0f}})});
  const Image& image = merged.image;
  EXPECT_EQ(image.exact_channels, std::size_t(kCryptomatteChannels));
  EXPECT_EQ(at(image, 0, "CryptoObject00.R"), 2);
  EXPECT_EQ(at(image, 0, "CryptoObject00.G"), 18 / 40.0f);
  EXPECT_EQ(at(image, 0, "CryptoObject00.B"), 3);
  EXPECT_EQ(at(image, 0, "CryptoObject00.A"), 10 / 40.0f);
  EXPECT_EQ(at(image, 0, "CryptoObject01.R"), 1);
  EXPECT_EQ(at(image, 0, "CryptoObject01.G"), 7 / 40.0f);
  EXPECT_EQ(at(image, 0, "CryptoObject01.A"), 0);
  EXPECT_EQ(at(image, 0, "CryptoMaterial00.G"), 0);
  EXPECT_THAT(merged.remarks, ElementsAre());
  std::vector<std::pair<int, float>> many;
  for (int id = 1; id <= 6; ++id) many.emplace_back(id, 0.15f);
  EXPECT_THAT(merged_of({with(1, 20, many), with(2, 30, {{2, 1}})}).remarks,
              ElementsAre(HasSubstr("Cryptomatte is approximate: 1 pixels")));
}

TEST(MergedImage, ValuesThatNoRenderHasAreCountedAndRefused) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                  kInfinity = std::numeric_limits<float>::infinity();
  const auto index = [](const char* channel) {
    return std::size_t(std::ranges::find(kChannels, channel) - kChannels.begin());
  };
  const auto error_of = [&](const char* channel, float value) -> std::string {
    std::vector<Image> images = {random_image(1, {4, 4, 4}), random_image(2, {4, 4, 4})};
    images[1].data.x = images[0].data.x = 10;
    for (const std::size_t pixel : {1u, 2u})
      images[1].values[pixel * kChannels.size() + index(channel)] = value;
    std::vector<MergeSource> sources;
    for (int i : {0, 1})
      sources.push_back(merge_source(i == 0 ? "a.exr" : "b.exr", images[std::size_t(i)]).value());
    ImageMerge merge(sources);
    EXPECT_TRUE(merge.add(sources[0], images[0]));
    if (const auto added = merge.add(sources[1], images[1]); !added) return added.error().message;
    const auto image = merge.image();
    return image ? "" : image.error().message;
  };
  EXPECT_THAT(error_of("G", kNan), HasSubstr("b.exr has 2 pixels with values that no render has"));
  EXPECT_THAT(error_of("G", kNan), HasSubstr("G is nan at pixel 11, 0"));
  EXPECT_THAT(error_of("depth.Z", -kInfinity), HasSubstr("depth.Z is -inf"));
  EXPECT_THAT(error_of("variance.R", kNan), HasSubstr("variance.R is nan"));
  EXPECT_THAT(error_of("variance.B", -1), HasSubstr("variance.B is -1"));
  EXPECT_THAT(error_of("half_b.R", kInfinity), HasSubstr("half_b.R is inf"));
  EXPECT_THAT(error_of("samples.Y", kNan), HasSubstr("samples.Y is nan"));
  EXPECT_THAT(error_of("samples.Y", -4), HasSubstr("samples.Y is -4"));
  EXPECT_THAT(error_of("samples.Y", 1e30f), HasSubstr("samples.Y is 1e+30"));
  EXPECT_THAT(error_of("R", 1e38f), HasSubstr("the merged image has 2 pixels"));
  EXPECT_EQ(error_of("R", 1e15f), "") << "whose square is in range";
}

/// The first image with samples of the pixel decides, in the order of seeds.
TEST(MergedImage, KeepsShapesOfTheFirstSeed) {
  const std::vector<std::string> channels{"R",          "G",          "B",         "variance.R",
                                          "variance.G", "variance.B", "samples.Y", "shape.ID"};
  const auto image = [&](std::uint32_t seed, float samples, float shape) {
    return image_of(seed, {1, 1, 1, 0, 0, 0, samples, shape, 1, 1, 1, 0, 0, 0, 4, shape + 1}, channels);
  };
  for (const bool swapped : {false, true}) {
    const Image first = image(1, 0, 5), second = image(2, 4, 9);
    const Image merged = swapped ? merged_of({second, first}).image : merged_of({first, second}).image;
    const std::size_t shape = merged.channel("shape.ID").value();
    EXPECT_EQ(merged.at(0, 0, shape), 9) << "the first has no samples there";
    EXPECT_EQ(merged.at(1, 0, shape), 6);
  }
}

TEST(MergedImage, LeavesOutWhatNotAllHave) {
  Image other = random_image(2, {4});
  other.channels[6] = "depth.W";
  other.channels[10] = "samples.Y";
  const Merged merged = merged_of({random_image(1, {4}), other});
  EXPECT_FALSE(merged.image.channel("depth.Z"));
  EXPECT_FALSE(merged.image.channel("depth_variance.Z")) << "a variance without its mean";
  EXPECT_THAT(merged.remarks, ElementsAre(HasSubstr("depth, depth_variance")));
}

std::string refusal(std::vector<Image> images) {
  std::vector<MergeSource> sources;
  for (const Image& image : images) {
    auto source = merge_source(std::string(1, char('a' + sources.size())) + ".exr", image);
    if (!source) return source.error().message;
    sources.push_back(std::move(*source));
  }
  const auto checked = check_sources(sources);
  return checked ? "" : checked.error().message;
}

TEST(MergeSource, IsOfTheSameRenderWithAnotherSeed) {
  const Image one = random_image(1, {4}), two = random_image(2, {4});
  EXPECT_EQ(refusal({one, two}), "");
  EXPECT_THAT(refusal({one}), HasSubstr("two images or more"));
  EXPECT_THAT(refusal({one, two, one}), HasSubstr("a.exr and c.exr both have the samples of seed 1"));
  const auto with = [&](const char* name, MetadataValue value) {
    Image image = two;
    std::erase_if(image.metadata, [&](const auto& entry) { return entry.first == name; });
    image.metadata.emplace_back(name, std::move(value));
    return image;
  };
  EXPECT_THAT(refusal({one, with("penumbra:scene_hash", "xyz")}),
              HasSubstr("scene_hash): a.exr has abc, b.exr"));
  EXPECT_THAT(refusal({one, with("penumbra:integrator.max_depth", 3)}),
              HasSubstr("integrator.max_depth: a.exr has none, b.exr has 3"));
  EXPECT_THAT(refusal({one, with("penumbra:set", "sampler.seed=2\ncamera.fov=30")}),
              HasSubstr("differ in set: a.exr has none, b.exr has camera.fov=30"));
  for (const char* name : {"penumbra:spp", "penumbra:tile", "penumbra:stop_after"})
    EXPECT_EQ(refusal({one, with(name, 3)}), "") << name;
  EXPECT_EQ(refusal({one, with("penumbra:set", "film.width=5\nsampler.sample_count=3")}), "");
  EXPECT_THAT(refusal({one, random_image(2, {4, 4})}), HasSubstr("size of the film"));
  Image cropped = two;
  cropped.display.width = 2;
  Image other_crop = random_image(1, {4});
  other_crop.display.width = 2;
  other_crop.data.x = 1;
  EXPECT_THAT(refusal({other_crop, cropped}), HasSubstr("crop: a.exr has 1 x 1 pixels at (1, 0), b.exr"));
  Image camera = two;
  camera.camera.emplace();
  EXPECT_THAT(refusal({one, camera}), HasSubstr("differ in camera"));
}

TEST(MergeSource, NamesWhatIsMissing) {
  const Image one = random_image(1, {4});
  Image image = one;
  image.channels[3] = "X";
  image.channels[10] = "Y";
  EXPECT_THAT(refusal({image, one}),
              HasSubstr("a.exr cannot be merged without the channels variance.R, samples.Y"));
  image = one;
  image.metadata.erase(image.metadata.begin());
  EXPECT_THAT(refusal({image, one}), HasSubstr("no metadata penumbra:scene_hash"));
  image = one;
  image.metadata.erase(image.metadata.begin() + 1);
  EXPECT_THAT(refusal({image, one}), HasSubstr("no metadata penumbra:seed"));
  image = one;
  image.metadata.emplace_back("penumbra:denoised_by", std::string("nfor"));
  EXPECT_THAT(refusal({image, one}), HasSubstr("a.exr is denoised"));
}

TEST(MergedImage, TellsItsSeedsAndCanBeMergedAgain) {
  Image first = random_image(1, {4, 4}), second = random_image(2, {4, 3}), third = random_image(5, {4, 4});
  second.metadata.emplace_back("penumbra:incomplete", 1);
  const Image two = merged_of({third, second}).image;
  EXPECT_EQ(metadata_text(two, "penumbra:seeds"), "2, 5");
  EXPECT_EQ(metadata_text(two, "penumbra:merged"),
            "penumbra render s.xml --seed 2\npenumbra render s.xml --seed 5");
  EXPECT_EQ(metadata_text(two, "penumbra:spp"), "32");
  EXPECT_EQ(metadata_text(two, "penumbra:incomplete"), "1");
  EXPECT_EQ(metadata_text(two, "penumbra:samples_per_pixel"), "7 to 8");
  EXPECT_EQ(metadata_text(two, "penumbra:seed"), "");
  EXPECT_EQ(metadata_text(two, "penumbra:command"), "");
  const Image again = merged_of({two, first}).image, at_once = merged_of({first, second, third}).image;
  EXPECT_EQ(again.metadata, at_once.metadata);
  for (std::size_t c = 0; c < again.channels.size(); ++c) {
    if (again.channels[c].starts_with("half")) continue;  // the number of samples in them is not in files
    for (int x = 0; x < 2; ++x)
      EXPECT_NEAR(again.at(x, 0, c), at_once.at(x, 0, c), 4 * kFloatRounding * at_once.at(x, 0, c));
  }
  EXPECT_THAT(refusal({two, third}), HasSubstr("both have the samples of seed 5"));
}

}  // namespace
}  // namespace penumbra
