// Renders that are shown in a fake tev, which reads every byte, or none.
#include "scheduler/watch/tev.h"

#include <gmock/gmock.h>

#include <cstring>

#include "tests/scheduler/watch/fake_tev.h"
#include "tests/scheduler/watch/watched_run.h"

namespace penumbra {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(TevAddress, MissingPartsAreTheDefault) {
  const std::vector<std::vector<std::string>> cases = {
      {"", "127.0.0.1", "14158"},        {"node7", "node7", "14158"},       {"node7:1", "node7", "1"},
      {":65535", "127.0.0.1", "65535"},  {"10.0.0.2:80", "10.0.0.2", "80"}, {"[::1]:90", "::1", "90"},
      {"[fe80::2]", "fe80::2", "14158"}, {"fe80::2", "fe80::2", "14158"}};
  for (const auto& c : cases) {
    const auto address = parse_tev_address(c[0]);
    ASSERT_TRUE(address) << c[0];
    EXPECT_EQ(address->host, c[1]) << c[0];
    EXPECT_EQ(address->port, c[2]) << c[0];
  }
}

TEST(TevAddress, WrongOnesAreNamed) {
  for (const std::string text : {"host:", "host:0", "host:65536", "host:tev", "host:80x", "host:-1",
                                 "host: 80", "[::1", "[::1]80", "[::1]:", "[::1]:x"}) {
    const auto address = parse_tev_address(text);
    ASSERT_FALSE(address) << text;
    EXPECT_THAT(address.error().message, HasSubstr("'" + text + "' is no address of tev"));
  }
}

/// A stream without a render.
class TevStreamTest : public testing::Test {
 protected:
  TevStreamTest() {
    board.show_view({0, view_at(0)});
    describe("", 4, 2, false);
  }
  void describe(std::string title, int width, int height, bool hybrid) {
    WatchedJob job;
    job.title = std::move(title);
    job.film_width = width;
    job.film_height = height;
    job.hybrid = hybrid;
    board.describe(std::move(job));
  }
  static TileSnapshot tile_of(int x, int y, int side, std::vector<float> radiance) {
    TileSnapshot tile;
    tile.x = x;
    tile.y = y;
    tile.width = tile.height = side;
    tile.radiance = std::move(radiance);
    return tile;
  }
  /// Until everything is sent.
  void finish(TevStream& stream) {
    board.close();
    board.wait_for_watchers(kLong);
    stream.stop();
    EXPECT_EQ(stream.take_problem(), std::nullopt);
  }
  static std::string problem_of(TevStream& stream) {
    const auto deadline = steady_clock::now() + kLong;
    while (steady_clock::now() < deadline) {
      if (const auto problem = stream.take_problem()) return *problem;
      std::this_thread::sleep_for(milliseconds(1));
    }
    return "";
  }

