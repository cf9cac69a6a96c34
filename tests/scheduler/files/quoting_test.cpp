#include "scheduler/files/quoting.h"

#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

TEST(Quoting, PlainWordsOfAShellStayAsTheyAre) {
  EXPECT_EQ(shell_quoted("a/b-c_1.xml"), "a/b-c_1.xml");
  EXPECT_EQ(shell_quoted(""), "''");
  EXPECT_EQ(shell_quoted("$HOME"), "'$HOME'");
  EXPECT_EQ(shell_quoted("a;b"), "'a;b'");
  EXPECT_EQ(shell_quoted("~"), "'~'");
  EXPECT_EQ(shell_quoted_file("-o.xml"), "./-o.xml");
}

/// What a shell makes of the command: its words, which NUL ends.
std::string words_of(const std::string& command, const std::filesystem::path& folder) {
  const std::filesystem::path out = folder / "words";
  const std::string line =
      "cd " + shell_quoted(folder.string()) + " && printf '%s\\0' " + command + " > words";
  if (std::system(line.c_str()) != 0) return "the shell failed";
  return file_contents(out);
}

TEST(Quoting, AShellReadsBackEveryByte) {
  const TemporaryFolder folder;
  std::string every_byte;
  for (int c = 1; c < 256; ++c) every_byte += char(c);
  const std::vector<std::string> words = {every_byte, "`touch a`", "$(touch a)", "'; touch a; '", "a\nb", ""};
  std::string expected;
  for (const std::string& word : words) expected += word + '\0';
  EXPECT_EQ(words_of(shell_command(words), folder.path()), expected);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"words"});
}

TEST(Quoting, HtmlHasNoMarkupLeft) {
  EXPECT_EQ(html_escaped("<a href=\"x\" b='&'>"), "&lt;a href=&quot;x&quot; b=&#39;&amp;&#39;&gt;");
}

TEST(Quoting, LatexHasNoCommandsLeft) {
  EXPECT_EQ(latex_escaped("path_ems, 50 %"), "path\\_ems, 50 \\%");
  EXPECT_EQ(latex_escaped("\\write18{rm} $x$ #1 a&b ~^"),
            "\\textbackslash{}write18\\{rm\\} \\$x\\$ \\#1 a\\&b \\textasciitilde{}\\textasciicircum{}");
  EXPECT_EQ(latex_escaped("<a|b>"), "\\textless{}a\\textbar{}b\\textgreater{}");
  EXPECT_EQ(latex_escaped("a\n\tb%\n"), "a  b\\% ") << "a comment would end at the line's end";
  EXPECT_EQ(latex_escaped("--spp ``x''"), "-{}-spp `{}`x'{}'");
  EXPECT_EQ(latex_escaped("Küche"), "Küche");
}

TEST(Quoting, GnuplotStringsEndWhereTheyEnd) {
  EXPECT_EQ(gnuplot_quoted("it's `a`\nb\\"), "'it''s `a` b\\'");
}

TEST(Quoting, TablesHoldNoFormulas) {
  EXPECT_EQ(csv_quoted("a b"), "a b");
  EXPECT_EQ(csv_quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
  EXPECT_EQ(csv_quoted("=cmd|' /C calc'!A0"), "'=cmd|' /C calc'!A0");
  EXPECT_EQ(csv_quoted("@SUM(1,2)"), "\"'@SUM(1,2)\"");
  EXPECT_EQ(csv_quoted("-1"), "'-1");
}

TEST(Quoting, FileNamesAreAsManyAsTexts) {
  EXPECT_EQ(file_name_of("Küche 2"), "Küche 2");
  EXPECT_EQ(file_name_of("a\nb/c"), "a%0Ab%2Fc");
  EXPECT_NE(file_name_of("%0A"), file_name_of("\n"));
}

}  // namespace
}  // namespace penumbra
