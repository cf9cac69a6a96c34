// The commands and scripts of scheduler/farm/CLUSTER.md, which the tests run as they are there: only names of
// hosts, and sizes for a cluster of three cores, are exchanged.
#pragma once

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {

/// The indented block that contains this text, without indentation and prompts. A failure if there is none or
/// several.
inline std::string recipe(const std::string& part) {
  constexpr const char *kIndent = "    ", *kPrompt = "login$ ";
  std::vector<std::string> blocks{""};
  std::istringstream text(file_contents(source_path("scheduler/farm/CLUSTER.md")));
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with(kIndent)) {
      if (!line.empty() && !blocks.back().empty()) blocks.emplace_back();
      continue;
    }
    line.erase(0, 4);
    if (line.starts_with(kPrompt)) line.erase(0, 7);
    blocks.back() += line + "\n";
  }
  std::string found;
  for (const std::string& block : blocks) {
    if (!block.contains(part)) continue;
    EXPECT_TRUE(found.empty()) << "several recipes have " << part;
    found = block;
  }
  EXPECT_FALSE(found.empty()) << "no recipe has " << part;
  return found;
}

/// The recipe with each text, which must be there, exchanged.
inline std::string adapted(std::string recipe,
                           const std::vector<std::pair<std::string, std::string>>& exchanged) {
  for (const auto& [from, to] : exchanged) {
    std::size_t at = recipe.find(from);
    EXPECT_NE(at, std::string::npos) << "'" << from << "' is not in\n" << recipe;
    for (; at != std::string::npos; at = recipe.find(from, at + to.size()))
      recipe.replace(at, from.size(), to);
  }
  return recipe;
}

}  // namespace penumbra
