#include "gl/composite_pass.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "gl/worker_colors.h"
#include "scheduler/image/metrics/color_map.h"
#include "scheduler/image/tone_map.h"
#include "tests/gl/hidden_window.h"
#include "tests/gl/random_film.h"

namespace penumbra {
namespace {

constexpr int kWidth = 37, kHeight = 23;
constexpr double kRounding = 1.0 / (1 << 23);  // of a GPU's operation, which may round either way
// A byte is the nearest to the signal; half of one more for the pow() of the driver.
constexpr double kByte = 1.0;

using Color = std::array<double, 3>;

double byte_of(double signal) { return 255 * std::clamp(signal, 0.0, 1.0); }

class CompositePassTest : public HiddenWindowTest {
 protected:
  void SetUp() override {
    HiddenWindowTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    make_film(kWidth, kHeight);
    auto pass = CompositePass::create();
    ASSERT_TRUE(pass.has_value()) << pass.error().message;
    pass_ = std::make_unique<CompositePass>(std::move(*pass));
    g_ = random_floats(3 * kWidth * kHeight, 0, 2, 100);
    e_ = random_floats(3 * kWidth * kHeight, 0, 2, 200);
    g_texture_ = texture_of(g_, kWidth, kHeight);
    e_texture_ = texture_of(e_, kWidth, kHeight);
  }
  void TearDown() override {
    pass_.reset();
    film_.reset();
    g_texture_ = {};
    e_texture_ = {};
    HiddenWindowTest::TearDown();
  }

  void make_film(int width, int height) {
    auto film = FilmTextures::create(width, height);
    ASSERT_TRUE(film.has_value()) << film.error().message;
    film_ = std::make_unique<FilmTextures>(std::move(*film));
  }
  /// A film of one colour a pixel, with the standard error for all of them.
  void fill_film(int width, int height, const std::function<Color(int, int)>& color, float error = 0.1f,
                 std::uint32_t samples = 16) {
    make_film(width, height);
    TileSnapshot tile = random_tile(0, 0, width, height, 1, samples);
    for (int i = 0; i < width * height; ++i) {
      const Color value = color(i % width, i / width);
      for (std::size_t c = 0; c < 3; ++c) tile.radiance[3 * std::size_t(i) + c] = float(value[c]);
      tile.standard_error[std::size_t(i)] = error;
    }
    ASSERT_TRUE(film_->apply(tile));
  }

  AnalyticTextures analytic() const { return {g_texture_.name(), e_texture_.name()}; }
  std::vector<float> linear(const DisplaySettings& settings, const AnalyticTextures& textures) {
    EXPECT_TRUE(pass_->compose(*film_, textures, settings).has_value());
    return pass_->read_linear();
  }
  std::vector<std::uint8_t> display(const DisplaySettings& settings, const AnalyticTextures& textures = {}) {
    EXPECT_TRUE(pass_->compose(*film_, textures, settings).has_value());
    const auto bytes = pass_->read_display(*film_, settings);
    EXPECT_TRUE(bytes.has_value());
    return bytes.value_or(std::vector<std::uint8_t>{});
  }
  /// What the window shows with the picture in `area`.
  std::vector<std::uint8_t> shown(const DisplaySettings& settings, const PixelRectangle& area,
                                  std::span<const WorkerView> workers = {}) {
    EXPECT_TRUE(pass_->compose(*film_, {}, settings).has_value());
    window_->begin_frame();
    place_ = pass_->show(*film_, settings, workers,
                         {window_->framebuffer(), window_->width(), window_->height(), area, 1});
    window_->end_frame();
    return window_->read_pixels().rgb;
  }
  std::array<int, 3> pixel(const std::vector<std::uint8_t>& bytes, int x, int y, int width) const {
    const std::size_t at = 3 * (std::size_t(y) * std::size_t(width) + std::size_t(x));
    return {bytes[at], bytes[at + 1], bytes[at + 2]};
  }

