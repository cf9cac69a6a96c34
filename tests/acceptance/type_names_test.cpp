// The one definition rule: a linker keeps one of two classes of the same name, and says nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace penumbra {
namespace {

/// The classes that files of the folders define in named namespaces, and the files. Types within functions
/// and classes are indented; those in unnamed namespaces have no linkage.
std::map<std::string, std::set<std::string>> types_of(const std::vector<std::string>& folders) {
  static const std::regex kNamespace(R"(namespace ?([\w:]*) ?\{.*)"), kEnd(R"(\}  // namespace.*)"),
      kType(R"((?:struct|class|union|enum class) (\w+)(?: final)?(?: :[^:].*)? \{.*)");
  std::map<std::string, std::set<std::string>> found;
  for (const std::string& folder : folders)
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source_path(folder))) {
      const auto& path = entry.path();
      if (path.extension() != ".h" && path.extension() != ".cpp") continue;
      std::vector<std::string> within;
      std::ifstream text(path);
      std::smatch match;
      for (std::string line; std::getline(text, line);) {
        if (std::regex_match(line, match, kNamespace))
          within.push_back(match[1]);
        else if (std::regex_match(line, kEnd) && !within.empty())
          within.pop_back();
        else if (std::ranges::none_of(within, &std::string::empty) && std::regex_match(line, match, kType)) {
          std::string name;
          for (const std::string& each : within) name += each + "::";
          found[name + match[1].str()].insert(std::filesystem::relative(path, source_path(".")).string());
        }
      }
    }
  return found;
}

TEST(TypeNames, AreDefinedOnce) {
  const auto types = types_of({"kernels", "scenes", "scheduler", "worker", "gl"});
  EXPECT_GT(types.size(), 500u) << "the search finds types";
  for (const auto& [name, files] : types) {
    std::string all;
    for (const std::string& file : files) all += "\n  " + file;
    EXPECT_EQ(files.size(), 1u) << name << " is defined in" << all;
  }
}

}  // namespace
}  // namespace penumbra
