#include "scheduler/web/job_pictures.h"

#include <fmt/format.h>

#include <limits>

#include "scheduler/web/film_picture.h"
#include "worker/keys/secrets.h"

namespace penumbra {
namespace {

constexpr std::chrono::milliseconds kLongestWait{2000};  // for the first tiles
constexpr std::chrono::milliseconds kPictureInterval{1000};
constexpr std::size_t kMostBytes = std::size_t(64) << 20;                     // of pictures that are kept
constexpr std::uint64_t kLargestImage = std::uint64_t(1) << 30;               // bytes in memory
constexpr std::uint64_t kStored = std::numeric_limits<std::uint64_t>::max();  // the version of files

}  // namespace

JobPictures::JobPictures() : run_(make_token().substr(0, 8)) {}

std::optional<JobPictures::Kept> JobPictures::find(const Key& key) {
  const std::lock_guard lock(mutex_);
  const auto found = kept_.find(key);
  if (found == kept_.end()) return {};
  last_used_.splice(last_used_.begin(), last_used_, found->second.place);
  return found->second;
}

WebPicture JobPictures::keep(const Key& key, std::uint64_t version, std::string png) {
  const std::lock_guard lock(mutex_);
  if (const auto old = kept_.find(key); old != kept_.end()) {
    bytes_ -= old->second.picture.png->size();
    last_used_.erase(old->second.place);
    kept_.erase(old);
  }
  bytes_ += png.size();
  last_used_.push_front(key);
  while (bytes_ > kMostBytes && last_used_.size() > 1) {
    const auto oldest = kept_.find(last_used_.back());
    bytes_ -= oldest->second.picture.png->size();
    kept_.erase(oldest);
    last_used_.pop_back();
  }
  WebPicture picture{std::make_shared<const std::string>(std::move(png)),
                     fmt::format("{}-{}-{}-{}", run_, key.first, key.second, version)};
  kept_.emplace(key, Kept{version, picture, Clock::now(), last_used_.begin()});
  return picture;
}

std::optional<WebPicture> JobPictures::of_film(JobId job, int largest_side) {
  const Key key{job, largest_side};
  const std::optional<LiveFilm> film = films_.film(job, kLongestWait);
  if (!film) return {};
  const std::lock_guard one_at_a_time(making_film_);
  if (const std::optional<Kept> kept = find(key))
    if (kept->version == film->version || Clock::now() - kept->made < kPictureInterval) return kept->picture;
  auto png = picture_of_film(*film, largest_side);
  if (!png) return {};
  return keep(key, film->version, std::move(*png));
}

std::optional<WebPicture> JobPictures::of_file(JobId job, const std::filesystem::path& file,
                                               int largest_side) {
  const Key key{job, largest_side};
  const std::lock_guard one_at_a_time(reading_file_);
  if (const std::optional<Kept> kept = find(key); kept && kept->version == kStored) return kept->picture;
  const auto header = read_image_header(file);
  if (!header || header->pixels() * header->channels.size() * sizeof(float) > kLargestImage) return {};
  const auto image = read_image(file);
  if (!image) return {};
  auto png = picture_of_image(*image, largest_side);
  if (!png) return {};
  return keep(key, kStored, std::move(*png));
}

}  // namespace penumbra
