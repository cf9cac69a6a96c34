// Messages for watchers: what is encoded can be decoded again, and invalid messages are refused.
#include "scheduler/watch/watch_wire.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>

#include "tests/scheduler/watch/watched_run.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// As it comes out of the other end of a stream.
wire::WatchEvent sent(const wire::WatchEvent& event) {
  wire::WatchEvent arrived;
  EXPECT_TRUE(arrived.ParseFromString(event.SerializeAsString()));
  return arrived;
}

WatchedJob some_job() {
  return {.title = "a scene.xml",
          .integrator = "polygon_cv",
          .film_width = 200,
          .film_height = 150,
          .x = 8,
          .y = 4,
          .width = 120,
          .height = 100,
          .spp = 4000000000u,
          .scene_hash = std::string(64, 'a'),
          .center = {1e300, -0.5, 3},
          .interactive = true,
          .hybrid = true,
          .command = "penumbra render 'a scene.xml'",
          .scene_spp = 64,
          .layers = {"albedo", "matte"}};
}

TileSnapshot some_tile(bool hybrid = true) {
  TileSnapshot tile;
  tile.view = 4000000000u;
  tile.x = 40;
  tile.y = 20;
  tile.width = 3;
  tile.height = 2;
  tile.samples = 9;
  tile.worker = 7;
  for (int i = 0; i < 18; ++i) tile.radiance.push_back(float(i) / 7 - 1);
  tile.radiance[3] = kNan;
  tile.radiance[4] = -0.0f;
  if (hybrid) tile.difference = {tile.radiance.rbegin(), tile.radiance.rend()};
  tile.standard_error = {1, kNan, 3, 1e-40f, std::numeric_limits<float>::infinity(), 0};
  return tile;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return std::ranges::equal(a, b, {}, std::bit_cast<std::uint32_t, float>,
                            std::bit_cast<std::uint32_t, float>);
}

TEST(WatchWire, AJobArrivesAsItIs) {
  const WatchedJob job = some_job();
  const wire::WatchEvent event = sent(encode(job));
  ASSERT_TRUE(event.has_job());
  const Expected<WatchedJob> came = decode(event.job());
  ASSERT_TRUE(came) << came.error().message;
  EXPECT_EQ(came->title, job.title);
  EXPECT_EQ(came->integrator, job.integrator);
  EXPECT_EQ(came->film_width, job.film_width);
  EXPECT_EQ(came->command, job.command);
  EXPECT_EQ(came->scene_spp, job.scene_spp);
  EXPECT_EQ(came->layers, job.layers);
  EXPECT_EQ(came->film_height, job.film_height);
  EXPECT_EQ(came->x, job.x);
  EXPECT_EQ(came->y, job.y);
  EXPECT_EQ(came->width, job.width);
  EXPECT_EQ(came->height, job.height);
  EXPECT_EQ(came->spp, job.spp);
  EXPECT_EQ(came->scene_hash, job.scene_hash);
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(came->center[axis], job.center[axis]);
  EXPECT_TRUE(came->interactive);
  EXPECT_TRUE(came->hybrid);
  WatchedJob other = job;
  other.interactive = other.hybrid = false;
  const Expected<WatchedJob> plain = decode(sent(encode(other)).job());
  ASSERT_TRUE(plain);
  EXPECT_FALSE(plain->interactive);
  EXPECT_FALSE(plain->hybrid);
}

TEST(WatchWire, AViewArrivesAsItIs) {
  View view = view_at(1);
  view.camera.x = make_vec3(0, -0.0f, 1);
  view.camera.z = make_vec3(1e-40f, 1e30f, -7);
  view.adjustable.alpha = 0.25f;
  const wire::WatchEvent event = sent(encode(WatchItem(WatchView{4000000000u, view})));
  ASSERT_TRUE(event.has_view());
  const Expected<WatchView> came = decode(event.view());
  ASSERT_TRUE(came);
  EXPECT_EQ(came->number, 4000000000u);
  EXPECT_EQ(std::memcmp(&came->view, &view, sizeof view), 0);
}

