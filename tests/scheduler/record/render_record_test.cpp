#include "scheduler/record/render_record.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "scenes/settings.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra::render_record_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

RenderRecord cornell() {
  RenderRecord record;
  record.scene.file = "scenes/cornell/scene.xml";
  record.film.width = record.film.crop_width = 512;
  record.film.height = record.film.crop_height = 256;
  record.sampler.spp = 64;
  record.sampler.seed = 4000000000u;
  return record;
}

constexpr RenderedSamples kAll = {.least = 64, .most = 64};

std::map<std::string, MetadataValue> metadata_of(const RenderRecord& record,
                                                 const RenderedSamples& rendered) {
  const auto entries = record_metadata(record, 0xabcu, rendered);
  return {entries.begin(), entries.end()};
}

TEST(RepeatCommand, NamesEverythingThePixelsDependOn) {
  RenderRecord record = cornell();
  EXPECT_EQ(repeat_command(record, true),
            "penumbra render scenes/cornell/scene.xml --integrator path_mis --sampler sobol --spp 64 "
            "--seed 4000000000 --pass 16 --intersector portable");
  record.scene.file = "my scenes/it's.xml";
  record.scene.defines = {"albedo=0.5", "name=a b"};
  record.scene.settings = {"integrator.max_depth=3"};
  record.scene.scale = 0.3;
  record.scene.lenient = true;
  record.scene.dialect = "nori-eth";
  param::direct_sampling(record.integrator) = DirectSampling::kEmitterOnly;
  record.scene.intersector = "embree";
  record.isa = "avx2";
  record.film.crop_x = 10;
  record.film.crop_width = 20;
  record.film.crop_y = 30;
  record.film.crop_height = 40;
  const std::string whole =
      "penumbra render 'my scenes/it'\\''s.xml' -D albedo=0.5 -D 'name=a b' --set integrator.max_depth=3 "
      "--scale 0.3 --lenient --dialect nori-eth "
      "--integrator path_ems --sampler sobol --spp 64 --seed 4000000000 --pass 16 --intersector embree --isa "
      "avx2";
  EXPECT_EQ(repeat_command(record, false), whole);
  EXPECT_EQ(repeat_command(record, true), whole + " --crop 10,30,30,70");
}

TEST(RecordMetadata, IsMarkedIncompleteOnlyIfSo) {
  EXPECT_FALSE(metadata_of(cornell(), kAll).contains("penumbra:incomplete"));
  const RenderedSamples half = {.complete = false, .least = 32, .most = 32};
  EXPECT_EQ(metadata_of(cornell(), half).at("penumbra:incomplete"), MetadataValue(1));
}

TEST(RecordMetadata, DoesNotDependOnTheFolder) {
  RenderRecord elsewhere = cornell();
  elsewhere.scene.file = "/home/me/scene.xml";
  EXPECT_EQ(metadata_of(elsewhere, kAll), metadata_of(cornell(), kAll));
  elsewhere.scene_hash = 1;
  EXPECT_NE(metadata_of(elsewhere, kAll), metadata_of(cornell(), kAll)) << "another scene of the same name";
}

TEST(RecordOfRendered, KeepsWhatTheSequenceIsMadeFor) {
  const auto command = [](const RenderedSamples& rendered) {
    return repeat_command(record_of_rendered(cornell(), rendered), true);
  };
  EXPECT_EQ(command(kAll), repeat_command(cornell(), true));
  EXPECT_THAT(command({.least = 48, .most = 48}), HasSubstr("--stop-after 48 "));
  EXPECT_THAT(command({.least = 16, .most = 32, .units_in_order = 77}),
              AllOf(HasSubstr("--stop-after-units 77 --tile "), Not(HasSubstr("--stop-after 32"))));
  EXPECT_THAT(command({.least = 48, .most = 48, .units_in_order = 77}), Not(HasSubstr("--stop-after-units")));
  EXPECT_THAT(command({.complete = false, .least = 16, .most = 32}), HasSubstr("--stop-after 32 "));
  // One unit of 16 samples is missing; it is not known here which.
  EXPECT_EQ(command({.complete = false, .has_gaps = true, .least = 48, .most = 48}),
            repeat_command(cornell(), true));
}

