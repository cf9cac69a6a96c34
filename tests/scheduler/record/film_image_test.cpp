#include "scheduler/record/film_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scheduler/plan/render_memory.h"
#include "tests/support/film_layers.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;

constexpr std::uint64_t kLayerFeatures[] = {0, FEATURE_LAYERS, FEATURE_LAYERS | FEATURE_POLYGONS};

/// Every plane p of pixel i is p + i / 8.
SampleBuffer buffer_of(int width, int height, const FilmLayers& layers, std::uint32_t samples) {
  SampleBuffer buffer;
  buffer.width = width;
  buffer.height = height;
  buffer.planes = layers.planes();
  buffer.sample_count = samples;
  for (int p = 0; p < buffer.planes; ++p) {
    for (int i = 0; i < width * height; ++i) buffer.values.push_back(float(p) + float(i) / 8);
  }
  return buffer;
}

TEST(FilmImage, PutsEveryStatisticInItsLayer) {
  FilmAccumulator film(4, 6, 3, 2, kPolygonLayers);
  film.add(4, 6, buffer_of(3, 2, kPolygonLayers, 5));
  const Image image = image_of_film(film, 16, 12);
  EXPECT_EQ(image.data, (PixelWindow{4, 6, 3, 2}));
  EXPECT_EQ(image.display, (PixelWindow{0, 0, 16, 12}));
  const std::vector<std::pair<std::string, int>> planes = {
      {"R", kMeanR},
      {"G", kMeanG},
      {"B", kMeanB},
      {"albedo.R", kPolygonLayers.plane(LAYER_ALBEDO)},
      {"albedo.G", kPolygonLayers.plane(LAYER_ALBEDO) + 1},
      {"albedo.B", kPolygonLayers.plane(LAYER_ALBEDO) + 2},
      {"normal.X", kPolygonLayers.plane(LAYER_NORMAL)},
      {"normal.Y", kPolygonLayers.plane(LAYER_NORMAL) + 1},
      {"normal.Z", kPolygonLayers.plane(LAYER_NORMAL) + 2},
      {"depth.Z", kPolygonLayers.plane(LAYER_DEPTH)},
      {"analytic.R", kPolygonLayers.plane(LAYER_ANALYTIC)},
      {"analytic.B", kPolygonLayers.plane(LAYER_ANALYTIC) + 2},
      {"difference.G", kPolygonLayers.plane(LAYER_DIFFERENCE) + 1}};
  for (int i = 0; i < 6; ++i) {
    const int x = i % 3, y = i / 3;
    for (const auto& [name, plane] : planes) {
      EXPECT_EQ(image.at(x, y, *image.channel(name)), float(plane) + float(i) / 8) << name;
    }
    const float deviation = float(kDeviationG) + float(i) / 8;
    EXPECT_FLOAT_EQ(image.at(x, y, *image.channel("variance.G")), deviation * deviation / 4);
    const float shadowed = float(kPolygonLayers.plane(LAYER_SHADOWED)) + float(i) / 8,
                unshadowed = float(kPolygonLayers.plane(LAYER_UNSHADOWED)) + float(i) / 8;
    EXPECT_FLOAT_EQ(image.at(x, y, *image.channel("visibility.Y")), shadowed / unshadowed);
    EXPECT_EQ(image.at(x, y, *image.channel("samples.Y")), 5);
  }
}

TEST(FilmImage, HasAsManyChannelsAsItsMemoryIsCountedFor) {
  for (const std::uint64_t features : kLayerFeatures)
    for (const FilmLayers& layers : {FilmLayers(features), FilmLayers(features | FEATURE_COVERAGE)}) {
      const Image image = image_of_film(FilmAccumulator(0, 0, 2, 1, layers), 2, 1);
      EXPECT_EQ(image.channels.size(), std::size_t(image_channels(layers)));
      EXPECT_LE(image.values.size() * sizeof(float), 2 * pixel_memory(layers).output);
    }
}

