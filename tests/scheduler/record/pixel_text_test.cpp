#include "scheduler/record/pixel_text.h"
#include "tests/support/film_layers.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

TEST(PixelText, ShowsEveryDigitAndTheExactBits) {
  SampleBuffer buffer;
  buffer.width = buffer.height = 1;
  buffer.sample_count = 5;
  buffer.planes = kFeatureLayers.planes();
  buffer.values = {0.1f, 0.5f, 2, 0, 2, 4, 0.25f, 0.5f, 0.75f, 0, 0, -1, 3};
  FilmAccumulator film(5, 6, 1, 1, kFeatureLayers);
  film.add(5, 6, buffer);
  EXPECT_EQ(pixel_text(film, 5, 6),
            "pixel 5,6  5 samples\n"
            "radiance              0.100000001              0.5                2\n"
            "  exactly           0x1.99999ap-4           0x1p-1           0x1p+1\n"
            "standard error                  0                1                2\n"
            "albedo                       0.25              0.5             0.75\n"
            "normal                          0                0               -1\n"
            "depth                           3\n");
}

TEST(PixelText, ShowsAlphaWhereThereIsOne) {
  for (const std::uint64_t features :
       {std::uint64_t(0), std::uint64_t(FEATURE_LAYERS), std::uint64_t(FEATURE_LAYERS | FEATURE_POLYGONS)}) {
    const FilmLayers layers(features | FEATURE_COVERAGE);
    FilmAccumulator film(0, 0, 1, 1, layers);
    SampleBuffer buffer{.width = 1, .height = 1, .planes = layers.planes(), .sample_count = 2, .values = {}};
    buffer.values.resize(std::size_t(layers.planes()));
    buffer.values.back() = 0.75f;
    film.add(0, 0, buffer);
    const std::string text = pixel_text(film, 0, 0);
    EXPECT_NE(text.find("alpha                        0.75\n"), std::string::npos) << text;
    EXPECT_EQ(text.find("albedo") != std::string::npos, layers.has(LAYER_ALBEDO));
    EXPECT_EQ(text.find("visibility") != std::string::npos, layers.has(LAYER_ANALYTIC));
  }
}

}  // namespace
}  // namespace penumbra
