#include "gl/composite_pass.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "gl/tile_outlines.h"
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

constexpr std::array kToneOperators{ToneOperator::kClamp, ToneOperator::kReinhard, ToneOperator::kFilmic,
                                    ToneOperator::kAces};
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
  for (const ToneOperator tone_map : kToneOperators) {
    for (const float exposure : {-3.0f, 0.0f, 2.5f}) {
      const auto bytes = display({.tone_map = tone_map, .exposure = exposure});
      for (std::size_t i = 0; i < bytes.size(); ++i) {
        const std::size_t first = i / 3 * 4;
        const auto at = [&](std::size_t c) {
          return double(film_->radiance()[first + c]) * std::exp2(double(exposure));
        };
        const double x = tone_mapped(tone_map, {at(0), at(1), at(2)})[i % 3];
        ASSERT_NEAR(bytes[i], byte_of(srgb_from_linear(x)), kByte)
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
  for (const ToneOperator tone_map : kToneOperators) {
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

// A light of 9 in a quarter of the pixel before a surface of 0.2: a mean of the light's and the surface's
// tone maps. The tone map of the mean, 2.4, would be as white as the light.
TEST_F(CompositePassTest, EdgesOfLightsAreAntialiasedAfterTheToneMap) {
  constexpr double kCovered = 0.25, kLight = 9, kSurface = 0.2;
  fill_film(
      3, 1,
      [](int, int) {
        return Color{0, 0, 0};
      },
      0.1f, 0);
  const std::vector<float> g(9, float(kSurface * (1 - kCovered)));
  const Texture closed_form = texture_of(g, 3, 1);
  std::vector<float> e;
  for (int c = 0; c < 3; ++c) e.push_back(float(kLight * kCovered));
  e.push_back(float(kCovered));
  e.insert(e.end(), {0, 0, 0, 0});
  e.insert(e.end(), {float(kLight), float(kLight), float(kLight), 1});
  const Texture emission = make_texture(GL_RGBA32F, 3, 1, GL_RGBA, GL_FLOAT);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 3, 1, GL_RGBA, GL_FLOAT, e.data());
  for (const ToneOperator tone_map : kToneOperators) {
    const auto bytes = display({.tone_map = tone_map}, {closed_form.name(), emission.name()});
    const auto mapped = [&](double x) { return tone_mapped(tone_map, {x, x, x})[0]; };
    const double edge = kCovered * mapped(kLight) + (1 - kCovered) * mapped(kSurface);
    EXPECT_NEAR(pixel(bytes, 0, 0, 3)[1], byte_of(srgb_from_linear(edge)), kByte) << int(tone_map);
    EXPECT_NEAR(pixel(bytes, 1, 0, 3)[1], byte_of(srgb_from_linear(mapped(0.15))), kByte);
    EXPECT_NEAR(pixel(bytes, 2, 0, 3)[1], byte_of(srgb_from_linear(mapped(9.15))), kByte);
  }
}

TEST_F(CompositePassTest, FalseColourIsTheLogarithmOfLuminance) {
  fill_film(5, 1, [](int x, int) {
    const double v = std::pow(10.0, x - 3);
    return Color{v, v, v};
  });
  for (const float exposure : {0.0f, -1.0f}) {
    const auto bytes = display({.false_color = true, .exposure = exposure});
    for (int x = 0; x < 5; ++x) {
      const double t = (x - 3 + double(exposure) * std::log10(2.0) + 3) / 5;
      const auto color = heat_color(std::clamp(t, 0.0, 1.0));
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(pixel(bytes, x, 0, 5)[c],
                    byte_of(srgb_from_linear(std::clamp(double(color[c]), 0.0, 1.0))), 1.5);
    }
  }
}

LayeredPicture picture_of(PictureLayer layer, int width, int height) {
  LayeredPicture picture{
      .name = "p", .width = width, .height = height, .area = {0, 0, width, height}, .layers = {}};
  picture.layers.push_back(std::move(layer));
  return picture;
}

TEST_F(CompositePassTest, NamedLayersAreShownByTheirKind) {
  make_film(4, 1);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const auto bytes_of = [&](const PictureLayer& layer) {
    const LayeredPicture picture = picture_of(layer, 4, 1);
    const DisplaySettings settings{.layer = Layer::kNamed, .named = layer.name};
    EXPECT_TRUE(pass_->compose(*film_, {}, settings, &picture).has_value());
    return pass_->read_display(*film_, settings).value();
  };
  const auto normal =
      bytes_of(make_layer("normal", LayerKind::kNormal, {0, 0, 1, 0, -1, 0, 1, 0, 0, 0, 0, 0}, 3));
  EXPECT_EQ(pixel(normal, 1, 0, 4), (std::array{128, 0, 128}));
  EXPECT_EQ(pixel(normal, 2, 0, 4), (std::array{255, 128, 128}));

  PictureLayer depth = make_layer("depth", LayerKind::kQuantity, {1, 10, 100, kNan}, 1);
  EXPECT_EQ(depth.least, 1);
  EXPECT_EQ(depth.most, 100);
  for (const bool has_gaps : {false, true}) {
    depth.has_gaps = has_gaps;
    const auto bytes = bytes_of(depth);
    for (int x = 0; x < 3; ++x) {
      const auto color = heat_color(0.5 * x);
      EXPECT_NEAR(pixel(bytes, x, 0, 4)[1], byte_of(srgb_from_linear(double(color[1]))), 1.5);
    }
    EXPECT_EQ(pixel(bytes, 3, 0, 4) == kMagenta, !has_gaps);
  }

  const auto ids = bytes_of(make_layer("shape", LayerKind::kIdentity, {1, 2, 1, 3}, 1));
  EXPECT_EQ(pixel(ids, 0, 0, 4), pixel(ids, 2, 0, 4));
  EXPECT_NE(pixel(ids, 0, 0, 4), pixel(ids, 1, 0, 4));
  EXPECT_NE(pixel(ids, 1, 0, 4), pixel(ids, 3, 0, 4));
}

TEST_F(CompositePassTest, AComparisonIsOfTheLayerAndItsReference) {
  fill_film(2, 1, [](int x, int) { return Color{1.0 + x, 1.0 + x, 1.0 + x}; });
  const PictureLayer reference = make_layer("image", LayerKind::kColor, {0.5f, 0.5f, 0.5f, 4, 4, 4}, 3);
  const auto compared = [&](ShownComparison comparison) {
    EXPECT_TRUE(pass_->compose(*film_, {}, {.comparison = comparison}).has_value());
    const Difference difference = pass_->compare(reference, {0, 0, 2, 1}, comparison);
    EXPECT_NEAR(difference.mean, (0.5 - 2) / 2, 1e-12);
    EXPECT_NEAR(difference.relmse, (0.25 / 0.26 + 4 / 16.01) / 2, 1e-7);
    return pass_->read_linear();
  };
  EXPECT_EQ(compared(ShownComparison::kNone), (std::vector<float>{1, 1, 1, 2, 2, 2}));
  EXPECT_EQ(compared(ShownComparison::kReference), reference.values);
  EXPECT_EQ(compared(ShownComparison::kDifference), (std::vector<float>{0.5f, 0.5f, 0.5f, -2, -2, -2}));
  const auto relative = compared(ShownComparison::kRelativeError);
  EXPECT_NEAR(relative[0], 0.5 / 0.51, 1e-6);
  EXPECT_NEAR(relative[5], 2 / 4.01, 1e-6);
  EXPECT_EQ(pass_->shown().display, Display::kHeat);
}

// A picture larger than its area shows the part that the view says, and nothing beside the area.
TEST_F(CompositePassTest, AMagnifiedPartIsThatPart) {
  fill_film(8, 6, [](int x, int y) { return Color{x / 8.0, y / 6.0, 0.5}; });
  const PixelRectangle area{100, 50, 40, 30};
  const auto bytes = shown({.view = {.zoom = 10, .x = 0.5, .y = 0.5}}, area);
  EXPECT_EQ(place_, (PixelRectangle{80, 35, 80, 60}));
  for (int y = 50; y < 80; ++y) {
    for (int x = 100; x < 140; ++x) {
      const int column = (x - 80) / 10, row = (y - 35) / 10;
      ASSERT_NEAR(pixel(bytes, x, y, window_->width())[0], byte_of(srgb_from_linear(column / 8.0)), kByte);
      ASSERT_NEAR(pixel(bytes, x, y, window_->width())[1], byte_of(srgb_from_linear(row / 6.0)), kByte);
    }
  }
  const auto background = pixel(bytes, 1, 1, window_->width());
  for (const auto& [x, y] : {std::pair{99, 60}, {140, 60}, {120, 49}, {120, 80}})
    EXPECT_EQ(pixel(bytes, x, y, window_->width()), background) << x << ", " << y;
}

}  // namespace
}  // namespace penumbra
