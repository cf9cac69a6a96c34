#include "scheduler/watch/watch_client.h"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "scheduler/watch/watch_wire.h"
#include "worker/keys/tcp_address.h"
#include "worker/keys/unreachable.h"
#include "worker/protocol/client.h"
#include "worker/protocol/text.h"
#include "worker/protocol/wire.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;

// Limit of queued news. Above it reading pauses, and the scheduler keeps only the newest state.
constexpr std::size_t kMostItems = 256;
constexpr auto kTimeToAnswer = 5s;
constexpr auto kRetryInterval = 200ms;
constexpr int kAttemptsToExplain = 10;
constexpr auto kTimeToExplain = 1000ms;

/// Whether trying again would fail in the same way.
bool is_final(grpc::StatusCode code) {
  return code == grpc::StatusCode::UNAUTHENTICATED || code == grpc::StatusCode::PERMISSION_DENIED ||
         code == grpc::StatusCode::FAILED_PRECONDITION || code == grpc::StatusCode::UNIMPLEMENTED;
}

}  // namespace

WatchClient::WatchClient(std::string address, std::string token, std::shared_ptr<const Keys> keys, JobId job,
                         std::function<void()> on_news, bool is_starting)
    : address_(std::move(address)),
      token_(std::move(token)),
      keys_(std::move(keys)),
      wanted_job_(job),
      on_news_(std::move(on_news)),
      is_starting_(is_starting),
      channel_(open_channel(address_, keys_.get())),
      reader_([this] { read(); }),
      sender_([this] { send(); }) {}

WatchClient::~WatchClient() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    if (reading_ != nullptr) reading_->TryCancel();
    if (fetching_ != nullptr) fetching_->cancel();
    if (sending_ != nullptr) sending_->TryCancel();
  }
  changed_.notify_all();
  reader_.join();
  sender_.join();
}

// --- Reading

/// Reports why there is no connection, each reason once in a row.
void WatchClient::explain_absence() {
  if (is_starting_) return;
  const std::string why = why_unreachable(address_, keys_.get(), kTimeToExplain);
  if (why.empty() || why == said_absence_) return;
  said_absence_ = why;
  put(watch_news::Said{fmt::format("no scheduler at {}: {}; trying again", address_, why)});
}

void WatchClient::read() {
  const auto stub = wire::Farm::NewStub(channel_);
  for (;;) {
    for (int attempts = 1; !channel_->WaitForConnected(std::chrono::system_clock::now() + kRetryInterval);
         ++attempts) {
      {
        const std::lock_guard lock(mutex_);
        if (stopping_) return;
      }
      if (attempts % kAttemptsToExplain == 1) explain_absence();
    }
    grpc::ClientContext context;
    show_token(context, token_);
    {
      const std::lock_guard lock(mutex_);
      if (stopping_) return;
      reading_ = &context;
    }
    watch(*stub, context);
    const std::lock_guard lock(mutex_);
    reading_ = nullptr;
    if (stopping_ || over_) return;
  }
}

void WatchClient::watch(wire::Farm::Stub& stub, grpc::ClientContext& context) {
  wire::WatchRequest request;
  request.set_protocol_version(kProtocolVersion);
  request.set_job(wanted_job_);
  const auto reader = stub.Watch(&context, request);
  std::optional<WatchedJob> job;
  std::optional<Error> scene_error;
  wire::WatchEvent event;
  bool goes_on = true;
  while (goes_on && reader->Read(&event)) goes_on = receive(stub, event, job, scene_error);
  if (!goes_on) context.TryCancel();
  const grpc::Status status = reader->Finish();
  if (!goes_on) return;
  // A job requested by its number that does not exist will not come. Without a number, one may still start.
  const bool is_gone = wanted_job_ != 0 && status.error_code() == grpc::StatusCode::NOT_FOUND;
  if (is_final(status.error_code()) || is_gone) {
    put(watch_news::Refused{status_text(status)});
  } else {
    put(watch_news::Lost{status.ok() ? "the scheduler ended" : status_text(status)});
    pause();
  }
}

