// The watching client against schedulers that start, end, hang, and send invalid messages.
#include "scheduler/watch/watch_client.h"

#include <gmock/gmock.h>
#include <grpcpp/server_builder.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "penumbra.grpc.pb.h"
#include "scheduler/farm/server.h"
#include "scheduler/watch/watch_wire.h"
#include "tests/scheduler/watch/watched_run.h"
#include "worker/protocol/wire.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;
using testing::HasSubstr;

// Far below the deadlines of the calls that it must cut short.
constexpr auto kSoon = 4s;

WatchedJob plain_job() {
  WatchedJob job;
  job.title = "a.xml";
  job.film_width = job.film_height = job.width = job.height = 64;
  job.spp = 10;
  return job;
}

TileSnapshot plain_tile(std::uint32_t view) {
  TileSnapshot tile;
  tile.view = view;
  tile.width = tile.height = 8;
  tile.samples = 1;
  tile.radiance.resize(3 * tile.pixels());
  tile.standard_error.resize(tile.pixels());
  return tile;
}

/// A scheduler whose calls hang or say what a test wants.
class ScriptedService final : public wire::Farm::Service {
 public:
  std::vector<wire::WatchEvent> events;  // told at first
  bool assets_hang = false, controls_hang = false;
  std::atomic<int> hanging = 0;

  grpc::Status Watch(grpc::ServerContext* context, const wire::WatchRequest*,
                     grpc::ServerWriter<wire::WatchEvent>* writer) override {
    for (const wire::WatchEvent& event : events) writer->Write(event);
    wait_until_cancelled(*context);
    return grpc::Status::CANCELLED;
  }
  grpc::Status Manifest(grpc::ServerContext* context, const wire::AssetRequest*,
                        wire::AssetManifest*) override {
    if (!assets_hang) return {grpc::StatusCode::NOT_FOUND, "no such asset"};
    ++hanging;
    wait_until_cancelled(*context);
    return grpc::Status::CANCELLED;
  }
  grpc::Status Control(grpc::ServerContext* context, const wire::ControlRequest*,
                       wire::ControlReply*) override {
    if (!controls_hang) return grpc::Status::OK;
    ++hanging;
    wait_until_cancelled(*context);
    return grpc::Status::CANCELLED;
  }

 private:
  static void wait_until_cancelled(const grpc::ServerContext& context) {
    while (!context.IsCancelled()) std::this_thread::sleep_for(2ms);
  }
};

class WatchClientTest : public WatchedRunTest {
 protected:
  std::unique_ptr<grpc::Server> serve(ScriptedService& service) const {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address(), grpc::InsecureServerCredentials());
    builder.RegisterService(&service);
    return builder.BuildAndStart();
  }
  static void shut_down(grpc::Server& server) {
    server.Shutdown(std::chrono::system_clock::now());
    server.Wait();
  }
  std::unique_ptr<Server> scheduler(const std::shared_ptr<WatchBoard>& board) const {
    auto server = Server::listen({.address = address()}).value();
    server->show_job(1, board, false);
    return server;
  }
  static std::chrono::steady_clock::duration time_to_destroy(std::unique_ptr<WatchClient> client) {
    const auto begin = steady_clock::now();
    client.reset();
    return steady_clock::now() - begin;
  }
  std::unique_ptr<WatchClient> client() const { return std::make_unique<WatchClient>(address(), ""); }
};

// --- The end of a client in every state

TEST_F(WatchClientTest, EndsWithoutAListener) {
  auto watching = client();
  std::this_thread::sleep_for(50ms);
  watching->change_view(view_at(1));
  watching->want_samples(3);
  EXPECT_LT(time_to_destroy(std::move(watching)), kSoon);
  EXPECT_LT(time_to_destroy(client()), kSoon) << "at once";
}

TEST_F(WatchClientTest, EndsWhereAListenerSaysNothing) {
  const int mute = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un place{};
  place.sun_family = AF_UNIX;
  (directory_ + "/socket").copy(place.sun_path, sizeof place.sun_path - 1);
  ASSERT_EQ(::bind(mute, reinterpret_cast<const sockaddr*>(&place), sizeof place), 0);
  ASSERT_EQ(::listen(mute, 5), 0);
  auto watching = client();
  watching->change_view(view_at(1));
  std::this_thread::sleep_for(100ms);
  EXPECT_LT(time_to_destroy(std::move(watching)), kSoon);
  ::close(mute);
}

