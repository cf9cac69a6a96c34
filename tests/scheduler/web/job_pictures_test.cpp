// Tests the pictures of jobs that are being rendered, and of files.
#include "scheduler/web/job_pictures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <thread>

#include "scheduler/image/image_files.h"
#include "scheduler/image/tone_map.h"
#include "scheduler/web/film_picture.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::job_pictures_test {
namespace {

using namespace std::chrono_literals;

constexpr JobId kJob = 5;

std::shared_ptr<const TileSnapshot> tile_at(int x, int y, int width, int height,
                                            std::vector<float> radiance) {
  TileSnapshot tile;
  tile.x = x;
  tile.y = y;
  tile.width = width;
  tile.height = height;
  tile.samples = 1;
  tile.radiance = std::move(radiance);
  return std::make_shared<const TileSnapshot>(std::move(tile));
}

/// A film of 4 x 2 pixels at (10, 20) with a tile for each half.
class Render {
 public:
  Render() {
    WatchedJob job;
    job.x = 10;
    job.y = 20;
    job.width = 4;
    job.height = 2;
    board->describe(job);
    board->show_view({});
  }
  void show(std::uint32_t tile, float value) const {
    board->show_tile(tile, *tile_at(10 + 2 * int(tile), 20, 2, 2, std::vector<float>(12, value)));
  }
  /// As the farm does: all tiles, once somebody watches.
  void show_when_watched(float value) const {
    while (!board->is_watched()) std::this_thread::sleep_for(1ms);
    for (const std::uint32_t tile : {0u, 1u}) show(tile, value);
  }

  const std::shared_ptr<WatchBoard> board = std::make_shared<WatchBoard>(2);
};

Image rgb_image(int width, int height) {
  Image image;
  image.data = image.display = {0, 0, width, height};
  image.channels = {"R", "G", "B"};
  return image;
}

Image decoded(const std::string& png) {
  const TemporaryFolder folder;
  write_text(folder / "a.png", png);
  const auto image = read_image(folder / "a.png");
  EXPECT_TRUE(image) << image.error().message;
  return image ? *image : Image{};
}

TEST(FilmPicture, PixelsAreThoseOfAPngAndWhatIsMissingIsTransparent) {
  const auto tile = tile_at(12, 20, 1, 1, {0.25f, 2, -1});
  const auto png = picture_of_film({.x = 10, .y = 20, .width = 3, .height = 1, .tiles = {tile}}, 100);
  ASSERT_TRUE(png);
  const Image image = decoded(*png);
  EXPECT_EQ(image.data.width, 3);
  EXPECT_EQ(image.data.height, 1);
  EXPECT_EQ(image.at(0, 0, 3), 0);
  EXPECT_EQ(image.at(2, 0, 3), 1);
  EXPECT_FLOAT_EQ(image.at(2, 0, 0), float(display_byte(0.25f)) / 255);
  EXPECT_EQ(image.at(2, 0, 1), 1);
  EXPECT_EQ(image.at(2, 0, 2), 0);
}

TEST(FilmPicture, SmallPicturesAreMeansInLinearLight) {
  Image image = rgb_image(4, 2);
  for (int i = 0; i < 8; ++i) image.values.insert(image.values.end(), 3, i % 2 == 0 ? 0.0f : 1.0f);
  const auto png = picture_of_image(image, 2);
  ASSERT_TRUE(png);
  const Image small = decoded(*png);
  EXPECT_EQ(small.data.width, 2);
  EXPECT_EQ(small.data.height, 1);
  EXPECT_NEAR(small.at(0, 0, 0), float(display_byte(0.5f)) / 255, 1e-6);
}

TEST(FilmPicture, NotANumberIsBlackAndOddSizesAreFine) {
  for (const int side : {1, 2, 3, 7, 1000})
    for (const int width : {1, 5, 999}) {
      std::vector<float> radiance(std::size_t(3 * width), std::nanf(""));
      const auto tile = tile_at(0, 0, width, 1, std::move(radiance));
      const auto png = picture_of_film({.width = width, .height = 1, .tiles = {tile}}, side);
      ASSERT_TRUE(png) << side << " " << width;
      EXPECT_EQ(decoded(*png).data.width, std::min(side, width));
    }
}

TEST(JobPictures, AFilmIsWatchedWhileItsPictureIsAskedFor) {
  Render render;
  JobPictures pictures;
  EXPECT_FALSE(pictures.of_film(kJob, 256));
  pictures.films().add(kJob, render.board);
  EXPECT_FALSE(render.board->is_watched());
  std::thread farm([&] { render.show_when_watched(1); });
  const auto picture = pictures.of_film(kJob, 256);
  farm.join();
  ASSERT_TRUE(picture);
  EXPECT_EQ(decoded(*picture->png).at(3, 1, 0), 1);
  const auto same = pictures.of_film(kJob, 256);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->tag, picture->tag);
  EXPECT_EQ(same->png, picture->png) << "made once";
  render.show(1, 0);
  std::optional<WebPicture> newer = picture;
  for (int i = 0; i < 6000 && newer->tag == picture->tag; ++i) {
    std::this_thread::sleep_for(10ms);
    newer = pictures.of_film(kJob, 256);
    ASSERT_TRUE(newer);
  }
  EXPECT_EQ(decoded(*newer->png).at(3, 1, 0), 0);
  EXPECT_EQ(decoded(*newer->png).at(0, 0, 0), 1);
}

