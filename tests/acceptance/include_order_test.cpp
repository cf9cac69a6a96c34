// Which files include which: no folder includes from one above it, and nothing includes itself by way of
// others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::IsEmpty;

/// The folders of the product. Each includes from itself and from those before it.
constexpr std::array<std::string_view, 5> kFolders = {"kernels", "scenes", "worker", "scheduler", "gl"};

/// Names, and for each the names of those that it includes.
using Graph = std::map<std::string, std::set<std::string>>;

/// The files of the product, relative to its root, with the files of the project that they include.
Graph included_files() {
  static const std::regex include("^ *#include \"([^\"]+)\"", std::regex::multiline);
  Graph files;
  for (const std::string_view folder : kFolders)
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(source_path(std::string(folder)))) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cpp" && extension != ".cl") continue;
      std::set<std::string>& included =
          files[std::filesystem::relative(entry.path(), source_path(".")).string()];
      const std::string text = file_contents(entry.path());
      for (std::sregex_iterator match(text.begin(), text.end(), include), end; match != end; ++match)
        if (std::filesystem::exists(source_path((*match)[1]))) included.insert((*match)[1]);
    }
  return files;
}

/// The first folders of a path: "scheduler/cli" of "scheduler/sets/job_file.h" for two.
std::string folders_of(const std::string& file, int count) {
  std::size_t end = 0;
  for (int i = 0; i < count; ++i) {
    const std::size_t next = file.find('/', end + 1);
    if (next == std::string::npos) break;
    end = next;
  }
  return file.substr(0, end);
}

/// A circle, as names joined by " > "; empty if there is none.
std::string circle_in(const Graph& graph) {
  enum class State { kNew, kOnPath, kDone };
  std::map<std::string, State> states;
  std::vector<std::string> path;
  std::string circle;
  const auto visit = [&](const auto& self, const std::string& name) -> void {
    states[name] = State::kOnPath;
    path.push_back(name);
    const auto next = graph.find(name);
    for (const std::string& included : next == graph.end() ? std::set<std::string>{} : next->second) {
      if (states[included] == State::kNew) self(self, included);
      if (states[included] == State::kOnPath && circle.empty()) {
        for (auto step = std::ranges::find(path, included); step != path.end(); ++step)
          circle += *step + " > ";
        circle += included;
      }
      if (!circle.empty()) return;
    }
    path.pop_back();
    states[name] = State::kDone;
  };
  for (const auto& [name, included] : graph)
    if (states[name] == State::kNew && circle.empty()) visit(visit, name);
  return circle;
}

TEST(IncludeOrder, FoldersIncludeFromThoseBelowAlone) {
  std::vector<std::string> upwards;
  const auto place = [](const std::string& file) {
    return std::ranges::find(kFolders, folders_of(file, 1)) - kFolders.begin();
  };
  for (const auto& [file, included] : included_files())
    for (const std::string& other : included)
      if (place(other) > place(file)) upwards.push_back(file + " > " + other);
  EXPECT_THAT(upwards, IsEmpty());
}

TEST(IncludeOrder, FilesFormNoCircle) {
  const Graph files = included_files();
  EXPECT_GT(files.size(), 1000u);
  EXPECT_EQ(circle_in(files), "");
}

TEST(IncludeOrder, FoldersOfTheSchedulerFormNoCircle) {
  Graph folders;
  for (const auto& [file, included] : included_files())
    for (const std::string& other : included) {
      const std::string from = folders_of(file, 2), to = folders_of(other, 2);
      if (from != to && from.starts_with("scheduler") && to.starts_with("scheduler"))
        folders[from].insert(to);
    }
  EXPECT_GT(folders.size(), 5u);
  EXPECT_EQ(circle_in(folders), "");
}

TEST(IncludeOrder, CirclesAreFound) {
  EXPECT_EQ(circle_in({{"a", {"b", "c"}}, {"b", {}}, {"c", {"b"}}}), "");
  EXPECT_EQ(circle_in({{"a", {"b"}}, {"b", {"c"}}, {"c", {"b"}}}), "b > c > b");
}

}  // namespace
}  // namespace penumbra