/// Returns false if nothing more is to be read.
bool WatchClient::receive(wire::Farm::Stub& stub, const wire::WatchEvent& event,
                          std::optional<WatchedJob>& job, std::optional<Error>& scene_error) {
  const auto refuse = [this](std::string why) {
    put(watch_news::Refused{std::move(why)});
    return false;
  };
  // The connection was not lost during the transfer of the scene.
  if (scene_error) return refuse(scene_error->message);
  if (event.has_refused()) return refuse(event.refused().reason());
  if (event.has_job()) {
    Expected<WatchedJob> described = decode(event.job());
    if (!described) return refuse(described.error().message);
    watch_news::Connected connected{*described, nullptr};
    if (described->interactive || described->hybrid) {
      Expected<DeviceScene> scene = fetch(stub, described->scene_hash);
      if (!scene) {
        scene_error = scene.error();
        return true;
      }
      connected.scene = std::make_shared<const DeviceScene>(std::move(*scene));
    }
    job = std::move(*described);
    {
      const std::lock_guard lock(mutex_);
      ++connection_;
      job_ = job->id;
      newest_view_ = wanted_spp_ = sent_spp_ = 0;
      wanted_layers_.clear();
      own_view_.reset();
    }
    put(std::move(connected));
    return true;
  }
  if (!job) return refuse("the scheduler did not describe its job");
  if (event.has_view()) {
    const Expected<WatchView> view = decode(event.view());
    if (!view) return refuse(view.error().message);
    put(*view, view->number);
  } else if (event.has_tile()) {
    Expected<TileSnapshot> tile = decode(event.tile(), *job);
    if (!tile) return refuse(tile.error().message);
    const std::uint32_t number = tile->view;
    put(std::move(*tile), number);
  } else if (event.has_progress()) {
    const bool ended = event.progress().ended();
    put(decode(event.progress()), event.progress().view());
    // Tiles may still follow. The end of the stream then means that the connection was not lost.
    if (ended) {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
  } else if (event.content_case() == wire::WatchEvent::kMessage) {
    put(watch_news::Said{wire_text(event.message(), kLongestText)});
  }
  return true;
}

Expected<DeviceScene> WatchClient::fetch(wire::Farm::Stub& stub, const std::string& hash) {
  SceneFetch fetching(stub, token_);
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return fail("");
    fetching_ = &fetching;
  }
  Expected<FetchedScene> fetched = fetching.fetch(hash);
  const std::lock_guard lock(mutex_);
  fetching_ = nullptr;
  if (!fetched) return std::unexpected(fetched.error());
  return std::move(fetched->scene);
}

void WatchClient::put(WatchNews news, std::optional<std::uint32_t> view) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return stopping_ || items_.size() < kMostItems; });
  if (std::holds_alternative<watch_news::Refused>(news)) over_ = true;
  if (over_ && std::holds_alternative<watch_news::Lost>(news)) news = watch_news::Ended{};
  items_.push_back({view, connection_, std::move(news)});
  lock.unlock();
  if (on_news_) on_news_();
}

void WatchClient::pause() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kRetryInterval, [this] { return stopping_ || over_; });
}

std::vector<WatchNews> WatchClient::take() {
  std::vector<WatchNews> news;
  {
    const std::lock_guard lock(mutex_);
    while (!items_.empty()) {
      Item& item = items_.front();
      const bool is_of_lost = item.connection != connection_;
      // Whether the news belong to the requested view is known only when that has a number.
      if (!is_of_lost && view_on_its_way_ && item.view && *item.view > newest_view_) break;
      const bool is_view = std::holds_alternative<WatchView>(item.news);
      const bool is_known = item.view && (is_of_lost || view_on_its_way_ || *item.view < newest_view_);
      if (!is_known) {
        // Another viewer has changed the view.
        if (is_view && *item.view > newest_view_) {
          newest_view_ = *item.view;
          wanted_spp_ = sent_spp_ = 0;
        }
        news.push_back(std::move(item.news));
      }
      items_.pop_front();
      if (!news.empty() && std::holds_alternative<watch_news::Connected>(news.back())) break;
    }
  }
  changed_.notify_all();
  return news;
}

// --- Sending

void WatchClient::change_view(const View& view) {
  {
    const std::lock_guard lock(mutex_);
    next_view_ = view;
    view_on_its_way_ = true;
    wanted_spp_ = sent_spp_ = 0;
  }
  changed_.notify_all();
}

bool WatchClient::is_own(const WatchView& view) const {
  const std::lock_guard lock(mutex_);
  return view.number == own_view_;
}

void WatchClient::want_samples(std::uint32_t spp) {
  {
    const std::lock_guard lock(mutex_);
    wanted_spp_ = spp;
  }
  changed_.notify_all();
}

void WatchClient::want_layer(const std::string& name) {
  {
    const std::lock_guard lock(mutex_);
    wanted_layers_.push_back(name);
  }
  changed_.notify_all();
}

void WatchClient::send() {
  const auto stub = wire::Farm::NewStub(channel_);
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] {
      return stopping_ || next_view_ || wanted_spp_ > sent_spp_ || !wanted_layers_.empty();
    });
    if (stopping_) return;
    wire::ControlRequest request;
    request.set_job(job_);
    const bool changes_view = next_view_.has_value();
    const std::uint32_t spp = wanted_spp_;
    if (changes_view) {
      encode(*next_view_, *request.mutable_change_view());
      next_view_.reset();
    } else if (!wanted_layers_.empty()) {
      for (std::string& name : wanted_layers_) request.mutable_want_layers()->add_names(std::move(name));
      wanted_layers_.clear();
    } else {
      request.mutable_want_samples()->set_view(newest_view_);
      request.mutable_want_samples()->set_spp(spp);
      sent_spp_ = spp;
    }
    grpc::ClientContext context;
    show_token(context, token_);
    context.set_deadline(std::chrono::system_clock::now() + kTimeToAnswer);
    sending_ = &context;
    lock.unlock();
    wire::ControlReply reply;
    const grpc::Status status = stub->Control(&context, request, &reply);
    lock.lock();
    sending_ = nullptr;
    if (changes_view) {
      if (status.ok()) own_view_ = newest_view_ = reply.view();
      view_on_its_way_ = next_view_.has_value();
    }
    // The reading thread reports a lost connection.
    if (!status.ok() && status.error_code() != grpc::StatusCode::UNAVAILABLE && !stopping_)
      items_.push_back({{}, connection_, watch_news::Said{"the scheduler refused: " + status_text(status)}});
  }
}

}  // namespace penumbra
