// A client's description of a render arrives completely, or is refused with a message.
#include "scheduler/service/submission.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "scenes/settings.h"
#include "scheduler/record/camera_attributes.h"
#include "scheduler/render/render_option.h"
#include "tests/scheduler/service/small_submission.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

void set(RenderRecord& record, std::string_view key, std::string_view value) {
  const auto applied = apply_setting(record, key, value);
  ASSERT_TRUE(applied) << key << ": " << applied.error().message;
}

Submission full_submission() {
  Submission submission = small_submission(fake_scene(40, 30, true), 3);
  RenderRecord& record = submission.record;
  set(record, "integrator.type", "direct");
  set(record, "integrator.emitter_samples", "3");
  set(record, "sampler.type", "halton");
  set(record, "sampler.sample_count", "77");
  set(record, "sampler.seed", "4294967295");
  set(record, "film.rfilter", "mitchell");
  set(record, "film.rfilter_b", "0.1234567");
  set(record, "film.crop_offset_x", "3");
  set(record, "film.crop_width", "30");
  set(record, "camera.fov", "33.333333333333336");
  set(record, "camera.aperture_radius", "0.1");
  set(record, "camera.distortion_k1", "1e-3");
  set(record, "camera.lookat", "1 2 3, 0.1 0.2 0.3, 0 1 0.5");
  record.scene_hash = ~std::uint64_t(0);
  record.scene.defines = {"a=1", "b=x y"};
  record.scene.settings = {"film.width=40"};
  record.scene.scale = 0.3;
  record.scene.lenient = true;
  record.scene.dialect = "nori-eth";
  record.plan.stop_after = 70;
  record.plan.samples_per_pass = 5;
  record.plan.target_error = 0.1;
  record.scene.no_features = true;
  record.scene.cryptomatte = true;
  record.scene.intersector = "embree";
  record.isa = "avx2";
  record.backend = Backend::kOpenCl;
  record.opencl_device = "GPU ä";
  record.time_budget = 1.5;
  record.verify = 0.25;
  record.strict_numerics = true;
  submission.center = {1, -2, 1e300};
  submission.warnings = {"s.xml:1:2: warning: ä"};
  submission.needs = {{"families", "diffuse"}};
  submission.left_out = {{"textures", "none"}, {"media", "none"}};
  submission.build_seconds = 0.25;
  submission.command_line = {"penumbra", "submit", "s.xml"};
  submission.mattes = {.objects = {"floor", "ä"}, .materials = {"wood"}, .mattes = {{0, 0}, {1, 0}, {0, 0}}};
  return submission;
}

TEST(Submission, ArrivesWhole) {
  Submission sent = full_submission();
  sent.frame = 12;
  const wire::Submission message = encode(sent);
  wire::Submission received;
  ASSERT_TRUE(received.ParseFromString(message.SerializeAsString()));
  const auto there = decode(received);
  ASSERT_TRUE(there) << there.error().message;
  for (const Setting& setting : all_settings())
    if (setting.print && setting.belongs_to(sent.record))
      EXPECT_EQ(setting.print(there->record), setting.print(sent.record)) << setting.key;
  EXPECT_EQ(record_entries(there->record), record_entries(sent.record));
  EXPECT_EQ(repeat_command(there->record, true), repeat_command(sent.record, true));
  EXPECT_EQ(there->record.camera.to_world, sent.record.camera.to_world);
  const ImageCamera camera = camera_attributes(sent.record.camera, sent.record.film);
  EXPECT_EQ(camera_attributes(there->record.camera, there->record.film).world_to_ndc, camera.world_to_ndc);
  EXPECT_EQ(there->name, "s.xml");
  EXPECT_EQ(there->scene, sent.scene);
  EXPECT_EQ(there->priority, 3);
  EXPECT_EQ(there->frame, 12);
  for (const RenderOption& option : all_render_options())
    if (option.is_sent()) EXPECT_EQ(option.print(there->record), option.print(sent.record)) << option.name();
  EXPECT_EQ(there->record.time_budget, 1.5);
  EXPECT_EQ(there->record.verify, 0.25);
  EXPECT_EQ(there->center, sent.center);
  EXPECT_EQ(there->warnings, sent.warnings);
  EXPECT_EQ(there->needs, sent.needs);
  EXPECT_EQ(there->left_out, sent.left_out);
  EXPECT_EQ(there->build_seconds, 0.25);
  EXPECT_EQ(there->command_line, sent.command_line);
  EXPECT_TRUE(there->record.strict_numerics);
  EXPECT_EQ(there->mattes, sent.mattes);
  EXPECT_THAT(there->files, ElementsAre("s.exr", "s.png", "s.json"));
  // What was decoded encodes to the same: nothing is lost on the way through a service's folder.
  EXPECT_EQ(encode(*there).SerializeAsString(), message.SerializeAsString());
}

