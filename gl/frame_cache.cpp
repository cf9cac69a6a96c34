#include "gl/frame_cache.h"

#include <algorithm>

namespace penumbra {

std::size_t FramePicture::bytes() const {
  std::size_t bytes = sizeof *this;
  for (const PictureLayer& layer : picture.layers) bytes += layer.values.size() * sizeof(float);
  return bytes;
}

FrameCache::FrameCache(Read read, std::function<void()> news, std::size_t most_bytes, int threads)
    : read_(std::move(read)), news_(std::move(news)), most_bytes_(most_bytes) {
  for (int i = 0; i < threads; ++i)
    threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
}

FrameCache::~FrameCache() {
  for (std::jthread& thread : threads_) thread.request_stop();
  changed_.notify_all();
}

void FrameCache::want(std::vector<FrameWish> wishes) {
  {
    const std::lock_guard lock(mutex_);
    wishes_ = std::move(wishes);
  }
  changed_.notify_all();
}

std::shared_ptr<const FramePicture> FrameCache::get(int frame) {
  const std::lock_guard lock(mutex_);
  const auto found = kept_.find(frame);
  if (found == kept_.end()) return nullptr;
  found->second.used = ++uses_;
  return found->second.picture;
}

bool FrameCache::has(int frame) const {
  const std::lock_guard lock(mutex_);
  return kept_.contains(frame);
}

std::vector<int> FrameCache::there() const {
  const std::lock_guard lock(mutex_);
  std::vector<int> frames;
  for (const auto& [frame, kept] : kept_) frames.push_back(frame);
  return frames;
}

void FrameCache::forget(int frame) {
  const std::lock_guard lock(mutex_);
  if (const auto found = kept_.find(frame); found != kept_.end()) {
    bytes_ -= found->second.bytes;
    kept_.erase(found);
  }
  if (const auto reading = being_read_.find(frame); reading != being_read_.end()) reading->second = false;
}

void FrameCache::forget_all() {
  const std::lock_guard lock(mutex_);
  kept_.clear();
  bytes_ = usual_bytes_ = 0;
  for (auto& [frame, counts] : being_read_) counts = false;
}

std::size_t FrameCache::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

const FrameWish* FrameCache::next_wish() const {
  std::size_t taken = 0;
  for (const FrameWish& wish : wishes_) {
    const auto found = kept_.find(wish.frame);
    const bool is_there = found != kept_.end();
    if (is_there && (!wish.whole || found->second.picture->is_whole)) {
      taken += found->second.bytes;
    } else if (being_read_.contains(wish.frame)) {
      taken += usual_bytes_;
    } else {
      const bool fits = &wish == &wishes_.front() || taken + usual_bytes_ <= most_bytes_;
      return fits ? &wish : nullptr;
    }
  }
  return nullptr;
}

void FrameCache::make_room() {
  while (bytes_ > most_bytes_ && kept_.size() > 1) {
    // The place among the wishes; those that are not wished for are behind all.
    const auto urgency = [this](int frame) {
      return std::ranges::find(wishes_, frame, &FrameWish::frame) - wishes_.begin();
    };
    const auto least = std::ranges::max_element(kept_, {}, [&](const auto& kept) {
      const auto place = urgency(kept.first);
      const bool is_wished = place < std::ptrdiff_t(wishes_.size());
      return std::pair(place, is_wished ? 0 : ~kept.second.used);
    });
    if (urgency(least->first) == 0 && !wishes_.empty()) return;
    bytes_ -= least->second.bytes;
    kept_.erase(least);
  }
}

void FrameCache::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return next_wish() != nullptr; })) {
    const FrameWish wish = *next_wish();
    being_read_[wish.frame] = true;
    lock.unlock();
    FramePicture picture;
    try {
      picture = read_(wish);
    } catch (const std::exception& error) {  // usually out of memory
      picture.error = error.what();
      picture.is_whole = true;
    }
    const std::size_t bytes = picture.bytes();
    auto shared = std::make_shared<const FramePicture>(std::move(picture));
    lock.lock();
    const bool counts = being_read_.extract(wish.frame).mapped();
    if (counts) {
      Kept& kept = kept_[wish.frame];
      bytes_ += bytes - kept.bytes;
      kept = {std::move(shared), bytes, ++uses_};
      if (!wish.whole || usual_bytes_ == 0) usual_bytes_ = std::max(usual_bytes_, bytes);
      make_room();
    }
    lock.unlock();
    news_();
    changed_.notify_all();
    lock.lock();
  }
}

}  // namespace penumbra
