#include "gl/overlay.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <set>

#include "gl/composite_pass.h"
#include "gl/overlay_strip.h"
#include "gl/overlay_text.h"
#include "kernels/host/atomic_file.h"
#include "scheduler/image/image.h"
#include "scheduler/image/image_files.h"
#include "scheduler/image/metrics/color_space.h"
#include "tests/gl/hidden_window.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

ViewStatus connected_status() {
  ViewStatus status;
  status.connection = ConnectionState::kConnected;
  status.address = "unix:/run/user/1000/penumbra/preview.sock";
  status.scene = "scenes/star-light/star-light.xml";
  status.integrator = "polygon_cv";
  status.hybrid = status.interactive = true;
  status.film_width = 600;
  status.film_height = 400;
  status.samples_done = 8880000;
  status.samples_total = 61440000;
  status.spp_done = 37;
  status.spp_wanted = 256;
  status.samples_per_second = 12.34e6;
  status.seconds_left = 83;
  status.relative_error = 0.0231;
  status.latency_seconds = 0.035;
  status.frames_per_second = 59.9;
  status.analytic_frames = 16;
  status.has_camera = true;
  status.scene_spp = 64;
  status.named_layers = {"albedo", "normal", "depth", "samples", "variance"};
  status.reference = "kept at 16 samples of scenes/star-light/star-light.xml";
  for (std::uint32_t i = 0; i < 4; ++i) {
    status.workers.push_back({.number = i,
                              .name = fmt::format("local-{}", i),
                              .device = i < 3 ? "native AVX-512" : "OpenCL PoCL",
                              .x = int(i) * 150,
                              .y = int(i) * 80,
                              .width = i == 2 ? 0 : 150,
                              .height = i == 2 ? 0 : 80,
                              .units = 12 + 1000 * i});
  }
  status.messages = {"connected to the scheduler", "worker local-3 has joined",
                     "warning: worker local-1 was lost; its unit is done again"};
  return status;
}

struct Case {
  std::string name;
  ViewStatus status;
  DisplaySettings settings;
};

/// 1 to 10: 3 failed, 4 is missing, 8 is older than its scene, 9 and 10 are to come.
ShotStatus ten_frames() {
  ShotStatus shot{.fps = 24};
  for (int frame = 1; frame <= 10; ++frame)
    shot.frames.push_back({frame, FrameState::kThere, true, frame == 6 || frame == 7});
  shot.frames[2] = {3, FrameState::kFailed, false, false};
  shot.frames[3] = {4, FrameState::kMissing, false, false};
  shot.frames[7].state = FrameState::kWaiting;
  for (const std::size_t i : {8u, 9u}) shot.frames[i] = {int(i) + 1, FrameState::kWaiting, false, false};
  return shot;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  const ViewStatus connected = connected_status();
  all.push_back({"connected", connected, {.outlines = true}});

  ViewStatus starting;
  starting.address = connected.address;
  starting.seconds_left = starting.relative_error = starting.latency_seconds = kNan;
  all.push_back({"starting", starting, {}});

  ViewStatus lost = connected;
  lost.connection = ConnectionState::kLost;
  lost.messages.push_back("error: the scheduler at unix:/run/user/1000/penumbra/preview.sock went away");
  all.push_back({"lost", lost, {}});

  ViewStatus refused = starting;
  refused.connection = ConnectionState::kRefused;
  refused.messages = {"error: the scheduler is of version 0.2.0, this window of 0.1.0"};
  all.push_back({"refused", refused, {}});

  ViewStatus batch = connected;
  batch.hybrid = batch.interactive = false;
  batch.integrator = "path_mis";
  batch.finished = true;
  batch.spp_done = batch.spp_wanted;
  batch.samples_done = batch.samples_total;
  all.push_back({"batch", batch, {.layer = Layer::kError}});

  ViewStatus alone = connected;
  alone.workers.clear();
  alone.messages.clear();
  all.push_back({"no workers", alone, {.layer = Layer::kDifference}});

  ViewStatus busy = connected;
  for (int i = 0; i < 300; ++i)
    busy.messages.push_back(
        fmt::format("{}message {} of three hundred, which is longer than a line of the panel",
                    i % 7 == 0 ? "error: " : "", i));
  for (std::uint32_t i = 4; i < 64; ++i) {
    WorkerView worker = busy.workers[0];
    worker.number = i;
    worker.name = fmt::format("node{:02}.cluster.example.org-{}", i / 8, i % 8);
    busy.workers.push_back(worker);
  }
  all.push_back({"300 messages", busy, {}});
  ViewStatus file = alone;
  file.connection = ConnectionState::kFile;
  file.address.clear();
  file.scene = "out/a.exr";
  file.hybrid = file.interactive = file.has_camera = false;
  file.difference = Difference{0.01, 2e-3};
  file.pixel = PixelValue{12, 30, {0.1f, 0.2f, 0.3f}, "", 64, 0.01f};
  all.push_back(
      {"file", file, {.layer = Layer::kNamed, .named = "depth", .comparison = ShownComparison::kDifference}});

  ViewStatus shot = file;
  shot.scene = "out/shot.0012.exr";
  shot.shot = ten_frames();
  shot.shot->current = shot.shot->shown.emplace(7);
  all.push_back({"shot", shot, {}});
  shot.shot->plays = true;
  shot.shot->skipped = 3;
  shot.shot->shown_per_second = 11.9;
  for (int frame = 11; frame <= 5000; ++frame)
    shot.shot->frames.push_back({frame, FrameState::kThere, frame % 97 != 0, frame < 700});
  all.push_back({"long shot", shot, {}});
  shot.shot = ShotStatus{.fps = 24};
  all.push_back({"empty shot", shot, {}});

  all.push_back({"help", connected, {.help = true}});
  all.push_back({"no panel", lost, {.panel = false}});
  return all;
}