TEST(Submission, FramesBesideAFrameArrive) {
  Submission sent = full_submission();
  set(sent.record, "film.denoise", "nfor");
  sent.files = {"s.exr", "s-denoised.exr"};
  sent.frame = 12;
  sent.beside = NumbersBeside{.shot = 3, .frames = {10, 13}};
  const auto there = decode(encode(sent));
  ASSERT_TRUE(there) << there.error().message;
  ASSERT_TRUE(there->beside);
  EXPECT_EQ(there->beside->shot, 3u);
  EXPECT_THAT(there->beside->frames, ElementsAre(10, 13));
  for (const std::vector<int>& wrong : {std::vector{12}, {13, 10}, {11, 11}, {3}, {-1}, {21}}) {
    sent.beside->frames = wrong;
    EXPECT_THAT(decode(encode(sent)).error().message, ::testing::HasSubstr("is not beside frame 12"));
  }
  sent.beside->frames = {11};
  sent.files = {"s.exr"};
  EXPECT_THAT(decode(encode(sent)).error().message, ::testing::HasSubstr("a denoised EXR"));
}

TEST(Submission, WhatExcludesATargetErrorArrives) {
  Submission sent = full_submission();
  sent.record.plan.target_error.reset();
  sent.record.plan.stop_after.reset();
  sent.record.plan.adaptive = true;
  const auto adaptive = decode(encode(sent));
  ASSERT_TRUE(adaptive) << adaptive.error().message;
  EXPECT_TRUE(adaptive->record.plan.adaptive);
  sent.record.plan.adaptive = false;
  sent.record.plan.stop_after_units = std::uint64_t(1) << 40;
  const auto stopped = decode(encode(sent));
  ASSERT_TRUE(stopped) << stopped.error().message;
  EXPECT_EQ(stopped->record.plan.stop_after_units, std::uint64_t(1) << 40);
}

TEST(Submission, PhotonMapsArriveWithTheirPasses) {
  Submission sent = small_submission(fake_scene(40, 30, true));
  set(sent.record, "integrator.type", "ppm");
  set(sent.record, "integrator.photon_count", "1234");
  set(sent.record, "integrator.initial_radius", "0.125");
  set(sent.record, "integrator.alpha", "auto");
  sent.record.plan.samples_per_pass = 1;
  sent.record.plan.tile = 256;
  const auto there = decode(encode(sent));
  ASSERT_TRUE(there) << there.error().message;
  EXPECT_EQ(record_entries(there->record), record_entries(sent.record));
  EXPECT_EQ(repeat_command(there->record, true), repeat_command(sent.record, true));
  EXPECT_EQ(there->record.plan.samples_per_pass, 1u);
  EXPECT_EQ(there->record.plan.tile, 256);
}

TEST(Submission, ResultsAreNamesWithoutFolders) {
  for (const char* name : {"a.exr", "a b.png", "ä.json", "a.b.exr"})
    EXPECT_TRUE(is_result_name(name)) << name;
  using namespace std::string_view_literals;
  for (const std::string_view name :
       {""sv, "."sv, ".."sv, "../a.exr"sv, "/a.exr"sv, "a/b.exr"sv, ".a.exr"sv, "job"sv, "a.exr.checkpoint"sv,
        "a.EXR"sv, "a"sv, ".exr"sv, "a\0.exr"sv, "..\0/.exr"sv})
    EXPECT_FALSE(is_result_name(name)) << name;
  EXPECT_FALSE(is_result_name(std::string(250, 'a') + ".exr"));
}