  static constexpr milliseconds kShort{250};
  WatchBoard board{2};
};

TEST_F(TevStreamTest, ThePacketsAreThoseOfTheProtocol) {
  FakeTev tev;
  describe("a b", 1920, 1080, false);
  TevStream stream(board, tev.host());
  board.show_tile(0, tile_of(258, 1, 1, {1, -2, 0}));
  finish(stream);
  const std::vector<std::uint8_t> expected = {
      28,   0, 0,    0,    4,    1, 'a', ' ',  'b', 0,        // length, create, grab the focus, name
      0x80, 7, 0,    0,    0x38, 4, 0,   0,                   // 1920 x 1080
      3,    0, 0,    0,    'R',  0, 'G', 0,    'B', 0,        // channels
      96,   0, 0,    0,    6,    0, 'a', ' ',  'b', 0,        // length, update, keep the focus, name
      3,    0, 0,    0,    'R',  0, 'G', 0,    'B', 0,        // channels
      2,    1, 0,    0,    1,    0, 0,   0,                   // x, y
      1,    0, 0,    0,    1,    0, 0,   0,                   // width, height
      0,    0, 0,    0,    0,    0, 0,   0,                   // offsets
      1,    0, 0,    0,    0,    0, 0,   0,                   //
      2,    0, 0,    0,    0,    0, 0,   0,                   //
      3,    0, 0,    0,    0,    0, 0,   0,                   // strides
      3,    0, 0,    0,    0,    0, 0,   0,                   //
      3,    0, 0,    0,    0,    0, 0,   0,                   //
      0,    0, 0x80, 0x3F, 0,    0, 0,   0xC0, 0,   0, 0, 0,  // values
  };
  EXPECT_EQ(tev.bytes(), expected);
}

TEST_F(TevStreamTest, ATileLargerThanAnyBufferArrivesWhole) {
  FakeTev tev;
  TevStream stream(board, tev.host());
  std::vector<float> values(std::size_t{3} * 1024 * 1024);  // 12 MiB
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(i * 2654435761u % 16777213);
  board.show_tile(0, tile_of(0, 0, 1024, values));
  finish(stream);
  const auto bytes = tev.bytes();
  const std::size_t size = values.size() * sizeof(float);
  ASSERT_GT(bytes.size(), size);
  EXPECT_EQ(std::memcmp(bytes.data() + bytes.size() - size, values.data(), size), 0);
}

TEST_F(TevStreamTest, AHybridJobsTilesHaveTheirOtherLayers) {
  FakeTev tev;
  describe("", 4, 2, true);
  TevStream stream(board, tev.host());
  for (int i = 0; i < 2; ++i) {
    TileSnapshot tile = tile_of(2 * i, 0, 2, {});
    for (int k = 0; k < 12; ++k) tile.radiance.push_back(float(100 * i + k));
    for (int k = 0; k < 12; ++k) tile.difference.push_back(-float(100 * i + k) / 8);
    for (int k = 0; k < 4; ++k) tile.standard_error.push_back(float(10 * i + k) / 16);
    board.show_tile(std::uint32_t(i), std::move(tile));
  }
  finish(stream);
  Shown shown(tev.bytes());
  EXPECT_EQ(shown.name, "penumbra") << "the job has no title";
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

TEST_F(TevStreamTest, ATevThatHangsIsGivenUp) {
  const Listener listener;
  TevStream stream(board, listener.host(), kShort);
  board.show_tile(0, tile_of(0, 0, 2048, std::vector<float>(std::size_t{3} * 2048 * 2048)));
  EXPECT_EQ(problem_of(stream), "tev does not show this render any further: the connection to tev at " +
                                    listener.host() + " is lost: tev has taken nothing for 0.25 s");
}

TEST_F(TevStreamTest, AHostThatDoesNotAnswerIsGivenUp) {
  // A full queue of connections drops further ones, like a host that is off.
  const Listener listener(0);
  std::vector<OwnedDescriptor> waiting;
  for (int i = 0; i < 8; ++i) {
    waiting.emplace_back(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0));
    (void)::connect(waiting.back().get(), reinterpret_cast<const sockaddr*>(&listener.address),
                    sizeof listener.address);
  }
  TevStream impatient(board, listener.host(), kShort);
  EXPECT_THAT(problem_of(impatient),
              HasSubstr("no connection to tev at " + listener.host() + ": no answer in 0.25 s"));

  TevStream patient(board, listener.host(), std::chrono::minutes(10));
  EXPECT_TRUE(board.is_watched()) << "tiles are kept for it";
  const auto begin = steady_clock::now();
  patient.stop();
  EXPECT_LT(steady_clock::now() - begin, kLong);
  EXPECT_FALSE(board.is_watched());
  EXPECT_NE(patient.take_problem(), std::nullopt);
  EXPECT_EQ(patient.take_problem(), std::nullopt) << "returned once";
}

TEST_F(TevStreamTest, AHostThatCannotExist) {
  const std::string host(70, 'x');  // longer than any part of a name, so no name service is asked
  TevStream stream(board, host);
  EXPECT_THAT(problem_of(stream), HasSubstr("no connection to tev at " + host + ": "));
}

void expect_radiance_of(Shown& shown, const FilmAccumulator& film) {
  for (int c = 0; c < 3; ++c) {
    const auto& plane = shown.pixels[std::string(1, "RGB"[c])];
    ASSERT_EQ(plane.size(), std::size_t(kWidth) * kHeight);
    for (const auto& [at, value] : plane) ASSERT_EQ(value, float(film.at(at.first, at.second).mean[c]));
  }
}

class TevRender : public WatchedRunTest {};

TEST_F(TevRender, TevEndsWithExactlyTheFilmsPixels) {
  FakeTev tev;
  FakeBehaviour{.delay_ms = 2}.to_environment();
  LocalRender job = batch_job();
  job.tev = tev.host();
  const RenderOutcome outcome = BackgroundRun(job).wait();
  EXPECT_TRUE(outcome.complete);
  EXPECT_THAT(outcome.problems, IsEmpty());
  EXPECT_EQ(outcome.film.hash(), expected_film(kSpp, 4).hash());
  Shown shown(tev.bytes());
  EXPECT_THAT(shown.grabs, ElementsAre(true));
  EXPECT_EQ(shown.name, "a.xml");
  EXPECT_EQ(shown.width, 200) << "the whole film, so that a crop lies where it belongs";
  EXPECT_EQ(shown.height, 150);
  EXPECT_THAT(shown.channels, ElementsAre("R", "G", "B"));
  expect_radiance_of(shown, outcome.film);
}

TEST_F(TevRender, AnotherViewStartsTheImageOver) {
  FakeTev tev;
  LocalRender job = interactive_job();
  job.tev = tev.host();
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
  Shown shown(tev.bytes());
  // The first view may have been skipped.
  EXPECT_THAT(shown.grabs, testing::AnyOf(ElementsAre(true), ElementsAre(true, false)))
      << "the camera is turned in another window, which keeps the focus";
  expect_radiance_of(shown, outcome.film);
  expect_radiance_of(shown, expected_film(1, 1, 10));
}

/// Renders without and with a tev that takes nothing.
void expect_same_image(LocalRender job, const std::string& tev, const std::string& problem) {
  const RenderOutcome alone = BackgroundRun(job).wait();
  job.tev = tev;
  const RenderOutcome shown = BackgroundRun(job).wait();
  EXPECT_TRUE(shown.complete);
  EXPECT_EQ(shown.film.hash(), alone.film.hash());
  EXPECT_THAT(shown.problems, ElementsAre(HasSubstr(problem))) << "told once";
}

TEST_F(TevRender, ATevThatHangsChangesNothingAndIsToldOnce) {
  const Listener listener;
  LocalRender job = batch_job();
  job.scene = fake_scene(1280, 960, true);
  job.x = job.y = 0;
  job.width = 1280;
  job.height = 960;
  job.request.plan.tile = 256;  // 15 MB of tiles, more than the buffers of a socket
  job.spp = 1;
  expect_same_image(job, listener.host(), "tev at " + listener.host());
}

TEST_F(TevRender, ATevThatIsNotThereIsToldOnce) {
  FakeBehaviour{.delay_ms = 3}.to_environment();
  const Listener closed(Listener::kClosed);
  expect_same_image(batch_job(), closed.host(),
                    "no connection to tev at " + closed.host() + ": Connection refused; is it running?");
}

TEST_F(TevRender, ATevThatGoesAwayIsToldOnceAlsoToThoseWhoWatch) {
  FakeBehaviour{.delay_ms = 10}.to_environment();
  const Listener listener;
  std::jthread tev([&] {
    const OwnedDescriptor connection = listener.accept();
    char some[5000];  // the first tile
    (void)!::recv(connection.get(), some, sizeof some, MSG_WAITALL);
  });
  LocalRender job = batch_job();
  job.tev = listener.host();
  Onlooker onlooker(address());
  const RenderOutcome outcome = BackgroundRun(job).wait();
  EXPECT_TRUE(outcome.complete);
  EXPECT_EQ(outcome.film.hash(), expected_film(kSpp, 4).hash());
  EXPECT_THAT(outcome.problems,
              ElementsAre(HasSubstr("the connection to tev at " + listener.host() + " is lost")));
  EXPECT_TRUE(onlooker.sees_end());
  EXPECT_THAT(onlooker.said, testing::Contains(HasSubstr(listener.host())));
}

}  // namespace
}  // namespace penumbra