class OverlayTest : public HiddenWindowTest {
 protected:
  /// ImGui lays some things out over two frames, so three.
  OverlayResult frames(DisplaySettings& settings, const ViewStatus& status, int count = 3) {
    OverlayResult all;
    for (int i = 0; i < count; ++i) {
      window_->poll();
      window_->begin_frame();
      const OverlayResult result = draw_overlay(settings, status);
      if (draw_picture) draw_picture(result, settings, status);
      window_->end_frame();
      all.actions.insert(all.actions.end(), result.actions.begin(), result.actions.end());
      all.alpha_changed |= result.alpha_changed;
      all.picture_area = result.picture_area;
    }
    return all;
  }

  /// A picture with the tiles of the left half under way, for people to look at.
  void watch_picture() {
    draw_picture = nullptr;
    if (std::getenv("PENUMBRA_SCREENSHOTS") == nullptr) return;
    const auto image = read_image(PENUMBRA_SOURCE_DIR "/scenes/star-light/star-light.png");
    ASSERT_TRUE(image.has_value()) << image.error().message;
    const int width = image->data.width, height = image->data.height;
    auto film = FilmTextures::create(width, height);
    auto pass = CompositePass::create();
    ASSERT_TRUE(film.has_value() && pass.has_value());
    constexpr int kSize = 40;
    for (int y = 0; y + kSize <= height; y += kSize) {
      for (int x = 0; x + kSize <= width; x += kSize) {
        if (x > width / 2 && y > height / 2) continue;
        TileSnapshot tile;
        tile.x = x;
        tile.y = y;
        tile.width = tile.height = kSize;
        tile.samples = 16;
        for (int i = 0; i < kSize * kSize; ++i) {
          for (std::size_t c = 0; c < 3; ++c) {
            tile.radiance.push_back(float(linear_from_srgb(image->at(x + i % kSize, y + i / kSize, c))));
            tile.difference.push_back(0.2f * (tile.radiance.back() - 0.5f));
          }
          tile.standard_error.push_back(tile.radiance.back() * 0.4f * float(i % 7 + 1) * float(x) /
                                        float(width));
        }
        ASSERT_TRUE(film->apply(tile));
      }
    }
    shown_ = std::make_unique<Shown>(std::move(*film), std::move(*pass));
    draw_picture = [this](const OverlayResult& result, const DisplaySettings& settings,
                          const ViewStatus& status) {
      ASSERT_TRUE(shown_->pass.compose(shown_->film, {}, settings).has_value());
      shown_->pass.show(shown_->film, settings, status.workers,
                        {window_->framebuffer(), window_->width(), window_->height(), result.picture_area,
                         window_->content_scale()});
    };
  }
  void TearDown() override {
    shown_.reset();
    HiddenWindowTest::TearDown();
  }

  struct Shown {
    FilmTextures film;
    CompositePass pass;
  };
  std::unique_ptr<Shown> shown_;