TEST_F(WatchClientTest, EndsWhileItsSceneDoesNotCome) {
  ScriptedService service;
  WatchedJob job = plain_job();
  job.interactive = true;
  service.events = {encode(job)};
  service.assets_hang = true;
  const auto server = serve(service);
  auto watching = client();
  const auto deadline = steady_clock::now() + kLong;
  while (service.hanging == 0 && steady_clock::now() < deadline) std::this_thread::sleep_for(2ms);
  ASSERT_EQ(service.hanging, 1);
  EXPECT_LT(time_to_destroy(std::move(watching)), kSoon);
  shut_down(*server);
}

TEST_F(WatchClientTest, EndsWhileItsRequestIsNotAnswered) {
  ScriptedService service;
  service.events = {encode(plain_job())};
  service.controls_hang = true;
  const auto server = serve(service);
  auto watching = client();
  watching->change_view(view_at(1));
  const auto deadline = steady_clock::now() + kLong;
  while (service.hanging == 0 && steady_clock::now() < deadline) {
    std::this_thread::sleep_for(2ms);
    watching->change_view(view_at(2));  // again, if the first could not be sent yet
  }
  ASSERT_GE(service.hanging, 1);
  EXPECT_LT(time_to_destroy(std::move(watching)), kSoon);
  shut_down(*server);
}

TEST_F(WatchClientTest, EndsWithNewsThatIsNotTaken) {
  const auto board = std::make_shared<WatchBoard>(1);
  board->describe(plain_job());
  const auto server = scheduler(board);
  auto watching = client();
  const auto deadline = steady_clock::now() + kLong;
  while (!board->is_watched() && steady_clock::now() < deadline) std::this_thread::sleep_for(1ms);
  // More than it keeps, and than fits between: its reader waits.
  for (int i = 0; i < 2000; ++i) {
    board->say(std::string(1000, 'x'));
    std::this_thread::sleep_for(100us);
  }
  EXPECT_LT(time_to_destroy(std::move(watching)), kSoon);
}

TEST_F(WatchClientTest, EndsAfterALossARefusalAndAnEnd) {
  const auto board = std::make_shared<WatchBoard>(1);
  board->describe(plain_job());
  auto server = scheduler(board);
  {
    auto lost = std::make_unique<Onlooker>(address());
    ASSERT_TRUE(lost->sees_connection());
    server.reset();
    ASSERT_TRUE(lost->sees([&] { return lost->losses > 0; }));
    const auto begin = steady_clock::now();
    lost.reset();
    EXPECT_LT(steady_clock::now() - begin, kSoon);
  }
  ScriptedService service;
  wire::WatchEvent refusal;
  refusal.mutable_refused()->set_reason("not you");
  service.events = {refusal};
  const auto scripted = serve(service);
  auto refused = std::make_unique<Onlooker>(address());
  ASSERT_TRUE(refused->sees([&] { return !refused->refused.empty(); }));
  EXPECT_EQ(refused->refused, "not you");
  const auto begin = steady_clock::now();
  refused.reset();
  EXPECT_LT(steady_clock::now() - begin, kSoon);
  shut_down(*scripted);
}

// --- Nonsense

TEST_F(WatchClientTest, NonsenseIsRefused) {
  const auto refusal = [&](std::vector<wire::WatchEvent> events) {
    ScriptedService service;
    service.events = std::move(events);
    const auto server = serve(service);
    Onlooker onlooker(address());
    EXPECT_TRUE(onlooker.sees([&] { return !onlooker.refused.empty(); }));
    shut_down(*server);
    EXPECT_EQ(onlooker.losses, 0) << "nothing more comes after it";
    return onlooker.refused;
  };
  const wire::WatchEvent job = encode(plain_job());
  wire::WatchEvent bad_job = job, tile = encode(WatchItem(std::make_shared<TileSnapshot>(plain_tile(0)))),
                   view;
  bad_job.mutable_job()->set_width(-1);
  view.mutable_view();
  EXPECT_THAT(refusal({tile}), HasSubstr("did not describe its job"));
  EXPECT_THAT(refusal({bad_job}), HasSubstr("the scheduler describes -1 x 64"));
  EXPECT_THAT(refusal({job, view}), HasSubstr("a view whose camera has 0 numbers instead of"));
  tile.mutable_tile()->set_x(60);
  EXPECT_THAT(refusal({job, tile}), HasSubstr("not one of this render"));
}

