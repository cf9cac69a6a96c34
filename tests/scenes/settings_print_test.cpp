// Every setting prints as text that parses back to the same value.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "scenes/settings.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Settings with the parameter, defaults otherwise.
RenderSettings settings_with(const Setting& setting) {
  RenderSettings settings;
  for (const IntegratorMethod& method : integrator_methods()) {
    if (setting.belongs_to(settings)) break;
    settings.integrator.method = method;
  }
  EXPECT_TRUE(setting.belongs_to(settings)) << setting.key;
  return settings;
}

/// Applies the text, which must be right; then what is printed is applied to defaults and printed again.
void expect_round_trip(const Setting& setting, const std::string& text) {
  RenderSettings given = settings_with(setting), again = given;
  const auto done = setting.apply(given, text);
  ASSERT_TRUE(done) << setting.key << " = " << text << ": " << done.error().message;
  const std::string printed = setting.print(given);
  const auto parsed = setting.apply(again, printed);
  ASSERT_TRUE(parsed) << setting.key << " = " << printed << ": " << parsed.error().message;
  EXPECT_EQ(setting.print(again), printed) << setting.key;
}

/// Texts about the ends of what is right, and beyond.
std::vector<std::string> candidates(std::mt19937_64& random) {
  std::vector<std::string> texts = {"auto", "true", "false", "0", "-1", "1"};
  for (const double end : {1e-300, 1e-40, 1e-4, 0.5, 10.0, 180.0, 1024.0, 65536.0, 1e6, 2147483647.0,
                           2147483648.0, 4294967295.0, double(std::numeric_limits<float>::max())})
    for (const double value : {end, std::nextafter(end, 0.0), std::nextafter(end, 1e300)})
      for (const double sign : {1.0, -1.0}) {
        char text[400];
        std::snprintf(text, sizeof text, "%.17g", sign * value);
        texts.emplace_back(text);
        std::snprintf(text, sizeof text, "%.0f", sign * value);
        texts.emplace_back(text);
      }
  for (int i = 0; i < 2000; ++i) {
    char text[64];
    const double value = std::ldexp(double(random()) / 1.8e19, int(random() % 50) - 15);
    std::snprintf(text, sizeof text, i % 2 == 0 ? "%.17g" : "%.0f", random() % 2 == 0 ? value : -value);
    texts.emplace_back(text);
  }
  return texts;
}

TEST(SettingsPrint, DefaultsLimitsAndRandomValuesParseBack) {
  std::mt19937_64 random(1);
  const std::vector<std::string> texts = candidates(random);
  for (const Setting& setting : all_settings()) {
    if (!setting.print) continue;
    expect_round_trip(setting, setting.print(settings_with(setting)));
    for (const std::string& name : setting.choices) expect_round_trip(setting, name);
    std::size_t right = 0;
    for (const std::string& text : texts) {
      RenderSettings settings = settings_with(setting);
      if (!setting.apply(settings, text)) continue;
      ++right;
      expect_round_trip(setting, text);
    }
    const bool named = setting.kind == SettingKind::kText;
    EXPECT_TRUE(named || right >= (setting.kind == SettingKind::kBoolean ? 2 : 20)) << setting.key;
  }
}

TEST(SettingsPrint, WhatIsStoredIsWhatIsPrinted) {
  RenderSettings settings;
  const auto value = [&](const char* key, const char* text) {
    EXPECT_TRUE(apply_setting(settings, key, text)) << key;
    return print_setting(settings, key);
  };
  EXPECT_EQ(value("film.rfilter_stddev", "0.1"), "0.1");
  EXPECT_EQ(value("camera.fov", "39.307700000000004"), "39.307700000000004");
  EXPECT_EQ(value("integrator.type", "path"), "path_mis");
  EXPECT_EQ(value("integrator.alpha", "0.30000000"), "0.3");
  EXPECT_EQ(value("integrator.alpha", " auto"), "auto");
  EXPECT_EQ(value("integrator.hide_emitters", "TRUE"), "true");
  EXPECT_EQ(value("sampler.seed", "4294967295"), "4294967295");
  EXPECT_EQ(value("film.layers", "shape, uv,shape"), "uv,shape");
  EXPECT_EQ(value("film.layers", " none "), "none");
}

TEST(SettingsPrint, ACamerasFrameStaysTheSameBits) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  const Setting& lookat = *find_setting("camera.lookat");
  const Setting& frame = *find_setting("camera.to_world");
  for (int i = 0; i < 1000; ++i) {
    std::string text;
    for (int k = 0; k < 9; ++k) text += std::to_string(normal(random)) + " ";
    RenderSettings settings, again;
    ASSERT_TRUE(lookat.apply(settings, text));
    ASSERT_TRUE(frame.apply(again, frame.print(settings)));
    EXPECT_EQ(again.camera.to_world, settings.camera.to_world);
  }
}

/// Each key's value; integrator.type first, as in the table.
std::string print_all(const RenderSettings& settings) {
  std::string text;
  for (const Setting& each : all_settings())
    if (each.print && each.belongs_to(settings)) text += each.key + "=" + each.print(settings) + "\n";
  return text;
}

TEST(SettingsPrint, AllOfThemInTheirOrderMakeTheSameScene) {
  std::mt19937_64 random(3);
  const std::vector<std::string> texts = candidates(random);
  for (int i = 0; i < 100; ++i) {
    RenderSettings settings, again;
    for (int k = 0; k < 200; ++k) {
      const Setting& setting = all_settings()[random() % all_settings().size()];
      const auto& choices = setting.choices.empty() ? texts : setting.choices;
      // What a setting refuses is not set.
      [[maybe_unused]] const auto done = setting.apply(settings, choices[random() % choices.size()]);
    }
    for (const Setting& each : all_settings()) {
      if (!each.print || !each.belongs_to(settings)) continue;
      const auto done = each.apply(again, each.print(settings));
      ASSERT_TRUE(done) << each.key << ": " << done.error().message;
    }
    EXPECT_EQ(print_all(again), print_all(settings));
  }
}

TEST(SettingsPrint, EachSaysWhatItTakesAndWhoHasIt) {
  for (const Setting& setting : all_settings())
    EXPECT_FALSE(setting.values.empty() || setting.description.empty()) << setting.key;
  EXPECT_EQ(find_setting("integrator.rr_depth")->values, "1 or more");
  EXPECT_EQ(setting_default(*find_setting("integrator.rr_depth")), "2; whitted: 5; photonmapper: 5; ppm: 5");
  EXPECT_THAT(integrators_with(*find_setting("integrator.rr_depth")),
              ElementsAre("path", "whitted", "volpath", "photonmapper", "ppm"));
  EXPECT_THAT(integrators_with(*find_setting("integrator.trace_shadows")),
              ElementsAre("direct", "polygon_area"));
  EXPECT_THAT(integrators_with(*find_setting("film.rfilter_stddev")), IsEmpty());
  EXPECT_EQ(find_setting("film.rfilter_stddev")->values, "at least 0.0001 and below 1024");
  EXPECT_EQ(setting_default(*find_setting("film.rfilter_stddev")), "0.5");
}

}  // namespace
}  // namespace penumbra
