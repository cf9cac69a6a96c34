#include "scenes/diagnostic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/text.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// A column a character, but for tabs, which go to the next multiple of 8.
std::vector<std::string> columns(std::string_view line) {
  std::vector<std::string> result;
  for (const char c : line) {
    if (c == '\t') {
      result.resize(result.size() / 8 * 8 + 8);
    } else if ((static_cast<unsigned char>(c) & 0xC0u) != 0x80u) {
      result.emplace_back(1, c);
    } else {
      result.back() += c;
    }
  }
  return result;
}

/// The character that the caret of the text's last line is below.
std::string under_caret(const std::string& text) {
  const std::size_t caret_line = text.rfind('\n') + 1, line = text.rfind('\n', caret_line - 2) + 1;
  const auto carets = columns(std::string_view(text).substr(caret_line));
  return columns(std::string_view(text).substr(line, caret_line - 1 - line)).at(carets.size() - 1);
}

TEST(Diagnostic, ShowsPlaceLineAndCaret) {
  const SourceFile file{"a/b.xml", "first\n  <bsdf/>\r\nlast"};
  EXPECT_EQ(format_diagnostic({&file, 9}, "error", "no"), "a/b.xml:2:4: error: no\n    <bsdf/>\n     ^");
  EXPECT_EQ(format_diagnostic({&file, 0}, "error", "no"), "a/b.xml:1:1: error: no\n  first\n  ^");
  EXPECT_EQ(format_diagnostic({&file, 999}, "error", "no"), "a/b.xml:3:5: error: no\n  last\n      ^");
  EXPECT_EQ(format_diagnostic({}, "error", "no"), "error: no");
}

TEST(Diagnostic, CountsColumnsInCodePointsAndKeepsTabs) {
  const SourceFile file{"x", "\tä=1"};
  EXPECT_EQ(format_diagnostic({&file, 4}, "warning", "w"), "x:1:4: warning: w\n  \tä=1\n  \t  ^");
}

// Long lines have marks of their own.
TEST(Diagnostic, PlacesInLongLinesAreCountedInCharacters) {
  std::string text = "first\n";
  for (int i = 0; i < 9000; ++i) text += i % 3 == 0 ? "\u00e4" : "b";
  const SourceFile file{"x", text + "\nlast"};
  std::size_t offset = 6;
  for (std::size_t column = 1; column <= 9000; ++column) {
    const LineColumn place = line_and_column({&file, offset});
    ASSERT_EQ(place.line, 2u);
    ASSERT_EQ(place.column, column);
    ASSERT_EQ(location_of(file, place).offset, offset);
    offset += column % 3 == 1 ? 2 : 1;
  }
  EXPECT_EQ(line_and_column({&file, text.size() + 1}).line, 3u);
  EXPECT_EQ(line_and_column({&file, text.size() + 3}).column, 3u);
  EXPECT_EQ(line_and_column({&file, 5}).column, 6u);
}

TEST(Diagnostic, CutsLongLinesAroundTheCaretAndHidesControlCharacters) {
  const SourceFile file{"x", std::string(5000, 'a') + "\x1b[31mB" + std::string(5000, 'c')};
  const std::string text = format_diagnostic({&file, 5005}, "error", "e");
  EXPECT_LT(text.size(), 300u);
  EXPECT_THAT(text, HasSubstr("␛[31mB"));
  EXPECT_EQ(under_caret(text), "B");
}