  std::unique_ptr<FilmTextures> film_;
  std::unique_ptr<CompositePass> pass_;
  std::vector<float> g_, e_;
  Texture g_texture_, e_texture_;
  PixelRectangle place_;
};

constexpr std::array<int, 3> kMagenta{255, 0, 255};

TEST_F(CompositePassTest, TheHybridIsTheClosedFormAndWhatSamplesAddToIt) {
  // Samples in the left part only.
  const TileSnapshot tile = random_tile(0, 0, 20, kHeight, 1);
  ASSERT_TRUE(film_->apply(tile));
  for (const float alpha : {0.0f, 1.0f, -0.7f, 1.9f}) {
    const auto values = linear({.alpha = alpha}, analytic());
    ASSERT_EQ(values.size(), g_.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double g = double(g_[i]), e = double(e_[i]), d = double(film_->difference()[i]);
      const bool sampled = int(i / 3) % kWidth < 20;
      const double truth = sampled ? double(alpha) * g + d + e : g + e;
      const double bound = 3 * kRounding * (std::abs(double(alpha)) * g + g + std::abs(d) + e);
      ASSERT_NEAR(double(values[i]), truth, bound) << i;
    }
  }
}

TEST_F(CompositePassTest, LayersAreTheirLinearValues) {
  const TileSnapshot tile = random_tile(0, 0, kWidth, kHeight, 1);
  ASSERT_TRUE(film_->apply(tile));
  EXPECT_EQ(linear({}, {}), tile.radiance) << "without a closed form: the image itself, bit for bit";
  EXPECT_EQ(linear({.layer = Layer::kDifference}, analytic()), tile.difference);
  const auto errors = linear({.layer = Layer::kError}, analytic());
  for (std::size_t i = 0; i < errors.size(); ++i) ASSERT_EQ(errors[i], tile.standard_error[i / 3]);
  const auto closed = linear({.layer = Layer::kAnalytic, .alpha = 0.3f}, analytic());
  for (std::size_t i = 0; i < closed.size(); ++i)
    ASSERT_NEAR(double(closed[i]), double(g_[i]) + double(e_[i]), kRounding * double(g_[i] + e_[i]))
        << "whatever alpha is";
}

TEST_F(CompositePassTest, AClosedFormOfAnotherSizeCountsAsNone) {
  ASSERT_TRUE(film_->apply(random_tile(0, 0, kWidth, kHeight, 1)));
  const Texture small = texture_of(random_floats(12, 0, 1, 7), 2, 2);
  EXPECT_EQ(linear({}, {small.name(), small.name()}), linear({}, {}));
}

TEST_F(CompositePassTest, ToneMapsAreTheFormulas) {
  ASSERT_TRUE(film_->apply(random_tile(0, 0, kWidth, kHeight, 3)));
  for (const ToneMap tone_map : {ToneMap::kClamp, ToneMap::kReinhard, ToneMap::kFilmic}) {
    for (const float exposure : {-3.0f, 0.0f, 2.5f}) {
      const auto bytes = display({.tone_map = tone_map, .exposure = exposure});
      for (std::size_t i = 0; i < bytes.size(); ++i) {
        const std::size_t first = i / 3 * 4;
        const auto at = [&](std::size_t c) {
          return double(film_->radiance()[first + c]) * std::exp2(double(exposure));
        };
        double x = at(i % 3);
        if (tone_map == ToneMap::kReinhard) x /= 1 + 0.2126 * at(0) + 0.7152 * at(1) + 0.0722 * at(2);
        if (tone_map == ToneMap::kFilmic) x = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
        ASSERT_NEAR(bytes[i], byte_of(srgb_from_linear(std::clamp(x, 0.0, 1.0))), kByte)
            << int(tone_map) << " at exposure " << exposure;
      }
    }
  }
}

TEST_F(CompositePassTest, ExtremesOfRadianceAreWhiteOrBlackAndNeverMagenta) {
  constexpr std::array<float, 6> kValues{3e38f, 1e20f, 1e-20f, 1e-42f, -1.0f, -3e38f};
  fill_film(6, 1, [&](int x, int) {
    const double v = double(kValues[std::size_t(x)]);
    return Color{v, v, v};
  });
  for (const ToneMap tone_map : {ToneMap::kClamp, ToneMap::kReinhard, ToneMap::kFilmic}) {
    for (const float exposure : {-10.0f, 0.0f, 10.0f}) {
      const auto bytes = display({.tone_map = tone_map, .exposure = exposure});
      for (int x = 0; x < 6; ++x) {
        const int expected = x < 2 ? 255 : 0;
        EXPECT_EQ(pixel(bytes, x, 0, 6), (std::array{expected, expected, expected}))
            << x << " " << int(tone_map);
      }
    }
  }
}

TEST_F(CompositePassTest, TheDifferenceIsGreyAtZeroAndHasEitherSign) {
  TileSnapshot tile = random_tile(0, 0, kWidth, kHeight, 5);
  tile.difference[0] = tile.difference[1] = tile.difference[2] = 0;
  ASSERT_TRUE(film_->apply(tile));
  const auto bytes = display({.layer = Layer::kDifference, .exposure = 1}, analytic());
  EXPECT_NEAR(bytes[0], 127.5, 0.5);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const double x = 2 * double(tile.difference[i]);
    const double signal = 0.5 + 0.5 * std::copysign(srgb_from_linear(std::min(std::abs(x), 1.0)), x);
    ASSERT_NEAR(bytes[i], byte_of(signal), kByte);
  }
}

TEST_F(CompositePassTest, ErrorsAreColoursOverTheirLogarithm) {
  const TileSnapshot tile = random_tile(0, 0, kWidth, kHeight, 9);
  ASSERT_TRUE(film_->apply(tile));
  for (const bool relative : {true, false}) {
    const auto bytes = display({.layer = Layer::kError, .exposure = 1, .relative_error = relative});
    for (std::size_t p = 0; p < tile.pixels(); ++p) {
      double square = 0;
      for (std::size_t c = 0; c < 3; ++c) square += std::pow(double(tile.radiance[3 * p + c]), 2) / 3;
      const double value = double(tile.standard_error[p]) * (relative ? 1 / std::sqrt(square) : 2.0);
      const double t = relative ? (std::log10(value) + 3) / 3 : (std::log10(value) + 4) / 4;
      // Between two entries of 256 the table's colours are all but straight.
      const auto color = heat_color(std::clamp(t, 0.0, 1.0));
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(bytes[3 * p + c], byte_of(srgb_from_linear(std::clamp(double(color[c]), 0.0, 1.0))), 1.5)
            << p;
    }
  }
}

TEST_F(CompositePassTest, OneSampleHasNoErrorYetAndAMissingNumberIsMagenta) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  fill_film(
      2, 2,
      [](int, int) {
        return Color{1, 1, 1};
      },
      kNan, 1);
  const auto one = pixel(display({.layer = Layer::kError}), 0, 0, 2);
  EXPECT_EQ(one[0], one[2]) << "grey";
  EXPECT_LT(one[0], 64);
  fill_film(
      2, 2,
      [](int, int) {
        return Color{1, 1, 1};
      },
      kNan, 2);
  EXPECT_EQ(pixel(display({.layer = Layer::kError}), 0, 0, 2), kMagenta);
}

