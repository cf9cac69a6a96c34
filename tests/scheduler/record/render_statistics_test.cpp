#include "scheduler/record/render_statistics.h"
#include "tests/support/film_layers.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace penumbra {
namespace {

SampleBuffer grey_pixel(std::uint32_t samples) {
  SampleBuffer buffer;
  buffer.width = buffer.height = 1;
  buffer.sample_count = samples;
  buffer.values = {1, 1, 1, 3, 3, 3};
  buffer.flagged[BAD_NAN].count = 1;
  return buffer;
}

TEST(Report, SaysWhatWasDoneAndByWhom) {
  RenderJob job;
  job.scene.words.resize(10);
  RenderOutcome outcome;
  outcome.film = FilmAccumulator(0, 0, 2, 1, kNoLayers);
  outcome.film.add(0, 0, grey_pixel(4));
  outcome.problems = {"worker a:1 was lost"};
  outcome.units_done = 5;
  outcome.units_requeued = 1;
  outcome.seconds = 2.5;
  outcome.seconds_to_ready = 0.5;
  WorkerShare first, second;
  first.name = "a:1";
  first.samples = 300;
  first.peak_memory_bytes = 1000;
  first.ended = "killed by signal 9";
  second.name = "a:2";
  second.samples = 100;
  second.peak_memory_bytes = 3000;
  second.kernels = KernelOrigin{.cached = false, .seconds = 2.5, .note = "not kept"};
  outcome.workers = {first, second};

  RenderStatistics statistics;
  statistics.record.scene.file = "a.xml";
  statistics.record.plan.tile = 32;
  statistics.record.threads = 3;
  statistics.record.sampler.spp = 4;
  statistics.workers = 2;
  statistics.command_line = {"penumbra", "render", "a.xml", "--workers", "2"};
  statistics.job = &job;
  statistics.outcome = &outcome;
  statistics.warnings = {"a.xml:3:4: warning"};
  statistics.needs = {{"triangles", "12"}};
  statistics.left_out = {{"Phong BSDF", "not used"}};
  statistics.inventory.emplace();
  statistics.inventory->features = FEATURE_PATH;
  statistics.inventory->feature_uses = {{"PATH", "path integrator", true}, {"PHONG", "Phong BSDF", false}};
  statistics.inventory->tables = {{"nodes of the hierarchy", {0, std::nullopt}}};
  statistics.inventory->device_scene = {500, std::nullopt};
  statistics.inventory->path_state = {100, 150};
  statistics.inventory->result = {24, 84};
  statistics.inventory->native = NativeCode{"avx2", 90'000};
  statistics.build_seconds = 0.25;
  auto json = statistics_json(statistics);
  EXPECT_TRUE(json["seconds"]["write"].is_null() && json["finished"].is_null()) << "it is not over yet";
  add_end(json, 1.5);

  EXPECT_EQ(json["complete"], false);
  EXPECT_EQ(json["ended_by"], "failure");
  EXPECT_EQ(json["scene"], "a.xml");
  EXPECT_EQ(json["settings"]["spp"], 4);
  EXPECT_EQ(json["settings"]["tile"], 32);
  EXPECT_EQ(json["settings"]["threads_per_worker"], 3);
  EXPECT_EQ(json["samples"]["total"], 4);
  EXPECT_EQ(json["samples"]["least_per_pixel"], 0);
  EXPECT_EQ(json["samples"]["most_per_pixel"], 4);
  EXPECT_EQ(json["samples"]["nan"]["count"], 1);
  EXPECT_EQ(json["seconds"]["transfer"], 0.5);
  EXPECT_EQ(json["samples_per_second"], 200);
  EXPECT_EQ(json["workers"][0]["share"], 0.75);
  EXPECT_EQ(json["workers"][0]["ended"], "killed by signal 9");
  EXPECT_TRUE(json["workers"][1]["ended"].is_null());
  EXPECT_TRUE(json["workers"][0]["kernels"].is_null());
  EXPECT_EQ(json["workers"][1]["kernels"]["cached"], false);
  EXPECT_EQ(json["workers"][1]["kernels"]["compile_seconds"], 2.5);
  EXPECT_EQ(json["workers"][1]["kernels"]["note"], "not kept");
  EXPECT_EQ(json["memory"]["largest_worker_peak_bytes"], 3000);
  EXPECT_EQ(json["memory"]["device_scene_bytes"], sizeof(SceneHeader) + 40);
  EXPECT_GT(json["memory"]["scheduler_peak_bytes"], 1 << 20);
  EXPECT_EQ(json["needs"]["triangles"], "12");
  EXPECT_EQ(json["left_out"]["Phong BSDF"], "not used");
  const auto& costs = json["costs"];
  EXPECT_EQ(costs["feature_bits"], FEATURE_PATH);
  EXPECT_EQ(costs["used"][0]["name"], "PATH");
  EXPECT_EQ(costs["left_out"][0]["description"], "Phong BSDF");
  EXPECT_EQ(costs["bytes"]["device_scene"]["own"], 500);
  EXPECT_TRUE(costs["bytes"]["device_scene"]["everything"].is_null()) << "not known";
  EXPECT_TRUE(costs["bytes"]["tables"]["nodes of the hierarchy"]["everything"].is_null());
  EXPECT_EQ(costs["bytes"]["block_state"]["everything"], 150 * kBlockPaths);
  EXPECT_EQ(costs["bytes"]["result_per_pixel"]["own"], 24);
  EXPECT_EQ(costs["native"]["code_bytes"], 90'000);
  EXPECT_TRUE(costs["opencl"].is_null());
  EXPECT_EQ(json["warnings"][0], "a.xml:3:4: warning");
  EXPECT_EQ(json["problems"][0], "worker a:1 was lost");
  EXPECT_EQ(json["film_hash"].get<std::string>().size(), 16u);
  EXPECT_EQ(json["seconds"]["build"], 0.25);
  EXPECT_EQ(json["seconds"]["write"], 1.5);
  EXPECT_EQ(json["finished"].get<std::string>().size(), std::string("2026-01-02T03:04:05Z").size());
  EXPECT_EQ(json["command_line"].size(), 5u);
}

TEST(GroupedJson, RepeatedNamesBecomeArrays) {
  const auto json = grouped_json({{"triangles", "3"}, {"feature", "a"}, {"feature", "b"}});
  EXPECT_EQ(json["triangles"], "3");
  EXPECT_EQ(json["feature"], (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(grouped_json({}).is_object());
}

}  // namespace
}  // namespace penumbra