TEST(WatchWire, ATileArrivesWithAllItsBits) {
  for (const bool hybrid : {true, false}) {
    const TileSnapshot tile = some_tile(hybrid);
    const wire::WatchEvent event = sent(encode(WatchItem(std::make_shared<const TileSnapshot>(tile))));
    ASSERT_TRUE(event.has_tile());
    WatchedJob job = some_job();
    job.hybrid = hybrid;
    const Expected<TileSnapshot> came = decode(event.tile(), job);
    ASSERT_TRUE(came) << came.error().message;
    EXPECT_EQ(came->view, tile.view);
    EXPECT_EQ(came->x, tile.x);
    EXPECT_EQ(came->y, tile.y);
    EXPECT_EQ(came->width, tile.width);
    EXPECT_EQ(came->height, tile.height);
    EXPECT_EQ(came->samples, tile.samples);
    EXPECT_EQ(came->worker, tile.worker);
    EXPECT_TRUE(same_bits(came->radiance, tile.radiance));
    EXPECT_TRUE(same_bits(came->difference, tile.difference));
    EXPECT_TRUE(same_bits(came->standard_error, tile.standard_error));
  }
}

TEST(WatchWire, ProgressArrivesAsItIs) {
  WatchProgress progress{.view = 3,
                         .samples_done = 1ull << 40,
                         .samples_wanted = (1ull << 40) + 1,
                         .spp_done = 5,
                         .spp_wanted = 6,
                         .elapsed_seconds = 1.5,
                         .relative_error = 0.01,
                         .finished = true,
                         .ended = true,
                         .workers = {}};
  progress.workers.push_back({.number = 2,
                              .name = "here:42",
                              .device = "fake",
                              .units = 1ull << 33,
                              .x = 1,
                              .y = 2,
                              .width = 3,
                              .height = 4});
  progress.workers.push_back({.number = 9, .name = "idle", .device = "d"});
  const wire::WatchEvent event = sent(encode(WatchItem(std::make_shared<const WatchProgress>(progress))));
  ASSERT_TRUE(event.has_progress());
  const WatchProgress came = decode(event.progress());
  EXPECT_EQ(came.view, 3u);
  EXPECT_EQ(came.samples_done, progress.samples_done);
  EXPECT_EQ(came.samples_wanted, progress.samples_wanted);
  EXPECT_EQ(came.spp_done, 5u);
  EXPECT_EQ(came.spp_wanted, 6u);
  EXPECT_EQ(came.elapsed_seconds, 1.5);
  EXPECT_EQ(came.relative_error, 0.01);
  EXPECT_TRUE(came.finished);
  EXPECT_TRUE(came.ended);
  ASSERT_EQ(came.workers.size(), 2u);
  EXPECT_EQ(came.workers[0].number, 2u);
  EXPECT_EQ(came.workers[0].name, "here:42");
  EXPECT_EQ(came.workers[0].device, "fake");
  EXPECT_EQ(came.workers[0].units, 1ull << 33);
  EXPECT_EQ(came.workers[0].x, 1);
  EXPECT_EQ(came.workers[0].y, 2);
  EXPECT_EQ(came.workers[0].width, 3);
  EXPECT_EQ(came.workers[0].height, 4);
  EXPECT_EQ(came.workers[1].width, 0);
  WatchProgress fresh;
  const WatchProgress unknown =
      decode(sent(encode(WatchItem(std::make_shared<const WatchProgress>(fresh)))).progress());
  EXPECT_TRUE(std::isnan(unknown.relative_error));
  EXPECT_FALSE(unknown.finished);
  EXPECT_FALSE(unknown.ended);
}

TEST(WatchWire, MessagesAndTitlesOfAnyBytesArrive) {
  const auto said = [](const std::string& text) {
    const wire::WatchEvent event = sent(encode(WatchItem(text)));
    EXPECT_EQ(event.content_case(), wire::WatchEvent::kMessage);
    return event.message();
  };
  for (const std::string text : {"plain", "Köln", "日本", "\U0001F600", "\u07ff\u0800\uffff\U0010ffff"})
    EXPECT_EQ(said(text), text);
  EXPECT_EQ(said("caf\xe9.xml"), "caf?.xml");
  EXPECT_EQ(said("cut \xe6\x97"), "cut ??");
  EXPECT_EQ(said("\xc0\xaf \xe0\x80\x80 \xed\xa0\x80 \xf4\x90\x80\x80 \xff"), "?? ??? ??? ???? ?");
  WatchedJob job = some_job();
  job.title = "caf\xe9.xml";
  const Expected<WatchedJob> came = decode(sent(encode(job)).job());
  ASSERT_TRUE(came);
  EXPECT_EQ(came->title, "caf?.xml");
}