TEST(Diagnostic, NothingOfAFileIsObeyedByATerminal) {
  // Escape, backspace, delete, C1's CSI alone and in UTF-8, half a character, an override of the direction.
  const std::string line = "\x1b]0;t\a\b\x7f\x9b\xc2\x9b\xe2\x82\xe2\x80\xae<here>\r";
  const SourceFile file{"a\x1b.xml", "first\n" + line + "\nlast"};
  const std::size_t here = file.text.find('<');
  const std::string text = format_diagnostic({&file, here}, "error", "'a\x1b[2J\nb\xff' is wrong");
  EXPECT_EQ(text,
            "a␛.xml:2:14: error: 'a␛[2J␊b\uFFFD' is wrong\n"
            "  ␛]0;t␇␈␡\uFFFD\uFFFD\uFFFD\uFFFD\uFFFD<here>\n"
            "               ^");
  EXPECT_EQ(under_caret(text), "<");
  Diagnostics diagnostics;
  diagnostics.warn({&file, here}, "\x1b[2J");
  EXPECT_THAT(diagnostics.take_warnings(), ElementsAre("a␛.xml:2:14: warning: ␛[2J"));
}

TEST(Diagnostic, CaretsAreRightAfterTabsAndInAnyCharacter) {
  const SourceFile file{"x", "a\tb\x01\tß\t\x7f\xff€!"};
  for (const std::string here : {"b", "ß", "€", "!"}) {
    const std::string text = format_diagnostic({&file, file.text.find(here)}, "error", "e");
    EXPECT_EQ(under_caret(text), here) << text;
  }
}

TEST(Diagnostic, LongMessagesAreCut) {
  const std::string name = "ä" + std::string(1000000, 'n');
  const std::string text = format_diagnostic({}, "error", "there is no " + name);
  EXPECT_LT(text.size(), 2100u);
  EXPECT_THAT(text, HasSubstr("error: there is no ännnn"));
  EXPECT_THAT(text, HasSubstr("nnn … (1000014 bytes in all)"));
  for (const std::size_t bytes : {1u, 2u, 3u, 4u})
    EXPECT_THAT(visible(shortened("ä€ and so on", bytes)), Not(HasSubstr("\uFFFD"))) << bytes;
}

TEST(Diagnostic, EmptyFile) {
  const SourceFile file{"x", ""};
  EXPECT_EQ(format_diagnostic({&file, 0}, "error", "e"), "x:1:1: error: e\n  \n  ^");
}

TEST(Diagnostics, VeryManyWarningsAreCounted) {
  Diagnostics diagnostics;
  for (int i = 0; i < 1000; ++i) diagnostics.warn({}, std::to_string(i));
  const std::vector<std::string> warnings = diagnostics.take_warnings();
  ASSERT_EQ(warnings.size(), 201u);
  EXPECT_EQ(warnings[199], "warning: 199");
  EXPECT_EQ(warnings[200], "warning: and 800 more");
}

TEST(NearestName, FindsMisspellings) {
  const std::vector<std::string> names = {"diffuse", "phong", "twosided"};
  EXPECT_EQ(nearest_name("difuse", names), "diffuse");
  EXPECT_EQ(nearest_name("Phong", names), "phong");
  EXPECT_EQ(nearest_name("twosidde", names), "twosided");  // a swap is one edit
  EXPECT_EQ(nearest_name("roughconductor", names), std::nullopt);
  EXPECT_EQ(nearest_name("", names), std::nullopt);
  EXPECT_EQ(nearest_name(std::string(100000, 'x'), names), std::nullopt);
}

TEST(Diagnostics, CollectsEachErrorOnceAndTheFirstOfMany) {
  Diagnostics diagnostics;
  EXPECT_FALSE(diagnostics.failed());
  diagnostics.warn({}, "careful");
  diagnostics.warn({}, "careful");
  EXPECT_FALSE(diagnostics.failed());
  for (int i = 0; i < 50; ++i) diagnostics.error({}, "no " + std::to_string(i / 2));
  EXPECT_TRUE(diagnostics.failed());
  const std::string text = diagnostics.error().message;
  EXPECT_THAT(text, HasSubstr("error: no 19"));
  EXPECT_THAT(text, Not(HasSubstr("error: no 20")));
  EXPECT_THAT(text, HasSubstr("and perhaps more"));
  EXPECT_THAT(diagnostics.take_warnings(), ElementsAre("warning: careful"));
}

}  // namespace
}  // namespace penumbra
