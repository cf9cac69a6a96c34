#include "gl/overlay_text.h"

#include <gtest/gtest.h>

#include <limits>

#include "gl/actions.h"

namespace penumbra::overlay_text_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(OverlayText, DurationsAreReadableAtEveryLength) {
  EXPECT_EQ(duration_text(0.0351), "35 ms");
  EXPECT_EQ(duration_text(0.9999), "1.0 s");
  EXPECT_EQ(duration_text(1.74), "1.7 s");
  EXPECT_EQ(duration_text(9.97), "10 s");
  EXPECT_EQ(duration_text(59.6), "1 min 00 s");
  EXPECT_EQ(duration_text(65), "1 min 05 s");
  EXPECT_EQ(duration_text(3 * 3600 + 5 * 60), "3 h 05 min");
  EXPECT_EQ(duration_text(3599.6), "1 h 00 min");
  EXPECT_EQ(duration_text(52 * 3600), "2 d 4 h");
  EXPECT_EQ(duration_text(1e30), "more than 30 years");
  for (const double unknown : {kNan, kInfinity, -1.0}) EXPECT_EQ(duration_text(unknown), "unknown");
}

TEST(OverlayText, CountsHaveThreeDigits) {
  EXPECT_EQ(count_text(0), "0");
  EXPECT_EQ(count_text(950), "950");
  EXPECT_EQ(count_text(999.7), "1.00 k");
  EXPECT_EQ(count_text(12.34e6), "12.3 M");
  EXPECT_EQ(count_text(2.5e12), "2500 G");
  EXPECT_EQ(count_text(kNan), "unknown");
}

TEST(OverlayText, PercentsHaveTwoDigits) {
  EXPECT_EQ(percent_text(0), "0 %");
  EXPECT_EQ(percent_text(1), "100 %");
  EXPECT_EQ(percent_text(0.0231), "2.3 %");
  EXPECT_EQ(percent_text(0.000123), "0.012 %");
  EXPECT_EQ(percent_text(1e-30), "0.00000000 %");
  EXPECT_EQ(percent_text(kNan), "unknown");
}

TEST(OverlayText, MessagesAreOfTheKindTheyBeginWith) {
  EXPECT_EQ(message_kind("error: no scene"), MessageKind::kError);
  EXPECT_EQ(message_kind("Warning: slow"), MessageKind::kWarning);
  EXPECT_EQ(message_kind("no error: all is well"), MessageKind::kPlain);
  EXPECT_EQ(message_kind(""), MessageKind::kPlain);
}

TEST(OverlayText, WhatDoesNotApplySaysWhy) {
  ViewStatus batch;
  batch.connection = ConnectionState::kConnected;
  for (const auto why : {why_no_closed_form, why_no_camera, why_no_reload, why_no_more_samples, why_no_save})
    EXPECT_FALSE(why(batch).empty());
  ViewStatus preview = batch;
  preview.hybrid = preview.interactive = true;
  preview.film_width = preview.film_height = 8;
  for (const auto why :
       {why_no_closed_form, why_no_alpha, why_no_camera, why_no_reload, why_no_more_samples, why_no_save})
    EXPECT_EQ(why(preview), "");
  batch.hybrid = true;
  EXPECT_EQ(why_no_closed_form(batch), "");
  EXPECT_FALSE(why_no_alpha(batch).empty()) << "its tiles are of one alpha";
  preview.connection = ConnectionState::kLost;
  EXPECT_FALSE(why_no_more_samples(preview).empty());
}

TEST(OverlayText, KeysAreNamedAsTheyArePrinted) {
  EXPECT_EQ(key_text("plus"), "+");
  EXPECT_EQ(key_text("page_up"), "page up");
  for (const ActionInfo& info : all_actions()) EXPECT_FALSE(key_text(info.key).empty());
}

}  // namespace
}  // namespace penumbra::overlay_text_test