  /// Into the folder that the environment names, for people to look at.
  void keep_screenshot(const std::string& name) {
    const char* folder = std::getenv("PENUMBRA_SCREENSHOTS");
    if (folder == nullptr) return;
    const auto png = encode_png_bytes(window_->width(), window_->height(), window_->read_pixels().rgb);
    ASSERT_TRUE(png.has_value()) << png.error().message;
    const auto written = write_file_atomically(std::filesystem::path(folder) / (name + ".png"), *png);
    ASSERT_TRUE(written.has_value()) << written.error().message;
  }

  std::function<void(const OverlayResult&, const DisplaySettings&, const ViewStatus&)> draw_picture;
};

struct Size {
  int width, height;
  float scale;
};

class OverlayAtSize : public OverlayTest, public testing::WithParamInterface<Size> {};

TEST_P(OverlayAtSize, EveryStateIsDrawnWithoutErrors) {
  const Size size = GetParam();
  open(size.width, size.height, size.scale);
  if (IsSkipped() || HasFatalFailure()) return;
  watch_picture();
  for (Case& one : cases()) {
    SCOPED_TRACE(one.name);
    const OverlayResult result = frames(one.settings, one.status);
    EXPECT_THAT(window_->take_gl_errors(), IsEmpty());
    EXPECT_THAT(result.actions, IsEmpty()) << "nothing was requested";
    EXPECT_FALSE(result.alpha_changed);
    EXPECT_LE(result.picture_area.width, size.width);
    EXPECT_GE(result.picture_area.width, int(0.4 * size.width));
    EXPECT_EQ(result.picture_area.height, size.height - int(strip_height(one.status)));
    EXPECT_GE(result.picture_area.height, size.height / 2);
    const std::vector<std::uint8_t> pixels = window_->read_pixels().rgb;
    ASSERT_EQ(pixels.size(), 3u * std::size_t(size.width) * std::size_t(size.height));
    const std::set<std::uint8_t> values(pixels.begin(), pixels.end());
    EXPECT_GT(values.size(), 8u) << "there is text";
    keep_screenshot(fmt::format("{}-{}x{}-{}", one.name, size.width, size.height, size.scale));
  }
}

TEST_P(OverlayAtSize, TheHelpFits) {
  const Size size = GetParam();
  if (float(size.width) < 600 * size.scale) GTEST_SKIP() << "the text would be too small";
  open(size.width, size.height, size.scale);
  if (IsSkipped() || HasFatalFailure()) return;
  DisplaySettings settings{.help = true};
  frames(settings, connected_status(), 8);
  const ImGuiWindow* help = ImGui::FindWindowByName("Help");
  ASSERT_NE(help, nullptr);
  EXPECT_LT(help->ScrollMax.y, 1) << "but for the rounding of its size";
  EXPECT_GE(help->Pos.y, 0);
  EXPECT_LE(help->Pos.y + help->Size.y, ImGui::GetIO().DisplaySize.y);
}

INSTANTIATE_TEST_SUITE_P(Sizes, OverlayAtSize,
                         testing::Values(Size{200, 150, 1}, Size{640, 480, 1}, Size{1280, 800, 1},
                                         Size{200, 150, 2}, Size{1600, 1000, 1.5f}, Size{2560, 1440, 2}),
                         [](const auto& tested) {
                           return fmt::format("{}x{}at{}percent", tested.param.width, tested.param.height,
                                              int(100 * tested.param.scale));
                         });

/// A person who presses the mouse everywhere on the panel, and what came of it.
class OverlayClicks : public OverlayTest {
 protected:
  static constexpr int kHeight = 1200;  // the whole panel
  /// A frame with the mouse there, laid out and not drawn: Window::begin_frame() would ask GLFW for the
  /// mouse.
  OverlayResult frame_with_mouse(float x, float y, bool down) {
    ImGui::GetIO().MousePos = {x, y};
    ImGui::GetIO().MouseDown[0] = down;
    // Headings that an earlier click has folded are open again.
    for (ImGuiWindow* window : ImGui::GetCurrentContext()->Windows) window->StateStorage.Clear();
    ImGui::NewFrame();
    const OverlayResult result = draw_overlay(settings_, status_);
    ImGui::EndFrame();
    return result;
  }
  void click_everywhere() {
    open(700, kHeight, 1);
    if (IsSkipped() || HasFatalFailure()) return;
    frames(settings_, status_, 1);
    for (const float column : {60.0f, 100.0f, 130.0f, 168.0f, 200.0f, 280.0f}) {
      for (float y = 4; y < kHeight; y += 9) {
        settings_.help = false;
        settings_.panel = true;
        const float x = 700 - 348 + column;
        for (const bool down : {false, true, false}) note(frame_with_mouse(x, y, down));
        frame_with_mouse(1, kHeight - 1, false);
        note(frame_with_mouse(1, kHeight - 1, true));  // closes what has opened
        frame_with_mouse(1, kHeight - 1, false);
      }
    }
  }
  void note(const OverlayResult& result) {
    actions_.insert(result.actions.begin(), result.actions.end());
    alpha_changed_ |= result.alpha_changed;
    layers_.insert(settings_.layer);
    helped_ |= settings_.help;
    hid_ |= !settings_.panel;
    refined_ |= settings_.automatic;
  }