TEST_F(CompositePassTest, NanAndInfinityAreMagentaAtAnySize) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto color = [](int x, int y) {
    if (x == 3 && y == 2) return Color{0.2, std::nan(""), 0.2};
    if (x == 20 && y == 10) return Color{kInfinity, 0, 0};
    if (x == 30 && y == 20) return Color{0, 0, -kInfinity};
    return Color{0.2, 0.2, 0.2};
  };
  fill_film(40, 30, color);
  const auto bytes = display({});
  int magenta = 0;
  for (int i = 0; i < 1200; ++i) magenta += pixel(bytes, i % 40, i / 40, 40) == kMagenta ? 1 : 0;
  EXPECT_EQ(magenta, 3);
  EXPECT_EQ(pixel(bytes, 3, 2, 40), kMagenta) << "the top row is first";
  const auto small = shown({}, {0, 0, 10, 10});  // 10 × 7.5
  ASSERT_EQ(place_.width, 10);
  magenta = 0;
  for (int i = 0; i < 100; ++i) magenta += pixel(small, i % 10, i / 10, window_->width()) == kMagenta ? 1 : 0;
  EXPECT_GE(magenta, 3);
}

TEST_F(CompositePassTest, WithoutSamplesThereIsADimCheckerboard) {
  const auto bytes = shown({}, {0, 0, 370, 230});
  std::array<int, 256> counts{};
  for (int i = 0; i < 370 * 230; ++i) {
    const auto [r, g, b] = pixel(bytes, i % 370, i / 370, window_->width());
    ASSERT_TRUE(r == g && g == b && r < 64);
    ++counts[std::size_t(r)];
  }
  int levels = 0;
  for (const int count : counts) levels += count > 30000 ? 1 : 0;
  EXPECT_EQ(levels, 2);
}