TEST(RecordMetadata, OfAnImageThatNoCommandRepeatsSaysSo) {
  for (const RenderedSamples& rendered :
       {RenderedSamples{.complete = false, .least = 16, .most = 32},
        RenderedSamples{.complete = false, .has_gaps = true, .least = 48, .most = 48}}) {
    const auto metadata = metadata_of(record_of_rendered(cornell(), rendered), rendered);
    EXPECT_FALSE(metadata.contains("penumbra:command"));
    EXPECT_TRUE(metadata.contains("penumbra:nearest_command"));
    EXPECT_EQ(metadata.at("penumbra:samples_per_pixel"),
              MetadataValue(fmt::format("{} to {}", rendered.least, rendered.most)));
  }
}

/// Sets what the record says on defaults, as --set does, and returns the record of that.
RenderRecord set_again(const RenderRecord& record) {
  RenderRecord again;
  for (const auto& [name, value] : record_entries(record))
    for (const Setting& setting : all_settings()) {
      if (name != setting.key && name != setting.option) continue;
      const std::string text = std::visit([](const auto& v) { return fmt::format("{}", v); }, value);
      const auto done = apply_setting(again, setting.key, text);
      EXPECT_TRUE(done) << done.error().message;
    }
  return again;
}

TEST(RecordEntries, AreWhatSetTakes) {
  const auto settings_of = [](const RenderRecord& record) {
    std::vector<std::pair<std::string, MetadataValue>> entries = record_entries(record);
    std::erase_if(entries, [](const auto& entry) {
      return find_setting(entry.first) == nullptr && entry.first != "integrator" && entry.first != "spp";
    });
    return entries;
  };
  for (const IntegratorMethod& method : integrator_methods()) {
    RenderRecord record = cornell();
    record.integrator = {
        .method = method, .hide_emitters = true, .hidden_emitters = HiddenEmitters::kLookedThrough};
    record.film.filter = FilterKind::kMitchell;
    record.film.filter_b = 0.1f;
    EXPECT_EQ(settings_of(set_again(record)), settings_of(record)) << method_name(method);
  }
  const auto metadata = metadata_of(cornell(), kAll);
  EXPECT_EQ(metadata.at("penumbra:integrator.hide_emitters"), MetadataValue("false"));
  EXPECT_FALSE(metadata.contains("penumbra:integrator.emitter_samples")) << "a path has none";
}

TEST(RecordMetadata, HoldsSettingsAndHash) {
  const auto metadata = metadata_of(cornell(), kAll);
  EXPECT_EQ(metadata.at("penumbra:seed"), MetadataValue(4e9)) << "more than the format's int holds";
  EXPECT_EQ(metadata.at("penumbra:spp"), MetadataValue(int(cornell().sampler.spp)));
  EXPECT_EQ(metadata.at("penumbra:samples_per_pass"), MetadataValue(int(cornell().plan.samples_per_pass)));
  EXPECT_EQ(metadata.at("penumbra:film.width"), MetadataValue(cornell().film.width));
  EXPECT_EQ(metadata.at("penumbra:film.height"), MetadataValue(cornell().film.height));
  EXPECT_EQ(metadata.at("penumbra:integrator"), MetadataValue("path_mis"));
  EXPECT_EQ(metadata.at("penumbra:integrator.max_depth"), MetadataValue(-1));
  EXPECT_EQ(metadata.at("penumbra:film.rfilter"), MetadataValue("gaussian"));
  EXPECT_EQ(metadata.at("penumbra:film.rfilter_stddev"), MetadataValue(0.5f));
  for (const char* name : {"film.pixel_format", "film.component_format", "film.compression"})
    EXPECT_FALSE(metadata.contains(std::string("penumbra:") + name)) << "as ever: " << name;
  EXPECT_EQ(metadata.at("penumbra:film_hash"), MetadataValue("0000000000000abc"));
  RenderRecord here = cornell();
  here.scene.file = "scene.xml";
  EXPECT_EQ(metadata.at("penumbra:command"), MetadataValue(repeat_command(here, true)));
  EXPECT_FALSE(metadata.contains("penumbra:isa")) << "the portable intersector does not depend on it";
}

}  // namespace
}  // namespace penumbra::render_record_test
