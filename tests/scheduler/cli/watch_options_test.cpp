// `penumbra preview`, and the options of `penumbra render` for watching it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <functional>
#include <thread>

#include "scheduler/image/image.h"
#include "scheduler/watch/watch_client.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::watch_options_test {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr auto kPatience = 60s;

class WatchOptions : public ::testing::Test {
 protected:
  void SetUp() override { write_small_scene(folder_ / "s.xml"); }
  std::string address() const { return "unix:" + (folder_ / "socket").string(); }
  TemporaryFolder folder_;
};

TEST_F(WatchOptions, AddressesThatMakeNoSenseAreBadUsage) {
  for (const char* command : {"render", "preview"}) {
    const auto refused = [&](const char* option, const char* value) {
      const ProgramResult result = run_penumbra(folder_.path(), {command, "s.xml", option, value});
      EXPECT_EQ(result.exit_code, 2) << command << " " << option << " " << value;
      EXPECT_THAT(result.err, HasSubstr(option));
      return result.err;
    };
    EXPECT_THAT(refused("--listen", "0.0.0.0:7000"), HasSubstr("without encryption"));
    EXPECT_THAT(refused("--listen", "somewhere"), HasSubstr("give host and port"));
    EXPECT_THAT(refused("--listen", "127.0.0.1:99999"), HasSubstr("give host and port"));
    EXPECT_THAT(refused("--tev", "host:99999"), HasSubstr("a port is a number from 1 to 65535"));
    EXPECT_THAT(refused("--tev", "[::1"), HasSubstr("']' is missing"));
  }
  EXPECT_THAT(folder_.names(), testing::ElementsAre("s.xml"));
}

TEST_F(WatchOptions, ARenderSaysHowToWatchItAndNamesPortAndToken) {
  const ProgramResult result =
      run_penumbra(folder_.path(), {"render", "s.xml", "--listen", "127.0.0.1:0", "--threads", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(Not(ContainsRegex("to watch(.|\n)*to watch")),
                                ContainsRegex("to watch: PENUMBRA_TOKEN=[0-9a-f]+ penumbra-view --connect "
                                              "127\\.0\\.0\\.1:[1-9][0-9]*\n"),
                                ContainsRegex("to help render: PENUMBRA_TOKEN=[0-9a-f]+ penumbra-worker "
                                              "--connect 127\\.0\\.0\\.1:[1-9][0-9]*\n")));
}

TEST_F(WatchOptions, ATevThatIsNotThereIsAWarning) {
  const ProgramResult result =
      run_penumbra(folder_.path(), {"render", "s.xml", "--tev", "127.0.0.1:1", "--threads", "1"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("warning: tev does not show this render any further: no connection"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "s.exr"));
}

TEST_F(WatchOptions, AReportDoesNotSayHowToWatchItsImages) {
  const ProgramResult result = run_penumbra(
      folder_.path(),
      {"report", "s.xml", "-o", "report", "--integrator", "path", "--spp", "1..2", "--seeds", "1"});
  EXPECT_THAT(result.err, AllOf(HasSubstr("[1/"), Not(HasSubstr("to watch"))));
}

TEST_F(WatchOptions, APreviewOfNothingIsBadInput) {
  const ProgramResult result = run_penumbra(folder_.path(), {"preview", "nowhere.xml"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("nowhere.xml"));
}

TEST_F(WatchOptions, APreviewsSampleIsTheRendersAndCtrlCEndsIt) {
  Program preview(folder_.path(),
                  {"preview", "s.xml", "--sampler", "scene", "--listen", address(), "--threads", "1"});
  {
    WatchClient client(address(), "");
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    std::optional<WatchedJob> job;
    std::optional<TileSnapshot> tile;  // the film is one
    while (!tile && std::chrono::steady_clock::now() < deadline) {
      for (WatchNews& news : client.take()) {
        if (auto* connected = std::get_if<watch_news::Connected>(&news)) {
          job = connected->job;
          ASSERT_NE(connected->scene, nullptr);
          client.want_samples(1);
        } else if (auto* came = std::get_if<TileSnapshot>(&news)) {
          tile = std::move(*came);
        }
      }
      std::this_thread::sleep_for(1ms);
    }
    ASSERT_TRUE(job);
    EXPECT_TRUE(job->interactive);
    EXPECT_EQ(job->title, "s.xml");
    EXPECT_GT(job->spp, 1000u) << "more than the scene's eight";
    ASSERT_TRUE(tile);
    ASSERT_EQ(tile->pixels(), 24u * 20);
    EXPECT_EQ(tile->samples, 1u);
    const TemporaryFolder other;  // each program's output goes to files of the same names
    write_small_scene(other / "s.xml");
    const ProgramResult rendered = run_penumbra(other.path(), {"render", "s.xml", "--spp", "1", "--pass", "1",
                                                               "--threads", "1", "--sampler", "scene"});
    ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
    const auto image = read_image(other / "s.exr");
    ASSERT_TRUE(image);
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 24 * 20; ++i)
        ASSERT_EQ(tile->radiance[std::size_t(3 * i + c)],
                  image->at(i % 24, i / 24, *image->channel(std::string(1, "RGB"[c]))));
  }
  preview.send(SIGINT);
  const ProgramResult result = preview.wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("to watch: penumbra-view --connect " + address()));
  EXPECT_THAT(result.out, IsEmpty());
}

}  // namespace
}  // namespace penumbra::watch_options_test
