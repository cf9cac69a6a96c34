// A render is streamed to a fake tev that reads every byte, or none.
#include "scheduler/watch/tev_stream.h"

#include <gmock/gmock.h>

#include <map>
#include <set>

#include "tests/scheduler/watch/fake_tev.h"
#include "tests/scheduler/watch/watched_run.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr int kFilmWidth = 200, kFilmHeight = 150;

/// What tev shows after these packets.
struct Shown {
  explicit Shown(const std::vector<std::vector<std::uint8_t>>& packets) {
    for (const auto& packet : packets) {
      if (packet.at(4) == 4) {
        create(packet);
      } else {
        update(decode_update(packet));
      }
    }
  }
  void create(const std::vector<std::uint8_t>& packet) {
    Decoder in = open(packet, 4);
    grabs.push_back(in.byte() == 1);
    name = in.text();
    width = in.int32();
    height = in.int32();
    channels.clear();
    for (int count = in.int32(); count > 0; --count) channels.push_back(in.text());
    pixels.clear();
    ++images;
  }
  void update(const Update& update) {
    EXPECT_EQ(update.name, name);
    EXPECT_FALSE(update.grab_focus);
    for (std::size_t c = 0; c < update.channels.size(); ++c) {
      EXPECT_THAT(channels, testing::Contains(update.channels[c]));
      for (int p = 0; p < update.width * update.height; ++p)
        pixels[update.channels[c]][{update.x + p % update.width, update.y + p / update.width}] =
            update.at(c, p);
    }
  }
  int images = 0, width = 0, height = 0;
  std::vector<bool> grabs;
  std::string name;
  std::vector<std::string> channels;
  std::map<std::string, std::map<std::pair<int, int>, float>> pixels;
};

void expect_radiance_of(Shown& shown, const FilmAccumulator& film) {
  for (int c = 0; c < 3; ++c) {
    const auto& plane = shown.pixels[std::string(1, "RGB"[c])];
    ASSERT_EQ(plane.size(), std::size_t(kWidth) * kHeight);
    for (const auto& [at, value] : plane) ASSERT_EQ(value, float(film.at(at.first, at.second).mean[c]));
  }
}

class TevStreamTest : public WatchedRunTest {};

TEST_F(TevStreamTest, TevEndsWithExactlyTheFilmsPixels) {
  FakeTev tev;
  ASSERT_NE(tev.listener().port, 0);
  FakeBehaviour{.delay_ms = 2}.to_environment();
  LocalRender job = batch_job();
  job.tev = tev.listener().host();
  const RenderOutcome outcome = BackgroundRun(job).wait();
  EXPECT_TRUE(outcome.complete);
  EXPECT_THAT(outcome.problems, IsEmpty());
  EXPECT_EQ(outcome.film.hash(), expected_film(kSpp, 4).hash());
  Shown shown(tev.packets());
  EXPECT_EQ(shown.images, 1);
  EXPECT_THAT(shown.grabs, ElementsAre(true));
  EXPECT_EQ(shown.name, "a.xml");
  EXPECT_EQ(shown.width, kFilmWidth) << "the whole film, so that a crop lies where it belongs";
  EXPECT_EQ(shown.height, kFilmHeight);
  EXPECT_THAT(shown.channels, ElementsAre("R", "G", "B"));
  expect_radiance_of(shown, outcome.film);
}

TEST_F(TevStreamTest, ARenderWithoutATitleHasANameAllTheSame) {
  FakeTev tev;
  LocalRender job = batch_job();
  job.title = "";
  job.tev = tev.listener().host();
  EXPECT_THAT(BackgroundRun(job).wait().problems, IsEmpty());
  EXPECT_EQ(Shown(tev.packets()).name, "penumbra");
}

TEST_F(TevStreamTest, AnotherViewStartsTheImageOver) {
  FakeTev tev;
  LocalRender job = interactive_job();
  job.tev = tev.listener().host();
  RenderOutcome outcome;
  {
    Onlooker onlooker(address());
    BackgroundRun run(job);
    ASSERT_TRUE(onlooker.sees_workers(2));
    onlooker.client.want_samples(2);
    ASSERT_TRUE(onlooker.sees_samples(2));
    onlooker.change_view(10);
    onlooker.client.want_samples(1);
    ASSERT_TRUE(onlooker.sees_samples(1));
    outcome = run.stop();
  }
  Shown shown(tev.packets());
  EXPECT_GE(shown.images, 1);
  EXPECT_LE(shown.images, 2);
  EXPECT_TRUE(shown.grabs.front());
  for (std::size_t i = 1; i < shown.grabs.size(); ++i)
    EXPECT_FALSE(shown.grabs[i]) << "the camera is turned in another window, which keeps the focus";
  expect_radiance_of(shown, outcome.film);
  expect_radiance_of(shown, expected_film(1, 1, 10));
}

