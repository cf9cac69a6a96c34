// The message about an image that differs from the record.
#include "tests/acceptance/film_record.h"
#include "tests/support/film_layers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace penumbra {
namespace {

using ::testing::HasSubstr;

/// 6 x 6 pixels of 4 samples: radiance 1 without noise, but for one pixel.
FilmAccumulator film_with(int x, int y, float radiance) {
  SampleBuffer samples;
  samples.width = samples.height = 6;
  samples.sample_count = 4;
  samples.planes = kNoLayers.planes();
  samples.values.assign(std::size_t(samples.planes) * samples.pixels(), 0);
  for (const int plane : {kMeanR, kMeanG, kMeanB}) {
    for (float& value : samples.plane(plane)) value = 1;
    samples.plane(plane)[std::size_t(y * 6 + x)] = radiance;
  }
  FilmAccumulator film(0, 0, 6, 6, kNoLayers);
  film.add(0, 0, samples);
  return film;
}

TEST(FilmRecordText, SaysHowFarAndWhere) {
  const RecordedFilm before = record_film(film_with(0, 0, 1)), now = record_film(film_with(4, 3, 2));
  EXPECT_NE(before.hash, now.hash);
  const std::string text = difference_text(now.picture, before.picture, 6, 6);
  EXPECT_THAT(text, HasSubstr("mean luminance 1.02778 instead of 1 (+2.78 %, both without noise)"));
  EXPECT_THAT(text, HasSubstr("pixels 4..5 x 2..3: 1.25 instead of 1 (+25 %"));
}

TEST(FilmRecordText, CountsInStandardErrors) {
  FilmThumbnail before{std::vector<double>(9, 1.0), std::vector<double>(9, 0.3)}, now = before;
  now.mean[8] += 2;
  now.error[8] = 0.4;
  EXPECT_THAT(difference_text(now, before, 20, 15),
              HasSubstr("most different in pixels 13..19 x 10..14: 3 instead of 1 (+200 %, z = 4)"));
}

TEST(FilmRecordText, KnowsWhatIsNoImage) {
  EXPECT_EQ(difference_text({}, record_film(film_with(0, 0, 1)).picture, 6, 6), "one of the two is no image");
}

TEST(FilmRecordFile, IsReadAsItWasWritten) {
  const auto file = std::filesystem::path(testing::TempDir()) / "film_record_test.json";
  const FilmRecord written{{"a \"b\"", record_film(film_with(0, 0, 1.5f))}, {"c", {"refused", {}}}};
  write_film_record(file, written);
  const FilmRecord read = read_film_record(file);
  std::filesystem::remove(file);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read.at("c").hash, "refused");
  EXPECT_TRUE(read.at("c").picture.mean.empty());
  EXPECT_EQ(read.at("a \"b\"").hash, written.at("a \"b\"").hash);
  EXPECT_EQ(read.at("a \"b\"").picture.mean, (std::vector<double>{1.125, 1, 1, 1, 1, 1, 1, 1, 1}));
}

}  // namespace
}  // namespace penumbra
