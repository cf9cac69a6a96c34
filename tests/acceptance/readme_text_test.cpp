// The text of all READMEs: how long they are, how wide their lines are, and where their links lead.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::Contains;

constexpr int kMostWordsOfMain = 900;
constexpr int kMostWords = 12000;  // of all together
constexpr int kMostColumns = 120;

/// README.md and whatever else is Markdown in the folders of the project, relative to its root.
std::vector<std::string> markdown_files() {
  std::vector<std::string> files{"README.md"};
  for (const char* folder : {"gl", "kernels", "scenes", "scheduler", "tests", "worker"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source_path(folder)))
      if (entry.path().extension() == ".md")
        files.push_back(std::filesystem::relative(entry.path(), source_path(".")).string());
  std::ranges::sort(files);
  return files;
}

std::vector<std::string> lines_of(const std::string& file) {
  std::istringstream text(file_contents(source_path(file)));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

/// What is between blanks, bars of tables included, as `wc -w` counts.
int words_of(const std::string& file) {
  std::istringstream text(file_contents(source_path(file)));
  int words = 0;
  for (std::string word; text >> word;) ++words;
  return words;
}

/// Characters of a line of UTF-8.
int columns_of(const std::string& line) {
  return int(std::ranges::count_if(line, [](unsigned char c) { return (c & 0xc0) != 0x80; }));
}

/// The names by which links find the headings of a file: in lower case, without punctuation.
std::vector<std::string> anchors_of(const std::string& file) {
  std::vector<std::string> anchors;
  for (const std::string& line : lines_of(file)) {
    if (!line.starts_with("#")) continue;
    std::string anchor;
    for (const unsigned char c : line.substr(line.find(' ') + 1)) {
      if (c == ' ') anchor += '-';
      if (std::isalnum(c) != 0 || c == '-' || c == '_' || c >= 0x80) anchor += char(std::tolower(c));
    }
    anchors.push_back(anchor);
  }
  return anchors;
}

TEST(ReadmeText, TheMainOneCanBeReadInAHurry) { EXPECT_LE(words_of("README.md"), kMostWordsOfMain); }

TEST(ReadmeText, AllTogetherCanBeReadInAnHour) {
  int words = 0;
  for (const std::string& file : markdown_files()) words += words_of(file);
  EXPECT_LE(words, kMostWords);
}

TEST(ReadmeText, LinesFitIntoAWindow) {
  for (const std::string& file : markdown_files())
    for (const std::string& line : lines_of(file))
      if (!line.starts_with("|") && line.find("](") == std::string::npos)  // rows and links cannot be broken
        EXPECT_LE(columns_of(line), kMostColumns) << file << ": " << line;
}

TEST(ReadmeText, LinksLeadSomewhere) {
  int links = 0;
  for (const std::string& file : markdown_files()) {
    const std::string text = file_contents(source_path(file));
    for (std::size_t at = text.find("]("); at != std::string::npos; at = text.find("](", at + 1)) {
      const std::string link = text.substr(at + 2, text.find(')', at) - at - 2);
      if (link.starts_with("http")) continue;
      ++links;
      const std::string path = link.substr(0, link.find('#'));
      const auto target = (std::filesystem::path(file).parent_path() / path).lexically_normal();
      const std::string other = path.empty() ? file : target.string();
      ASSERT_TRUE(std::filesystem::exists(source_path(other))) << file << ": " << link;
      if (const std::size_t hash = link.find('#'); hash != std::string::npos)
        EXPECT_THAT(anchors_of(other), Contains(link.substr(hash + 1))) << file << ": " << link;
    }
  }
  EXPECT_GE(links, 50);
}

}  // namespace
}  // namespace penumbra