TEST(WatchWire, AJobThatMakesNoSenseIsRefused) {
  constexpr int kMost = std::numeric_limits<int>::max(), kLeast = std::numeric_limits<int>::min();
  const auto refusal = [](const std::function<void(wire::WatchedJob&)>& change) {
    wire::WatchEvent event = encode(some_job());
    change(*event.mutable_job());
    const Expected<WatchedJob> job = decode(event.job());
    return job ? std::string("accepted") : job.error().message;
  };
  EXPECT_EQ(refusal([](auto&) {}), "accepted");
  EXPECT_EQ(refusal([](auto& j) { j.set_x(80); }), "accepted") << "up to the film's edge";
  const std::vector<std::function<void(wire::WatchedJob&)>> nonsense{
      [](auto& j) { j.set_x(81); },
      [](auto& j) { j.set_x(-1); },
      [](auto& j) { j.set_y(51); },
      [](auto& j) { j.set_y(-1); },
      [](auto& j) { j.set_width(0); },
      [](auto& j) { j.set_height(0); },
      [](auto& j) { j.set_width(-5); },
      [](auto& j) { j.set_height(kLeast); },
      [](auto& j) { j.set_x(kMost); },
      [](auto& j) { j.set_y(kMost), j.set_height(kMost); },
      [](auto& j) { j.set_width(kMost); },
      [](auto& j) { j.set_film_width(0); },
      [](auto& j) { j.set_film_width(-200); },
      [](auto& j) { j.set_film_height(kLeast); },
      [](auto& j) { j.set_film_width(kLeast), j.set_width(kMost); },
      [](auto& j) { j.Clear(); },
  };
  for (std::size_t i = 0; i < nonsense.size(); ++i)
    EXPECT_THAT(refusal(nonsense[i]), HasSubstr("the scheduler describes")) << i;
  EXPECT_THAT(refusal([](auto& j) { j.clear_center(); }), HasSubstr("without a centre"));
  EXPECT_THAT(refusal([](auto& j) { j.add_center(1); }), HasSubstr("without a centre"));
}

TEST(WatchWire, ATileThatMakesNoSenseIsRefused) {
  constexpr int kMost = std::numeric_limits<int>::max(), kLeast = std::numeric_limits<int>::min();
  using Change = std::function<void(wire::TileState&)>;
  const auto accepted = [](const Change& change, const WatchedJob& job) {
    wire::WatchEvent event = encode(WatchItem(std::make_shared<const TileSnapshot>(some_tile())));
    change(*event.mutable_tile());
    const Expected<TileSnapshot> tile = decode(event.tile(), job);
    EXPECT_TRUE(tile || tile.error().message.contains("not one of this render"));
    return tile.has_value();
  };
  const WatchedJob job = some_job();
  EXPECT_TRUE(accepted([](auto&) {}, job));
  EXPECT_TRUE(accepted([](auto& t) { t.set_x(197), t.set_y(148); }, job)) << "up to the film's edge";
  EXPECT_TRUE(accepted([](auto& t) { t.set_width(2), t.set_height(3); }, job)) << "as many pixels";
  const std::vector<Change> nonsense{
      [](auto& t) { t.set_x(198); },
      [](auto& t) { t.set_y(149); },
      [](auto& t) { t.set_x(-1); },
      [](auto& t) { t.set_y(kLeast); },
      [](auto& t) { t.set_width(4); },
      [](auto& t) { t.set_height(1); },
      [](auto& t) { t.set_width(0); },
      [](auto& t) { t.set_width(-3), t.set_height(-2); },
      [](auto& t) { t.set_width(kMost), t.set_height(kMost); },
      [](auto& t) { t.set_x(kMost), t.set_width(kMost); },
      [](auto& t) { t.mutable_radiance()->pop_back(); },
      [](auto& t) { t.mutable_radiance()->append(1, 'x'); },
      [](auto& t) { t.mutable_radiance()->append(4, 'x'); },
      [](auto& t) { t.clear_radiance(); },
      [](auto& t) { t.clear_difference(); },
      [](auto& t) { t.mutable_difference()->append(3, 'x'); },
      [](auto& t) { t.clear_standard_error(); },
      [](auto& t) { t.mutable_standard_error()->append(2, 'x'); },
      [](auto& t) { t.mutable_standard_error()->append(t.radiance()); },
      [](auto& t) { t.Clear(); },
  };
  for (std::size_t i = 0; i < nonsense.size(); ++i) EXPECT_FALSE(accepted(nonsense[i], job)) << i;
  WatchedJob plain = job;
  plain.hybrid = false;
  EXPECT_FALSE(accepted([](auto&) {}, plain)) << "a difference that the job has not";
  EXPECT_TRUE(accepted([](auto& t) { t.clear_difference(); }, plain));
}

