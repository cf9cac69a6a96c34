// Workers behind a network that delays their messages, or is down for a while.
#include <gmock/gmock.h>
#include <stdlib.h>

#include <chrono>
#include <deque>
#include <functional>
#include <random>
#include <regex>
#include <thread>

#include "tests/scheduler/faults/tcp_relay.h"
#include "tests/support/fake_device.h"
#include "tests/support/fake_processes.h"
#include "tests/support/fake_samples.h"
#include "tests/support/fault_schedules.h"
#include "tests/support/local_render.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "worker/keys/client_access.h"

namespace penumbra::network_faults_test {
namespace {

using namespace std::chrono_literals;
using testing::ContainsRegex;
using testing::HasSubstr;

constexpr int kSize = 64, kLargeSize = 256;
constexpr std::uint32_t kSpp = 5;

/// A farm with a slow worker of its own and two that come over TCP.
class NetworkFaults : public testing::Test {
 protected:
  void SetUp() override {
    setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1);
    FakeBehaviour{.delay_ms = 20}.to_environment();
    job_.scene = fake_scene(kSize, kSize, false);
    job_.width = job_.height = kSize;
    job_.spp = kSpp;
    job_.request.plan.samples_per_pass = 1;
    job_.request.plan.tile = 8;
    job_.workers = 1;
    job_.worker_executable = PENUMBRA_BINARY_DIR "/fake_worker";
    job_.listen = "127.0.0.1:0";
    job_.tells_how_to_watch = true;
    job_.leases = {.initial = 5, .minimum = 2, .factor = 20, .growth = 2, .silence = 2.5, .patience = 1};
  }
  void TearDown() override {
    FakeBehaviour{}.to_environment();
    unsetenv(kTokenVariable);
  }

  /// Renders; `join` is called with the address and the token for workers as soon as they are said, and
  /// `meanwhile` with the number of workers, a few times a second from the first result on.
  void render(const std::function<void(const std::string&, const std::string&)>& join,
              const std::function<void(int)>& meanwhile);

  [[nodiscard]] std::uint64_t expected_hash() const {
    FilmAccumulator film(0, 0, job_.width, job_.height, layers_);
    for (std::uint32_t sample = 0; sample < job_.spp; ++sample)
      film.add(0, 0, fake_samples({0, 0, job_.width, job_.height, sample, 1}, layers_));
    return film.hash();
  }