  DisplaySettings settings_;
  ViewStatus status_ = connected_status();
  std::set<Action> actions_;
  std::set<Layer> layers_;
  bool alpha_changed_ = false, helped_ = false, hid_ = false, refined_ = false;
};

TEST_F(OverlayClicks, ReachEverythingInAPreview) {
  click_everywhere();
  if (IsSkipped()) return;
  EXPECT_THAT(actions_, ElementsAre(Action::kOneMoreSample, Action::kZoomIn, Action::kZoomOut,
                                    Action::kActualSize, Action::kKeepReference, Action::kResetCamera,
                                    Action::kReload, Action::kSave, Action::kCopyView));
  EXPECT_THAT(layers_, ElementsAre(Layer::kComposite, Layer::kAnalytic, Layer::kDifference, Layer::kError));
  EXPECT_TRUE(alpha_changed_ && helped_ && hid_ && refined_);
  EXPECT_NE(settings_.exposure, 0.0f);
  EXPECT_NE(settings_.comparison, ShownComparison::kNone);
}

TEST_F(OverlayClicks, ReachEachFrameOfAShot) {
  status_.connection = ConnectionState::kFile;
  status_.shot = ten_frames();
  settings_.panel = false;
  open(700, 500, 1);
  if (IsSkipped() || HasFatalFailure()) return;
  frames(settings_, status_, 2);
  // Below the text the bar is as wide as the window without its padding of 10.
  const float top = 500 - strip_height(status_) + 7, bar = top + ImGui::GetTextLineHeight() + 6 + 7;
  for (int frame = 1; frame <= 10; ++frame) {
    const float x = 10 + 68 * (float(frame) - 0.5f);
    frame_with_mouse(x, bar, false);
    EXPECT_EQ(frame_with_mouse(x, bar, true).frame, frame);
    EXPECT_FALSE(frame_with_mouse(x, bar, false).frame.has_value());
  }
  frame_with_mouse(15, bar, false);
  frame_with_mouse(15, bar, true);
  EXPECT_EQ(frame_with_mouse(2000, bar, true).frame, 10) << "a drag goes on outside";
  frame_with_mouse(2000, bar, false);
  frame_with_mouse(15, top + 6, false);
  frame_with_mouse(15, top + 6, true);
  EXPECT_THAT(frame_with_mouse(15, top + 6, false).actions, ElementsAre(Action::kOneMoreSample));
}

TEST_F(OverlayClicks, DoNothingThatABatchRenderDoesNotHave) {
  status_.hybrid = status_.interactive = status_.has_camera = false;
  click_everywhere();
  if (IsSkipped()) return;
  EXPECT_THAT(actions_, ElementsAre(Action::kZoomIn, Action::kZoomOut, Action::kActualSize,
                                    Action::kKeepReference, Action::kSave));
  EXPECT_THAT(layers_, ElementsAre(Layer::kComposite, Layer::kError));
  EXPECT_TRUE(helped_ && hid_);
  EXPECT_FALSE(alpha_changed_ || refined_);
  EXPECT_EQ(settings_.alpha, 1.0f);
}

TEST_F(OverlayClicks, NeverAskForSamplesWithoutAConnection) {
  status_.connection = ConnectionState::kLost;
  click_everywhere();
  if (IsSkipped()) return;
  EXPECT_THAT(actions_, testing::Not(testing::Contains(Action::kOneMoreSample)));
}

TEST_F(OverlayTest, NoFileIsLeftBehind) {
  DisplaySettings settings;
  frames(settings, connected_status());
  EXPECT_EQ(ImGui::GetIO().IniFilename, nullptr);
  window_.reset();
  EXPECT_FALSE(std::filesystem::exists("imgui.ini"));
}

}  // namespace
}  // namespace penumbra