TEST(TevStream, AHybridJobsTilesHaveTheirOtherLayers) {
  FakeTev tev;
  ASSERT_NE(tev.listener().port, 0);
  WatchBoard board(2);
  TevStream stream(board, tev.listener().host());
  WatchedJob job;
  job.title = "h.xml";
  job.film_width = 4;
  job.film_height = 2;
  job.hybrid = true;
  board.show_view({0, view_at(0)});
  board.describe(job);
  for (int i = 0; i < 2; ++i) {
    TileSnapshot tile;
    tile.x = 2 * i;
    tile.width = tile.height = 2;
    tile.samples = 1;
    for (int k = 0; k < 12; ++k) tile.radiance.push_back(float(100 * i + k));
    for (int k = 0; k < 12; ++k) tile.difference.push_back(-float(100 * i + k) / 8);
    for (int k = 0; k < 4; ++k) tile.standard_error.push_back(float(10 * i + k) / 16);
    board.show_tile(std::uint32_t(i), std::move(tile));
  }
  board.close();
  board.wait_for_watchers(kLong);
  stream.stop();
  EXPECT_EQ(stream.take_problem(), std::nullopt);
  Shown shown(tev.packets());
  EXPECT_THAT(shown.channels,
              ElementsAre("R", "G", "B", "difference.R", "difference.G", "difference.B", "standard_error.Y"));
  for (int i = 0; i < 2; ++i)
    for (int p = 0; p < 4; ++p) {
      const std::pair at(2 * i + p % 2, p / 2);
      for (int c = 0; c < 3; ++c) {
        const std::string channel(1, "RGB"[c]);
        EXPECT_EQ(shown.pixels[channel][at], float(100 * i + 3 * p + c));
        EXPECT_EQ(shown.pixels["difference." + channel][at], -float(100 * i + 3 * p + c) / 8);
      }
      EXPECT_EQ(shown.pixels["standard_error.Y"][at], float(10 * i + p) / 16);
    }
}

/// The times of the same render without and with a tev that takes nothing.
void expect_no_delay(LocalRender job, const std::string& tev, const std::string& problem) {
  const RenderOutcome alone = BackgroundRun(job).wait();
  job.tev = tev;
  const RenderOutcome shown = BackgroundRun(job).wait();
  EXPECT_TRUE(shown.complete);
  EXPECT_EQ(shown.film.hash(), alone.film.hash());
  // Twice the time and some: a machine with other work, but far from tev's timeout of five seconds.
  EXPECT_LT(shown.seconds_to_last_tile, 2 * alone.seconds_to_last_tile + 2);
  EXPECT_LT(shown.seconds, 2 * alone.seconds + 2.5);
  EXPECT_THAT(shown.problems, ElementsAre(HasSubstr(problem))) << "said once";
}

TEST_F(TevStreamTest, ATevThatNeverReadsDelaysNothingAndIsToldOnce) {
  const Listener listener;  // the kernel accepts the connection, but nothing is read
  ASSERT_NE(listener.port, 0);
  const int small = 4096;
  ASSERT_EQ(::setsockopt(listener.socket, SOL_SOCKET, SO_RCVBUF, &small, sizeof small), 0);
  LocalRender job = batch_job();
  job.scene = fake_scene(1600, 1200, true);
  job.x = job.y = 0;
  job.width = 1600;
  job.height = 1200;
  job.tile = 256;  // 23 MB of tiles, more than any buffer of a socket
  job.spp = 2;
  expect_no_delay(job, listener.host(), "tev at " + listener.host() + " was too slow");
}

TEST_F(TevStreamTest, ATevThatIsNotThereIsToldOnce) {
  FakeBehaviour{.delay_ms = 3}.to_environment();
  const Listener bound(AF_INET, -1);
  ASSERT_NE(bound.port, 0);
  expect_no_delay(batch_job(), bound.host(), "no connection to tev at " + bound.host());
}

TEST_F(TevStreamTest, ATevThatGoesAwayIsToldOnceAlsoToThoseWhoWatch) {
  FakeBehaviour{.delay_ms = 10}.to_environment();
  const Listener listener;
  ASSERT_NE(listener.port, 0);
  std::thread tev([&] {
    const Descriptor connection(listener.accept());
    char some[5000];  // the first tile
    (void)!::recv(connection, some, sizeof some, MSG_WAITALL);
  });
  LocalRender job = batch_job();
  job.tev = listener.host();
  Onlooker onlooker(address());
  const RenderOutcome outcome = BackgroundRun(job).wait();
  tev.join();
  EXPECT_TRUE(outcome.complete);
  EXPECT_EQ(outcome.film.hash(), expected_film(kSpp, 4).hash());
  EXPECT_THAT(outcome.problems,
              ElementsAre(HasSubstr("the connection to tev at " + listener.host() + " is lost")));
  EXPECT_TRUE(onlooker.sees_end());
  EXPECT_THAT(onlooker.said, testing::Contains(HasSubstr(listener.host())));
}

TEST(TevStream, AStopEndsAConnectionThatIsNotAnswered) {
  // A full queue of connections drops what else comes, like a host that is off.
  const Listener listener(AF_INET, 0);
  ASSERT_NE(listener.port, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(listener.port);
  std::vector<std::unique_ptr<Descriptor>> waiting;
  for (int i = 0; i < 8; ++i) {
    waiting.push_back(std::make_unique<Descriptor>(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0)));
    (void)::connect(*waiting.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }
  WatchBoard board(1);
  TevStream stream(board, listener.host(), std::chrono::minutes(10));
  EXPECT_TRUE(board.is_watched()) << "the render keeps what it is to show";
  std::this_thread::sleep_for(100ms);
  const auto begin = steady_clock::now();
  stream.stop();
  EXPECT_LT(steady_clock::now() - begin, 20s);
  EXPECT_FALSE(board.is_watched());
  EXPECT_NE(stream.take_problem(), std::nullopt);
  EXPECT_EQ(stream.take_problem(), std::nullopt) << "once";
}

}  // namespace
}  // namespace penumbra