TEST(JobPictures, TheEndOfAJobIsNotDelayed) {
  Render render;
  JobPictures pictures;
  pictures.films().add(kJob, render.board);
  std::thread farm([&] { render.show_when_watched(1); });
  EXPECT_TRUE(pictures.of_film(kJob, 256));
  farm.join();
  render.board->close();
  render.board->wait_for_watchers(60s);  // until all is read
  for (int i = 0; i < 6000 && render.board->is_watched(); ++i) std::this_thread::sleep_for(10ms);
  EXPECT_FALSE(render.board->is_watched());
  EXPECT_TRUE(pictures.of_film(kJob, 256)) << "the last state stays until its file is written";
  pictures.films().remove(kJob);
  EXPECT_FALSE(pictures.of_film(kJob, 256));
}

TEST(JobPictures, AJobThatBeginsAgainHasANewFilm) {
  Render first, second;
  JobPictures pictures;
  pictures.films().add(kJob, first.board);
  std::thread farm([&] { first.show_when_watched(1); });
  EXPECT_TRUE(pictures.of_film(kJob, 64));
  farm.join();
  pictures.films().add(kJob, second.board);
  EXPECT_FALSE(first.board->is_watched());
  std::thread again([&] { second.show_when_watched(0); });
  EXPECT_TRUE(pictures.of_film(kJob, 128));
  again.join();
}

TEST(JobPictures, OfFiles) {
  const TemporaryFolder folder;
  Image image = rgb_image(600, 300);
  image.values.assign(3 * image.pixels(), 0.5f);
  const auto exr = encode_exr(image);
  ASSERT_TRUE(exr);
  write_text(folder / "a.exr", {reinterpret_cast<const char*>(exr->data()), exr->size()});
  write_text(folder / "bad.exr", "not an image");
  JobPictures pictures;
  EXPECT_FALSE(pictures.of_file(kJob, folder / "bad.exr", 256));
  EXPECT_FALSE(pictures.of_file(kJob, folder / "none.exr", 256));
  const auto picture = pictures.of_file(kJob, folder / "a.exr", 256);
  ASSERT_TRUE(picture);
  const Image small = decoded(*picture->png);
  EXPECT_EQ(small.data.width, 256);
  EXPECT_EQ(small.data.height, 128);
  EXPECT_NEAR(small.at(9, 9, 1), float(display_byte(0.5f)) / 255, 1e-6);
  const auto large = pictures.of_file(kJob, folder / "a.exr", 2048);
  ASSERT_TRUE(large);
  EXPECT_EQ(decoded(*large->png).data.width, 600) << "not enlarged";
}

}  // namespace
}  // namespace penumbra::job_pictures_test
