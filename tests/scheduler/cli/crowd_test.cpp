// A render while more idle connections are open to its address than it has file descriptors.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/fake_processes.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::crowd_test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr int kCrowd = 1500;
constexpr rlim_t kUsualDescriptors = 1024;
constexpr int kAFewDescriptors = 50;
constexpr auto kPatience = 60s;

/// Connections that are only held open.
class Crowd {
 public:
  explicit Crowd(int port) {
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    name.sin_port = htons(std::uint16_t(port));
    for (int i = 0; i < kCrowd; ++i) {
      const int one = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      EXPECT_GE(one, 0);
      descriptors_.push_back(one);
      EXPECT_EQ(connect(one, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
    }
  }
  Crowd(const Crowd&) = delete;
  ~Crowd() {
    for (const int descriptor : descriptors_) close(descriptor);
  }

  /// Those that the other end has closed.
  std::ptrdiff_t sent_away() const {
    std::vector<pollfd> entries;
    for (const int descriptor : descriptors_) entries.push_back({descriptor, POLLRDHUP, 0});
    return poll(entries.data(), entries.size(), 0);
  }

 private:
  std::vector<int> descriptors_;
};

/// 0 where this user may not know: a scheduler with tokens keeps its memory and files to itself.
std::ptrdiff_t open_descriptors(pid_t pid) {
  std::error_code not_permitted;
  return std::distance(
      std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/fd", not_permitted), {});
}

TEST(CrowdTest, ADeadWorkerIsReplacedWhileMoreAreConnectedThanThereAreDescriptors) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const std::vector<std::string> command = {"render", "s.xml",     "--spp", "40000",    "--pass",
                                            "1000",   "--threads", "1",     "--listen", "127.0.0.1:0"};
  const auto hash = [&] { return nlohmann::json::parse(file_contents(folder / "s.json"))["film_hash"]; };
  const ProgramResult alone = run_penumbra(folder.path(), command);
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  const nlohmann::json expected = hash();
  std::filesystem::remove(folder / "s.json");

  rlimit own{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &own), 0);
  if (own.rlim_max < kCrowd + 200) GTEST_SKIP() << "too few descriptors for a crowd";
  rlimit usual = own;
  usual.rlim_cur = kUsualDescriptors;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &usual), 0);
  Program render(folder.path(), command);
  own.rlim_cur = own.rlim_max;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &own), 0);

  std::smatch found;
  std::string text;
  const std::regex printed("penumbra-view --connect 127\\.0\\.0\\.1:(\\d+)");
  ASSERT_TRUE(eventually(
      [&] {
        text = file_contents(folder / ".stderr");
        return std::regex_search(text, found, printed);
      },
      kPatience))
      << text;
  const Crowd crowd(std::stoi(found[1]));
  // All have been dealt with, or no more can be.
  EXPECT_TRUE(eventually(
      [&] {
        const std::ptrdiff_t open = open_descriptors(render.pid());
        return open + crowd.sent_away() >= kCrowd ||
               open + kAFewDescriptors >= std::ptrdiff_t(kUsualDescriptors);
      },
      kPatience));
  const std::vector<pid_t> workers = children_of(render.pid());
  ASSERT_THAT(workers, SizeIs(1));
  kill(workers[0], SIGKILL);
  const ProgramResult result = render.wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("killed by signal 9")) << "before the render was done";
  EXPECT_EQ(hash(), expected);
}

}  // namespace
}  // namespace penumbra::crowd_test
