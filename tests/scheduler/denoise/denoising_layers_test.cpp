// The layers of FEATURE_DENOISING against statistics of single samples.
#include <gtest/gtest.h>

#include <bit>
#include <vector>

#include "scheduler/record/film_image.h"
#include "tests/support/render_scene.h"
#include "tests/support/statistics.h"

namespace penumbra {
namespace {

constexpr int kSide = 24;
constexpr std::uint32_t kSamples = 13;  // odd: the halves have 7 and 6

SceneDescription scene(Denoise denoise) {
  SceneDescription description = read_or_throw(project_file("scenes/cornell-small/cornell-small.xml"));
  resize_film(description, kSide, kSide);
  description.sampler.spp = kSamples;
  description.film.denoise = denoise;
  return description;
}

RenderUnit unit_of(std::uint32_t first, std::uint32_t count) {
  return {.x = 0, .y = 0, .width = kSide, .height = kSide, .first_sample = first, .sample_count = count};
}

/// One result for each sample.
std::vector<SampleBuffer> single_samples(const DeviceScene& device_scene, const DeviceOptions& options) {
  const auto device = make_device(device_scene, options);
  EXPECT_TRUE(device);
  std::vector<SampleBuffer> samples;
  for (std::uint32_t s = 0; s < kSamples; ++s) samples.push_back(*(*device)->render(unit_of(s, 1)));
  return samples;
}

TEST(DenoisingLayers, AreStatisticsOfTheSamples) {
  const DeviceScene device_scene = build_or_throw(scene(Denoise::kLayers));
  const std::vector<SampleBuffer> samples = single_samples(device_scene, native_device().options);
  TestDevice in_passes = native_device();
  for (const std::uint32_t samples_per_pass : {16u, 5u, 1u}) {
    in_passes.samples_per_pass = samples_per_pass;
    const FilmAccumulator film = render_or_throw(device_scene, in_passes);
    const Image image = image_of_film(film, kSide, kSide);
    const FilmLayers& layers = film.layers();
    const std::pair<const char*, int> variances[] = {{"albedo_variance.G", layers.plane(LAYER_ALBEDO) + 1},
                                                     {"normal_variance.Z", layers.plane(LAYER_NORMAL) + 2},
                                                     {"depth_variance.Z", layers.plane(LAYER_DEPTH)}};
    for (int i = 0; i < kSide * kSide; ++i) {
      const auto pixel = std::size_t(i);
      const auto shown = [&](const char* name) {
        return image.at(i % kSide, i / kSide, *image.channel(name));
      };
      for (const auto& [name, plane] : variances) {
        statistics::Sample sample;
        for (const SampleBuffer& one : samples) sample.add(one.plane(plane)[pixel]);
        const double variance = sample.variance() / kSamples;
        // Results hold standard deviations in single precision.
        ASSERT_NEAR(shown(name), variance, 1e-5 * variance + 1e-9) << name << " of pixel " << i;
      }
      double halves[2] = {0, 0};
      for (std::uint32_t s = 0; s < kSamples; ++s)
        halves[std::popcount(s) % 2] += double(samples[s].plane(kMeanG)[pixel]);
      ASSERT_NEAR(shown("half_a.G"), halves[0] / 7, 2e-6 * (1 + halves[0]));
      ASSERT_NEAR(shown("half_b.G"), halves[1] / 6, 2e-6 * (1 + halves[1]));
    }
  }
}

TEST(DenoisingLayers, DoNotChangeTheImage) {
  const Image with = image_of_film(render_or_throw(scene(Denoise::kLayers)), kSide, kSide),
              without = image_of_film(render_or_throw(scene(Denoise::kOff)), kSide, kSide);
  for (const std::string& channel : without.channels)
    for (int i = 0; i < kSide * kSide; ++i) {
      ASSERT_EQ(with.at(i % kSide, i / kSide, *with.channel(channel)),
                without.at(i % kSide, i / kSide, *without.channel(channel)))
          << channel;
    }
}

TEST(DenoisingLayers, OpenClGivesTheSameBits) {
  const SceneDescription description = scene(Denoise::kNfor);
  EXPECT_EQ(render_or_throw(description, native_device()).hash(),
            render_or_throw(description, opencl_device()).hash());
}

TEST(DenoisingLayers, MeansOfTwoFilmsHaveTheirVariances) {
  const FilmLayers layers(FEATURE_LAYERS | FEATURE_DENOISING);
  const auto film = [&](float value, float deviation, std::uint32_t count) {
    FilmAccumulator filled(0, 0, 1, 1, layers);
    SampleBuffer buffer{
        .width = 1, .height = 1, .planes = layers.planes(), .sample_count = count, .values = {}};
    buffer.values.assign(std::size_t(layers.planes()), value);
    for (int k = 0; k < FEATURE_PLANES; ++k)
      buffer.values[std::size_t(layers.plane(LAYER_ALBEDO_VARIANCE) + k)] = deviation;
    filled.add(0, 0, buffer);
    return filled;
  };
  FilmAccumulator mean(0, 0, 1, 1, layers);
  mean.set_mean_of(film(1, 2, 9), film(3, 4, 5));
  const Image image = image_of_film(mean, 1, 1);
  EXPECT_EQ(image.at(0, 0, *image.channel("albedo.R")), 2);
  // Variances of the means 4 / 8 and 16 / 4, a quarter of their sum.
  EXPECT_NEAR(image.at(0, 0, *image.channel("albedo_variance.R")), (4.0 / 8 + 16.0 / 4) / 4, 1e-6);
}

}  // namespace
}  // namespace penumbra
