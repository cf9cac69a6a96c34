#include "gl/shot_player.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "scheduler/render/frames.h"

namespace penumbra {
namespace {

constexpr std::size_t kReadAhead = 256;  // frames that are read before they are shown, if there is memory
constexpr int kReadAround = 4;           // on both sides of a frame at which the shot stands

int reading_threads() { return std::clamp(int(std::thread::hardware_concurrency()) / 2, 1, 4); }

double seconds_between(ShotPlayer::Clock::time_point a, ShotPlayer::Clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

/// The number in a metadata entry; 0 if there is none.
double number_of(const Image& image, std::string_view name) {
  const auto value = image.attribute(name);
  if (!value) return 0;
  if (const auto* text = std::get_if<std::string>(&*value)) return std::atof(text->c_str());
  return std::visit(
      [](const auto& number) {
        if constexpr (std::is_arithmetic_v<std::decay_t<decltype(number)>>) return double(number);
        return 0.0;
      },
      *value);
}

}  // namespace

FramePicture read_frame(const std::filesystem::path& file, const std::vector<std::string>& layers,
                        bool whole) {
  FramePicture frame;
  frame.is_whole = whole;
  const Expected<Image> image = read_linear_image(file);
  if (!image) {
    frame.error = image.error().message;
    frame.is_whole = true;  // reading it once more would not help
    return frame;
  }
  frame.picture = layers_of(*image, file.string());
  for (const PictureLayer& layer : frame.picture.layers) frame.layer_names.push_back(layer.name);
  if (!whole)
    std::erase_if(frame.picture.layers, [&](const PictureLayer& layer) {
      return std::ranges::find(layers, layer.name) == layers.end();
    });
  frame.is_whole = frame.picture.layers.size() == frame.layer_names.size();
  frame.integrator = metadata_text(*image, "penumbra:integrator");
  if (const double fps = number_of(*image, "penumbra:fps"); fps > 0) frame.fps = fps;
  return frame;
}

ShotPlayer::ShotPlayer(FrameFiles files, const ShotOptions& options, std::function<void()> wake)
    : files_(std::move(files)),
      wake_(std::move(wake)),
      given_fps_(options.fps),
      cache_(
          [this, read = options.read ? options.read : read_frame](const FrameWish& wish) {
            std::vector<std::string> layers;
            {
              const std::lock_guard lock(mutex_);
              layers = layers_;
            }
            return read(files_.file(wish.frame), layers, wish.whole);
          },
          wake_, options.most_bytes, reading_threads()) {
  status_.fps = given_fps_.value_or(kFramesPerSecond);
  new_listing_ = list_shot(files_);
  take_listing();
  const auto first = with_file_up_to(0);
  status_.current = options.first ? *options.first : first ? listing_[*first].number : 0;
  want_around();
  looker_ = std::jthread([this, last = listing_](const std::stop_token& stop) { look(stop, last); });
}

ShotPlayer::~ShotPlayer() {
  looker_.request_stop();
  look_now_.notify_all();
}

// --- The folder

void ShotPlayer::look(const std::stop_token& stop, std::vector<ListedFrame> last) {
  while (!stop.stop_requested()) {
    {
      std::unique_lock lock(mutex_);
      look_now_.wait_for(lock, stop, kBetweenFolderLooks, [this] { return wants_look_; });
      wants_look_ = false;
    }
    if (stop.stop_requested()) return;
    std::vector<ListedFrame> listing = list_shot(files_);
    if (listing == last) continue;
    last = listing;
    {
      const std::lock_guard lock(mutex_);
      new_listing_ = std::move(listing);
    }
    wake_();
  }
}

/// Returns whether there was a new one.
bool ShotPlayer::take_listing() {
  std::optional<std::vector<ListedFrame>> taken;
  {
    const std::lock_guard lock(mutex_);
    taken = std::exchange(new_listing_, {});
  }
  if (!taken) return false;
  std::map<int, FileStamp> before;
  for (const ListedFrame& frame : listing_)
    if (frame.has_file) before[frame.number] = frame.stamp;
  listing_ = std::move(*taken);
  status_.frames.clear();
  for (const ListedFrame& frame : listing_) {
    status_.frames.push_back({frame.number, frame.state, frame.has_file, false});
    const auto found = before.find(frame.number);
    if (found == before.end()) continue;
    if (!frame.has_file || found->second != frame.stamp) cache_.forget(frame.number);
    before.erase(found);
  }
  for (const auto& [number, stamp] : before) cache_.forget(number);
  return true;
}

// --- Time

int ShotPlayer::span() const {
  const int step = listing_.size() > 1 ? listing_[1].number - listing_[0].number : 1;
  return listing_.back().number - listing_.front().number + step;
}

double ShotPlayer::frames_played(Clock::time_point now) const {
  return std::max(0.0, seconds_between(began_, now)) * status_.fps;
}

int ShotPlayer::number_at(Clock::time_point now) const {
  const int first = listing_.front().number;
  const auto played = std::int64_t(std::floor(frames_played(now) + 1e-6));
  const std::int64_t from_first = began_at_ - first + played;
  return first + int((from_first % span() + span()) % span());
}

std::optional<double> ShotPlayer::seconds_to_next(Clock::time_point now) const {
  if (!status_.plays || listing_.empty()) return std::nullopt;
  const double played = frames_played(now);
  return std::max(0.0, (std::floor(played + 1e-6) + 1 - played) / status_.fps);
}

std::optional<std::size_t> ShotPlayer::with_file_up_to(int number) const {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < listing_.size(); ++i) {
    if (!listing_[i].has_file) continue;
    if (found && listing_[i].number > number) break;
    found = i;
  }
  return found;
}

std::size_t ShotPlayer::index_of_current() const {
  const auto at = std::ranges::lower_bound(listing_, status_.current, {}, &ListedFrame::number);
  return std::min(std::size_t(at - listing_.begin()), listing_.empty() ? 0 : listing_.size() - 1);
}

// --- What is to be read

void ShotPlayer::want_from(std::size_t index) {
  std::vector<FrameWish> wishes;
  for (std::size_t i = 0; i < listing_.size() && wishes.size() < kReadAhead; ++i)
    if (const ListedFrame& frame = listing_[(index + i) % listing_.size()]; frame.has_file)
      wishes.push_back({frame.number, false});
  cache_.want(std::move(wishes));
}

void ShotPlayer::want_around() {
  std::vector<FrameWish> wishes;
  if (const auto at = with_file_up_to(status_.current)) {
    wishes.push_back({listing_[*at].number, true});
    for (int away = 1; away <= kReadAround; ++away)
      for (const int side : {away, -away}) {
        const auto i = std::ptrdiff_t(*at) + side;
        if (i >= 0 && i < std::ptrdiff_t(listing_.size()) && listing_[std::size_t(i)].has_file)
          wishes.push_back({listing_[std::size_t(i)].number, false});
      }
  }
  cache_.want(std::move(wishes));
}

// --- What is shown

std::shared_ptr<const FramePicture> ShotPlayer::show(int frame, std::shared_ptr<const FramePicture> read) {
  if (read == shown_ && status_.shown == frame) return nullptr;
  if (read->error.empty() && !given_fps_ && read->fps > 0 && read->fps != status_.fps) {
    status_.fps = read->fps;
    changed_ = true;
  }
  status_.shown = frame;
  shown_ = read;
  changed_ = true;
  ++shown_this_second_;
  return read;
}

std::shared_ptr<const FramePicture> ShotPlayer::play_on(Clock::time_point now) {
  const auto after = std::ranges::upper_bound(listing_, number_at(now), {}, &ListedFrame::number);
  const int number = after == listing_.begin() ? listing_.front().number : std::prev(after)->number;
  if (number != status_.current) changed_ = true;
  status_.current = number;
  const auto target = with_file_up_to(number);
  if (!target) return nullptr;
  want_from(*target);
  const auto order = [&](int frame) {  // how many numbers after that which is shown
    const int from = status_.shown.value_or(began_at_);
    return ((frame - from) % span() + span()) % span();
  };
  // The latest that has been read: where reading is slower than time, frames are left out.
  const int most = order(listing_[*target].number);
  std::optional<int> latest;
  std::uint64_t passed = 0;
  for (std::size_t i = 0; i < listing_.size(); ++i) {
    const ListedFrame& frame = listing_[(*target + listing_.size() - i) % listing_.size()];
    const int place = order(frame.number);
    if (place > most || (place == 0 && shown_ != nullptr)) break;
    if (!frame.has_file) continue;
    if (latest)
      ++passed;
    else if (cache_.has(frame.number))
      latest = frame.number;
  }
  if (!latest) return nullptr;
  if (passed > 0 && shown_ != nullptr) {
    status_.skipped += passed;
    changed_ = true;
  }
  auto read = cache_.get(*latest);
  return read == nullptr ? nullptr : show(*latest, std::move(read));
}

std::shared_ptr<const FramePicture> ShotPlayer::stand() {
  const auto at = with_file_up_to(status_.current);
  if (!at) return nullptr;
  auto read = cache_.get(listing_[*at].number);
  return read == nullptr ? nullptr : show(listing_[*at].number, std::move(read));
}

void ShotPlayer::note_read() {
  const std::vector<int> there = cache_.there();
  for (ShotFrame& frame : status_.frames) {
    const bool is_read = frame.has_file && std::ranges::binary_search(there, frame.number);
    if (is_read != frame.is_read) changed_ = true;
    frame.is_read = is_read;
  }
}

std::shared_ptr<const FramePicture> ShotPlayer::update(Clock::time_point now) {
  if (take_listing()) {
    changed_ = true;
    if (status_.plays) {  // what is first and last may be others
      began_at_ = status_.current;
      began_ = now;
    } else {
      if (!shown_ && with_file_up_to(0)) status_.current = listing_[*with_file_up_to(status_.current)].number;
      want_around();
    }
  }
  if (listing_.empty()) return nullptr;
  if (const double seconds = seconds_between(second_began_, now); status_.plays && seconds >= 1) {
    status_.shown_per_second = shown_this_second_ / seconds;
    second_began_ = now;
    shown_this_second_ = 0;
    changed_ = true;
  }
  auto picture = status_.plays ? play_on(now) : stand();
  note_read();
  return picture;
}

// --- The user

void ShotPlayer::play(bool plays, Clock::time_point now) {
  if (plays == status_.plays) return;
  status_.plays = plays;
  changed_ = true;
  began_ = second_began_ = now;
  began_at_ = status_.current;
  shown_this_second_ = 0;
  status_.skipped = 0;
  status_.shown_per_second = 0;
  if (!plays) want_around();
}

void ShotPlayer::go_to(int number) {
  status_.plays = false;
  status_.current = number;
  changed_ = true;
  want_around();
}

void ShotPlayer::step(int by) {
  if (listing_.empty()) return;
  const auto to = std::clamp(std::ptrdiff_t(index_of_current()) + by, std::ptrdiff_t(0),
                             std::ptrdiff_t(listing_.size()) - 1);
  go_to(listing_[std::size_t(to)].number);
}

void ShotPlayer::go_to_first() {
  if (!listing_.empty()) go_to(listing_.front().number);
}

void ShotPlayer::go_to_last() {
  if (!listing_.empty()) go_to(listing_.back().number);
}

void ShotPlayer::set_layers(std::vector<std::string> layers) {
  {
    const std::lock_guard lock(mutex_);
    if (layers == layers_) return;
    const bool has_more = !std::ranges::all_of(
        layers, [&](const std::string& name) { return std::ranges::find(layers_, name) != layers_.end(); });
    layers_ = std::move(layers);
    if (!has_more) return;
  }
  cache_.forget_all();
  if (!status_.plays) want_around();
}

void ShotPlayer::reload() {
  cache_.forget_all();
  if (!status_.plays) want_around();
  {
    const std::lock_guard lock(mutex_);
    wants_look_ = true;
  }
  look_now_.notify_all();
}

}  // namespace penumbra
