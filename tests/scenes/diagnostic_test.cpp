#include "scenes/diagnostic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

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

TEST(Diagnostic, CutsLongLinesAroundTheCaretAndHidesControlCharacters) {
  const SourceFile file{"x", std::string(5000, 'a') + "\x1b[31mB" + std::string(5000, 'c')};
  const std::string text = format_diagnostic({&file, 5005}, "error", "e");
  EXPECT_LT(text.size(), 300u);
  EXPECT_THAT(text, HasSubstr("?[31mB"));
  const std::size_t line = text.find("\n  ") + 3, caret_line = text.find("\n  ", line) + 3;
  EXPECT_EQ(text[line + text.find('^') - caret_line], 'B');
}

TEST(Diagnostic, EmptyFile) {
  const SourceFile file{"x", ""};
  EXPECT_EQ(format_diagnostic({&file, 0}, "error", "e"), "x:1:1: error: e\n  \n  ^");
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