TEST(Submission, FoldersOfResultsStayBelowTheClients) {
  for (const char* folder : {"", "shots", "shots/0001/a b", "ä/ö", "a..b"})
    EXPECT_TRUE(is_result_folder(folder)) << folder;
  for (const char* folder :
       {"/", "/etc", "..", "a/..", "a/../..", ".ssh", "a/.git", "a//b", "a/", "./a", "a\nb"})
    EXPECT_FALSE(is_result_folder(folder)) << folder;
  EXPECT_FALSE(is_result_folder(std::string(1001, 'a')));
  EXPECT_FALSE(is_result_folder(std::string(250, 'a')));
}

TEST(Submission, WhatMakesNoSenseIsSaid) {
  const auto error = [](auto change) {
    wire::Submission message = encode(full_submission());
    change(message);
    const auto decoded = decode(message);
    return decoded ? std::string("accepted") : decoded.error().message;
  };
  EXPECT_EQ(error([](wire::Submission&) {}), "accepted");
  EXPECT_THAT(error([](auto& m) { m.set_files(0, "../x.exr"); }),
              HasSubstr("'../x.exr' is no name of a result"));
  EXPECT_THAT(error([](auto& m) { m.add_files("t.exr"); }), HasSubstr("two results of one kind"));
  EXPECT_THAT(error([](auto& m) { m.clear_files(); }), HasSubstr("no file"));
  EXPECT_THAT(error([](auto& m) { m.set_center(1, std::nan("")); }), HasSubstr("centre"));
  EXPECT_THAT(error([](auto& m) { m.clear_center(); }), HasSubstr("centre"));
  EXPECT_THAT(error([](auto& m) { m.mutable_mattes()->add_matte_objects(0); }), HasSubstr("no material"));
  EXPECT_THAT(error([](auto& m) { m.mutable_mattes()->set_matte_objects(1, 2); }), HasSubstr("has no name"));
  EXPECT_THAT(error([](auto& m) { m.mutable_mattes()->set_matte_materials(1, ~0u); }),
              HasSubstr("has no name"));
  const auto setting = [](const char* key, const char* value) {
    return [=](wire::Submission& m) {
      wire::NamedText* added = m.mutable_record()->add_render_settings();
      added->set_name(key);
      added->set_text(value);
    };
  };
  EXPECT_THAT(error(setting("film.widht", "3")), HasSubstr("film.width"));
  EXPECT_THAT(error(setting("film.width", "-3")), HasSubstr("-3"));
  const auto option = [](const char* name, const char* value) {
    return [=](wire::Submission& m) {
      wire::NamedText* added = m.mutable_record()->add_options();
      added->set_name(name);
      added->set_text(value);
    };
  };
  EXPECT_THAT(error(option("time-budget", "-1")), HasSubstr("--time-budget: -1 is not above 0"));
  for (const char* share : {"-0.1", "1.1", "nan"})
    EXPECT_THAT(error(option("verify", share)), HasSubstr("--verify: "));
  EXPECT_THAT(error(option("target-error", "0")), HasSubstr("--target-error: "));
  EXPECT_THAT(error(option("threads", "0")), HasSubstr("--threads: "));
  EXPECT_THAT(error(option("backend", "cuda")), HasSubstr("'cuda' is none of native, opencl, auto"));
  EXPECT_THAT(error(option("adaptive", "true")), HasSubstr("excludes --adaptive"));
  for (const char* name : {"verfiy", "out", "pixel", "spp", "workers", ""})
    EXPECT_THAT(error(option(name, "1")), HasSubstr("is no option of a submitted render"));
  EXPECT_THAT(error([](auto& m) { m.mutable_record()->clear_options(); }), HasSubstr("another version"));
}

TEST(Submission, DamagedBytesAreRefusedOrHarmless) {
  const std::string bytes = encode(full_submission()).SerializeAsString();
  google::protobuf::SetLogHandler(nullptr);  // it says what it rejects
  std::mt19937 random(1);
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string damaged = bytes;
    for (int k = 0; k < 1 + i % 3; ++k) damaged[random() % damaged.size()] ^= char(1u << random() % 7);
    if (i % 7 == 0) damaged.resize(random() % damaged.size());
    wire::Submission message;
    if (!message.ParseFromString(damaged)) continue;
    const auto decoded = decode(message);
    if (!decoded) {
      EXPECT_FALSE(decoded.error().message.empty());
      continue;
    }
    ++accepted;
    for (const std::string& name : decoded->files) EXPECT_TRUE(is_result_name(name));
  }
  EXPECT_GT(accepted, 0);
}

}  // namespace
}  // namespace penumbra
