#include "kernels/host/console.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "kernels/host/text.h"

namespace penumbra {
namespace {

TEST(VisibleText, KeepsWhatATerminalShows) {
  for (const std::string text : {"", "a b\tc\nd", "größer ⟨H − αW⟩ …", "\xF0\x9F\x8C\x93", "\xC2\xA0"})
    EXPECT_EQ(visible_text(text), text);
}

TEST(VisibleText, ShowsWhatATerminalWouldObey) {
  EXPECT_EQ(visible_text("\x1b[31mred\r"), "\\u001b[31mred\\u000d");
  EXPECT_EQ(visible_text(std::string("a\0b\x7f", 4)), "a\\u0000b\\u007f");
  EXPECT_EQ(visible_text("\xC2\x9B"
                         "2J"),
            "\\u009b2J")
      << "the same control sequence as one code point";
  EXPECT_EQ(visible_text("\x9b"
                         "2J"),
            "\\x9b2J")
      << "and as one byte";
  EXPECT_EQ(visible_text("\xE0\x82\x9B \xC1\x9B \xED\xA0\x80 \xF4\x90\x80\x80 \xE2\x82"),
            "\\xe0\\x82\\x9b \\xc1\\x9b \\xed\\xa0\\x80 \\xf4\\x90\\x80\\x80 \\xe2\\x82")
      << "longer than needed, surrogates, beyond Unicode, cut off";
}

TEST(VisibleText, OfJsonIsTheSameJson) {
  const nlohmann::json json = {{"name", "\x7f \xC2\x9B \x1b ü"}};
  EXPECT_EQ(nlohmann::json::parse(visible_text(json.dump(2))), json);
}

std::string said(const std::function<void()>& say) {
  testing::internal::CaptureStderr();
  say();
  return testing::internal::GetCapturedStderr();
}

TEST(Messages, SayOnceWhoAndWhat) {
  EXPECT_EQ(said([] { print_error({"no"}); }), "penumbra: error: no\n");
  EXPECT_EQ(said([] { print_error({"error: no"}); }), "penumbra: error: no\n");
  EXPECT_EQ(said([] { print_warning("warning: no"); }), "penumbra: warning: no\n");
  EXPECT_EQ(said([] { print_error({"a.xml:1:2: error: no"}); }), "a.xml:1:2: error: no\n");
}

TEST(Messages, TakeTheLineOfABar) {
  EXPECT_EQ(said([] {
              redraw_line("half");
              print_message("a");
              print_message("b");
              clear_line();
            }),
            "\r\x1b[Khalf\r\x1b[Ka\nb\n");
}

TEST(Words, CountThings) {
  EXPECT_EQ(counted(0, "sample"), "0 samples");
  EXPECT_EQ(counted(1, "sample"), "1 sample");
  EXPECT_EQ(counted(2u, "sample"), "2 samples");
}

}  // namespace
}  // namespace penumbra