TEST(FilmImage, AlphaFollowsTheColours) {
  for (const std::uint64_t features : kLayerFeatures) {
    const FilmLayers layers(features), with_alpha(features | FEATURE_COVERAGE);
    FilmAccumulator film(0, 0, 2, 1, with_alpha), without(0, 0, 2, 1, layers);
    SampleBuffer buffer = buffer_of(2, 1, with_alpha, 3);
    film.add(0, 0, buffer);
    buffer.planes = layers.planes();
    buffer.values.resize(buffer.values.size() - 2);
    without.add(0, 0, buffer);
    const Image image = image_of_film(film, 2, 1), rgb = image_of_film(without, 2, 1);
    std::vector<std::string> channels = rgb.channels;
    channels.insert(channels.begin() + 3, "A");
    EXPECT_EQ(image.channels, channels);
    for (int x = 0; x < 2; ++x) {
      EXPECT_EQ(image.at(x, 0, 3), float(layers.planes()) + float(x) / 8);
      for (const std::string& name : rgb.channels)
        EXPECT_EQ(image.at(x, 0, *image.channel(name)), rgb.at(x, 0, *rgb.channel(name))) << name;
    }
    EXPECT_EQ(image.chromaticities, kRec709);
  }
}

TEST(FilmImage, CountsPixelsWhoseVarianceNoFloatHolds) {
  FilmAccumulator film(0, 0, 3, 1, kNoLayers);
  SampleBuffer huge = buffer_of(3, 1, kNoLayers, 2);
  film.add(0, 0, huge);
  EXPECT_EQ(pixels_of_infinite_variance(film), 0u);
  huge.plane(kDeviationB)[1] = 3e37f;
  film.add(0, 0, huge);
  EXPECT_EQ(pixels_of_infinite_variance(film), 1u);
  EXPECT_TRUE(std::isfinite(film.at(1, 0).m2[2]));
}

TEST(FilmImage, HasNoFeatureLayersWithoutFeatures) {
  FilmAccumulator film(0, 0, 1, 1, kNoLayers);
  film.add(0, 0, buffer_of(1, 1, kNoLayers, 2));
  EXPECT_THAT(image_of_film(film, 1, 1).channels,
              ElementsAre("R", "G", "B", "variance.R", "variance.G", "variance.B", "samples.Y"));
}

TEST(FilmImage, WhatIsNotRenderedIsZeroWithCountZero) {
  FilmAccumulator film(0, 0, 2, 1, kNoLayers);
  film.add(1, 0, buffer_of(1, 1, kNoLayers, 1));
  const Image image = image_of_film(film, 2, 1);
  for (std::size_t c = 0; c < image.channels.size(); ++c) EXPECT_EQ(image.at(0, 0, c), 0);
  EXPECT_EQ(image.at(1, 0, *image.channel("samples.Y")), 1);
  EXPECT_EQ(image.at(1, 0, *image.channel("G")), 1);
  EXPECT_EQ(image.at(1, 0, *image.channel("variance.R")), 0) << "one sample has no variance";
}

TEST(SampleRange, OfAPartlyRenderedFilm) {
  FilmAccumulator film(0, 0, 2, 1, kNoLayers);
  EXPECT_EQ(sample_range(film).most, 0u);
  film.add(0, 0, buffer_of(1, 1, kNoLayers, 3));
  film.add(1, 0, buffer_of(1, 1, kNoLayers, 5));
  EXPECT_EQ(sample_range(film).least, 3u);
  EXPECT_EQ(sample_range(film).most, 5u);
  EXPECT_EQ(sample_range(film).total, 8u);
}

TEST(VarianceOfMean, ByHand) {
  // 1, 2, 3, 6: mean 3, M2 14, sample variance 14/3, of the mean 14/12.
  EXPECT_DOUBLE_EQ(variance_of_mean(4, 14), 14.0 / 12);
  EXPECT_EQ(variance_of_mean(1, 0), 0);
  EXPECT_EQ(variance_of_mean(0, 0), 0);
}

}  // namespace
}  // namespace penumbra