TEST_F(CompositePassTest, TheFilmIsLetterboxedAndItsPixelsAreSquaresWhenMagnified) {
  fill_film(2, 1, [](int x, int) { return x == 0 ? Color{1, 0, 0} : Color{0, 0, 1}; });
  const auto bytes = shown({}, {20, 10, 100, 100});
  EXPECT_EQ(place_, (PixelRectangle{20, 35, 100, 50}));
  const auto background = pixel(bytes, 0, 0, window_->width());
  for (int y = 0; y < 150; ++y) {
    for (int x = 0; x < 150; ++x) {
      const bool inside = x >= 20 && x < 120 && y >= 35 && y < 85;
      const auto expected = !inside ? background : x < 70 ? std::array{255, 0, 0} : std::array{0, 0, 255};
      ASSERT_EQ(pixel(bytes, x, y, window_->width()), expected) << x << ", " << y;
    }
  }
}

TEST_F(CompositePassTest, AFilmThatIsMadeSmallerIsTheMeanBelowEachPixel) {
  make_film(64, 48);
  TileSnapshot tile = random_tile(0, 0, 64, 40, 4);  // nothing in the last rows
  for (float& value : tile.radiance) value *= 0.4f;
  ASSERT_TRUE(film_->apply(tile));
  for (const auto& [width, height] : {std::array{16, 12}, std::array{20, 15}, std::array{12, 9}}) {
    const auto bytes = shown({}, {5, 3, width, height});
    ASSERT_EQ(place_, (PixelRectangle{5, 3, width, height}));
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        Color sum{};
        double weights = 0;
        for (int v = 0; v < 40; ++v) {
          for (int u = 0; u < 64; ++u) {
            const auto overlap = [](int i, int film, int screen, int at) {
              const double low = double(at) * film / screen, high = double(at + 1) * film / screen;
              return std::max(0.0, std::min(i + 1.0, high) - std::max(double(i), low));
            };
            const double weight = overlap(u, 64, width, x) * overlap(v, 48, height, y);
            weights += weight;
            for (std::size_t c = 0; c < 3; ++c)
              sum[c] += weight * double(tile.radiance[3 * (std::size_t(v) * 64 + std::size_t(u)) + c]);
          }
        }
        const auto found = pixel(bytes, 5 + x, 3 + y, window_->width());
        if (weights == 0) {
          EXPECT_LT(found[0], 64);
          continue;
        }
        for (std::size_t c = 0; c < 3; ++c)
          ASSERT_NEAR(found[c], byte_of(srgb_from_linear(std::min(sum[c] / weights, 1.0))), kByte)
              << x << ", " << y;
      }
    }
  }
}

TEST_F(CompositePassTest, OutlinesAreTheWorkersColoursAndLeaveTheRestAlone) {
  fill_film(40, 30, [](int x, int y) { return Color{x / 40.0, y / 30.0, 0.5}; });
  std::vector<WorkerView> workers(2);
  workers[0].number = 3;
  workers[0].x = 8, workers[0].y = 4, workers[0].width = 16, workers[0].height = 8;
  workers[1].number = 4;                      // idle
  const PixelRectangle area{7, 9, 400, 300};  // ten times
  const auto plain = shown({}, area, workers);
  const auto outlined = shown({.outlines = true}, area, workers);
  const auto color = worker_color(3);
  for (int y = 0; y < 320; ++y) {
    for (int x = 0; x < 420; ++x) {
      const int u = x - 7 - 80, v = y - 9 - 40;  // in the tile, of 160 × 80
      const int depth = std::min(std::min(u, v), std::min(159 - u, 79 - v));
      const auto found = pixel(outlined, x, y, window_->width());
      if (depth == 0 || depth == 1) {
        for (std::size_t c = 0; c < 3; ++c)
          ASSERT_NEAR(found[c], 255 * double(color[c]), kByte) << x << ", " << y;
      } else if (depth != 2) {  // that is the dark line
        ASSERT_EQ(found, pixel(plain, x, y, window_->width())) << x << ", " << y;
      }
    }
  }
}

}  // namespace
}  // namespace penumbra
