// A test with a Slurm of its own, and what the renders of these tests have in common.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "tests/slurm/slurm_cluster.h"
#include "tests/support/fake_processes.h"

namespace penumbra {

using Arguments = std::vector<std::string>;

/// A second or three for three threads, in units of some 10 ms.
inline const Arguments kRender = {"render", "",   "--spp",  "256", "--tile",    "32",
                                  "--pass", "16", "--seed", "3",   "--threads", "1"};

class Slurm : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!cluster_.why_not().empty()) GTEST_SKIP() << cluster_.why_not();
    setenv("SLURM_CONF", cluster_.configuration().c_str(), 1);
    setenv("PENUMBRA_CACHE", (folder_ / "cache").c_str(), 1);
  }
  void TearDown() override {
    unsetenv("SLURM_CONF");
    unsetenv("PENUMBRA_CACHE");
  }

  static Arguments render(const std::string& out, const Arguments& more, int spp = 256) {
    Arguments all = kRender;
    all[3] = std::to_string(spp);
    all[1] = source_path("scenes/cornell-small/cornell-small.xml");
    all.insert(all.end(), {"-o", out});
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  void expect_same_as_here(const std::string& image, int spp = 256, const Arguments& more = {}) {
    Arguments options{"--workers", "2", "-q"};
    options.insert(options.end(), more.begin(), more.end());
    const ProgramResult here = run_penumbra(folder_.path(), render("here.exr", options, spp));
    ASSERT_EQ(here.exit_code, 0) << here.err;
    EXPECT_TRUE(file_contents(folder_ / "here.exr") == file_contents(folder_ / image)) << image;
  }
  [[nodiscard]] nlohmann::json statistics(const std::string& name) const {
    return nlohmann::json::parse(file_contents(folder_ / name));
  }
  /// What the running program has said.
  [[nodiscard]] std::string said() const { return file_contents(folder_ / ".stderr"); }
  /// Token and address for workers, as soon as they are printed.
  std::pair<std::string, std::string> told_for_workers() {
    const std::regex wanted("PENUMBRA_TOKEN=(\\S+) penumbra-worker --connect (\\S+)");
    std::smatch found;
    std::string text;
    EXPECT_TRUE(eventually([&] { return text = said(), std::regex_search(text, found, wanted); },
                           std::chrono::seconds(10)));
    return {found[1], found[2]};
  }
  /// How many workers that it has not started have joined the running program.
  int joined() const {
    const std::string text = said(), wanted = "has joined it";
    int count = 0;
    for (std::size_t at = 0; (at = text.find(wanted, at)) != std::string::npos; ++at) ++count;
    return count;
  }
  int tasks_running() const { return int(cluster_.processes("penumbra-worker").size()); }

  SlurmCluster cluster_;
  TemporaryFolder folder_;
};

}  // namespace penumbra