TEST_F(WatchClientTest, ASceneThatIsNotThereIsARefusal) {
  ScriptedService service;
  WatchedJob job = plain_job();
  job.hybrid = true;
  wire::WatchEvent hello;
  hello.set_message("hello");
  service.events = {encode(job), hello};
  const auto server = serve(service);
  Onlooker onlooker(address());
  EXPECT_TRUE(onlooker.sees([&] { return !onlooker.refused.empty(); }));
  EXPECT_THAT(onlooker.refused, HasSubstr("no such asset"));
  shut_down(*server);
}

TEST_F(WatchClientTest, ASchedulerThatIsLostBeforeItsSceneHasComeIsTriedAgain) {
  WatchedJob job = plain_job();
  job.interactive = true;
  {
    ScriptedService service;
    service.events = {encode(job)};
    service.assets_hang = true;
    const auto server = serve(service);
    Onlooker onlooker(address());
    const auto deadline = steady_clock::now() + kLong;
    while (service.hanging == 0 && steady_clock::now() < deadline) std::this_thread::sleep_for(2ms);
    shut_down(*server);
    EXPECT_TRUE(onlooker.sees([&] { return onlooker.losses > 0 || !onlooker.refused.empty(); }));
    EXPECT_EQ(onlooker.refused, "");
    EXPECT_EQ(onlooker.losses, 1);
  }
}

// --- One scheduler after another

TEST_F(WatchClientTest, NumbersOfALostSchedulersViewsMeanNothingToTheNext) {
  auto watching = client();
  {
    const auto board = std::make_shared<WatchBoard>(1);
    board->describe(plain_job());
    board->show_view({7, view_at(70)});
    const auto server = scheduler(board);
    const auto deadline = steady_clock::now() + kLong;
    while (!board->is_watched() && steady_clock::now() < deadline) std::this_thread::sleep_for(1ms);
    board->wait_for_watchers(kLong);  // and what has come is not taken
  }
  const auto board = std::make_shared<WatchBoard>(1);
  board->describe(plain_job());
  board->show_view({0, view_at(0)});
  const auto server = scheduler(board);
  const auto deadline = steady_clock::now() + kLong;
  while (!board->is_watched() && steady_clock::now() < deadline) std::this_thread::sleep_for(1ms);
  board->show_tile(0, plain_tile(0));
  board->wait_for_watchers(kLong);
  std::vector<std::uint32_t> views, tiles;
  int connections = 0;
  while (tiles.empty() && steady_clock::now() < deadline) {
    for (const WatchNews& news : watching->take()) {
      if (std::holds_alternative<watch_news::Connected>(news)) ++connections;
      if (const auto* view = std::get_if<WatchView>(&news)) views.push_back(view->number);
      if (const auto* tile = std::get_if<TileSnapshot>(&news)) tiles.push_back(tile->view);
    }
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(connections, 2);
  EXPECT_THAT(tiles, testing::ElementsAre(0));
  ASSERT_FALSE(views.empty());
  EXPECT_EQ(views.back(), 0u);
}

// --- The end of a scheduler

TEST_F(WatchClientTest, WhatWasToldLastArrivesThoughTheServerEndsAtOnce) {
  // The last thing that a render does: close the board, wait, destroy the server. Often, for it is a race.
  for (int round = 0; round < 40; ++round) {
    const auto board = std::make_shared<WatchBoard>(64);
    board->describe(plain_job());
    auto server = scheduler(board);
    Onlooker onlooker(address());
    ASSERT_TRUE(onlooker.sees_connection());
    board->show_view({1, view_at(1)});
    WatchProgress last{.view = 1, .ended = true, .workers = {}};
    board->show_progress(last);
    for (std::uint32_t i = 0; i < 64; ++i) {
      TileSnapshot tile = plain_tile(1);
      tile.x = 8 * int(i % 8);
      tile.y = 8 * int(i / 8);
      board->show_tile(i, std::move(tile));
    }
    board->close();
    board->wait_for_watchers(kLong);
    server.reset();
    ASSERT_TRUE(onlooker.sees_end());
    ASSERT_EQ(onlooker.tiles.size(), 64u) << "in round " << round;
    EXPECT_EQ(onlooker.losses, 0);
  }
}

TEST_F(WatchClientTest, AServerThatEndsWithoutAnEndIsALoss) {
  const auto board = std::make_shared<WatchBoard>(1);
  board->describe(plain_job());
  auto server = scheduler(board);
  Onlooker onlooker(address());
  ASSERT_TRUE(onlooker.sees_connection());
  server.reset();
  EXPECT_TRUE(onlooker.sees([&] { return onlooker.losses == 1; }));
  EXPECT_FALSE(onlooker.ended);
}

}  // namespace
}  // namespace penumbra