TEST(WatchWire, AViewThatMakesNoSenseIsRefused) {
  using Change = std::function<void(wire::View&)>;
  const auto answer = [](const Change& change) -> std::string {
    wire::WatchEvent event = encode(WatchItem(WatchView{1, view_at(0)}));
    change(*event.mutable_view()->mutable_view());
    const auto view = decode(event.view());
    return view ? "" : view.error().message;
  };
  const auto numbers = [](const char* part, std::size_t count, std::size_t due) {
    return fmt::format("a view whose {} has {} numbers instead of {}", part, count, due);
  };
  constexpr std::size_t kCamera = sizeof(Camera) / sizeof(float), kOther = sizeof(Adjustable) / sizeof(float);
  EXPECT_EQ(answer([](auto&) {}), "");
  EXPECT_EQ(answer([](auto& v) { v.clear_camera(); }), numbers("camera", 0, kCamera));
  EXPECT_EQ(answer([](auto& v) { v.add_camera(0); }), numbers("camera", kCamera + 1, kCamera));
  EXPECT_EQ(answer([](auto& v) { v.mutable_adjustable()->RemoveLast(); }),
            numbers("adjustable", kOther - 1, kOther));
  EXPECT_EQ(answer([](auto& v) { v.add_adjustable(0); }), numbers("adjustable", kOther + 1, kOther));
  EXPECT_FALSE(decode(wire::NumberedView{}).has_value());
}

TEST(WatchWire, EveryNumberOfAViewArrivesAndIsFinite) {
  const float nan = kNan, infinite = std::numeric_limits<float>::infinity();
  View any = view_at(0);
  const auto check = [&](const char* name, auto field) {
    for (std::size_t k = 0; k < sizeof(field(any)) / sizeof(float); ++k) {
      const auto with = [&](float value) {
        View view = view_at(0);
        std::memcpy(reinterpret_cast<char*>(&field(view)) + k * sizeof value, &value, sizeof value);
        return view;
      };
      const auto journey = [](const View& view) {
        return decode(sent(encode(WatchItem(WatchView{1, view}))).view());
      };
      const auto came = journey(with(0.75f));
      ASSERT_TRUE(came) << name;
      EXPECT_TRUE(is_same(came->view, with(0.75f))) << name;
      EXPECT_FALSE(is_same(came->view, view_at(0))) << name;
      for (const float value : {nan, infinite, -infinite}) {
        const auto refused = journey(with(value));
        ASSERT_FALSE(refused) << name;
        EXPECT_EQ(refused.error().message, std::string("a view whose ") + name + " is not finite");
      }
    }
  };
#define CHECK_CAMERA(type, name) check("camera." #name, [](View& v) -> type& { return v.camera.name; });
#define CHECK_ADJUSTABLE(type, name) \
  check("adjustable." #name, [](View& v) -> type& { return v.adjustable.name; });
  CAMERA_FIELDS(CHECK_CAMERA)
  ADJUSTABLE_FIELDS(CHECK_ADJUSTABLE)
#undef CHECK_CAMERA
#undef CHECK_ADJUSTABLE
}

TEST(WatchWire, LayersOfATileArriveAndDamagedOnesDoNot) {
  TileSnapshot tile = some_tile();
  tile.layers = {{"depth", std::vector<float>(6, 2.5f)},
                 {"uv", std::vector<float>(12, 0.5f)},
                 {"albedo", tile.radiance}};
  const wire::WatchEvent event = sent(encode(WatchItem(std::make_shared<const TileSnapshot>(tile))));
  const auto came = decode(event.tile(), some_job());
  ASSERT_TRUE(came) << came.error().message;
  ASSERT_EQ(came->layers.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(came->layers[i].name, tile.layers[i].name);
    EXPECT_TRUE(same_bits(came->layers[i].values, tile.layers[i].values));
  }
  for (const std::size_t bytes : {0, 1, 20, 28, 4 * 24}) {
    wire::TileState damaged = event.tile();
    damaged.mutable_layers(0)->mutable_values()->resize(bytes);
    EXPECT_FALSE(decode(damaged, some_job())) << bytes;
  }
}

}  // namespace
}  // namespace penumbra