  LocalRender job_;
  FilmLayers layers_ = kNoLayers;
  TemporaryFolder folder_;
  std::deque<Program> guests_;
  std::vector<std::string> problems_;
};

void NetworkFaults::render(const std::function<void(const std::string&, const std::string&)>& join,
                           const std::function<void(int)>& meanwhile) {
  std::atomic<bool> stop = false;
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  const Expected<RenderOutcome> outcome = run_render(job_, stop, [&](const RenderProgress& progress) {
    const std::regex how(R"(to help render: PENUMBRA_TOKEN=(\S+) penumbra-worker --connect (\S+))");
    for (const std::string& notice : progress.notices)
      if (std::smatch match; std::regex_search(notice, match, how)) join(match[2], match[1]);
    if (progress.samples_done > 0) meanwhile(progress.workers);
    if (std::chrono::steady_clock::now() > deadline) stop = true;
  });
  ASSERT_FALSE(stop) << "it hangs";
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_TRUE(outcome->complete);
  EXPECT_EQ(outcome->film.hash(), expected_hash());
  problems_ = outcome->problems;
}

class Relayed : public NetworkFaults {
 protected:
  void join(const std::string& address, const std::string& token) {
    relay_.emplace(address);
    setenv(kTokenVariable, token.c_str(), 1);
    for (int guest = 0; guest < 2; ++guest)
      guests_.emplace_back(folder_.path(), PENUMBRA_BINARY_DIR "/fake_worker",
                           std::vector<std::string>{"--connect", relay_->address()});
  }
  std::optional<TcpRelay> relay_;
};

TEST_F(Relayed, ADelayChangesNothing) {
  int most = 0;
  render(
      [&](const auto& address, const auto& token) {
        join(address, token);
        relay_->set_delay(50ms);
      },
      [&](int workers) { most = std::max(most, workers); });
  EXPECT_EQ(most, 3);
  EXPECT_THAT(problems_, testing::IsEmpty());
}

TEST_F(Relayed, AShortPartitionChangesNothing) {
  std::thread network;
  render([&](const auto& address, const auto& token) { join(address, token); },
         [&](int workers) {
           if (workers < 3 || network.joinable()) return;
           network = std::thread([&] {
             for (int times = 0; times < 3; ++times) {
               relay_->partition(true);
               std::this_thread::sleep_for(400ms);
               relay_->partition(false);
               std::this_thread::sleep_for(100ms);
             }
           });
         });
  ASSERT_TRUE(network.joinable()) << "it was over before the guests were there";
  network.join();
  EXPECT_THAT(problems_, testing::IsEmpty());
}

TEST_F(Relayed, WhatIsCutOffIsDoneByOthers) {
  std::atomic<bool> cut = false;
  render([&](const auto& address, const auto& token) { join(address, token); },
         [&](int workers) {
           if (workers < 3 || cut.exchange(true)) return;
           relay_->partition(true);
         });
  EXPECT_TRUE(cut) << "it was over before the guests were there";
  EXPECT_THAT(problems_, testing::Each(HasSubstr("hung")));
}

/// A network that takes several times as long for a result as a silent worker is waited for.
TEST_F(Relayed, ASlowNetworkIsNoHungWorker) {
  job_.scene = fake_scene(kLargeSize, kLargeSize, true);
  job_.width = job_.height = job_.request.plan.tile = kLargeSize;
  job_.spp = 2;
  job_.workers = 0;
  layers_ = kFeatureLayers;
  const int bytes = kLargeSize * kLargeSize * kFeatureLayers.planes() * int(sizeof(float));
  render(
      [&](const auto& address, const auto& token) {
        join(address, token);
        relay_->set_rate(int(bytes / (2.5 * job_.leases.silence)));
      },
      [](int) {});
  EXPECT_THAT(problems_, testing::IsEmpty());
}

// --- The same with the system's own network, in a namespace that this test makes and that goes with it

class InNamespace : public NetworkFaults {};

/// In the namespace: run by the tests below.
TEST_F(InNamespace, DISABLED_Inside) {
  const std::string during = std::getenv("PENUMBRA_NETWORK_FAULT");
  bool begun = false;
  render(
      [&](const auto& address, const auto& token) {
        setenv(kTokenVariable, token.c_str(), 1);
        for (int guest = 0; guest < 2; ++guest)
          guests_.emplace_back(folder_.path(), PENUMBRA_BINARY_DIR "/fake_worker",
                               std::vector<std::string>{"--connect", address});
      },
      [&](int workers) {
        if (workers < 3 || std::exchange(begun, true)) return;
        EXPECT_EQ(run_shell(folder_.path(), during).exit_code, 0);
      });
  EXPECT_TRUE(begun) << "it was over before the guests were there";
}

/// Why the line does not run in a namespace of its own; empty if it does.
std::string why_not(const std::filesystem::path& folder, const std::string& line) {
  const ProgramResult tried = run_shell(folder, "unshare --net sh -c 'ip link set lo up && " + line + "'");
  return tried.exit_code == 0 ? "" : tried.err;
}

void run_inside(const std::filesystem::path& folder, const std::string& before, const std::string& during) {
  if (const std::string why = why_not(folder, before); !why.empty())
    GTEST_SKIP() << "there are no network namespaces to try this in, or not all of them: " << why;
  const std::string self = std::filesystem::canonical("/proc/self/exe");
  const ProgramResult ran =
      run_shell(folder, "PENUMBRA_NETWORK_FAULT='" + during + "' unshare --net sh -c 'ip link set lo up && " +
                            before + " && exec " + self +
                            " --gtest_also_run_disabled_tests --gtest_filter=InNamespace.DISABLED_Inside'");
  EXPECT_EQ(ran.exit_code, 0) << ran.out << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("1 test."));
}

TEST_F(InNamespace, AnInterfaceThatIsDownForAWhileChangesNothing) {
  run_inside(folder_.path(), "true", "(ip link set lo down; sleep 0.7; ip link set lo up) >/dev/null 2>&1 &");
}

TEST_F(InNamespace, DelayedAndLostPacketsChangeNothing) {
  run_inside(folder_.path(), "tc qdisc add dev lo root netem delay 20ms 10ms loss 2%", "true");
}

TEST_F(InNamespace, AllPacketsLostForAWhileChangeNothing) {
  run_inside(folder_.path(), "tc qdisc add dev lo root netem loss 0%",
             "(tc qdisc change dev lo root netem loss 100%; sleep 1; tc qdisc change dev lo root netem loss "
             "0%) >/dev/null 2>&1 &");
}

}  // namespace
}  // namespace penumbra::network_faults_test
