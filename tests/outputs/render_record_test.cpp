#include "scheduler/outputs/render_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace penumbra {
namespace {

RenderRecord cornell() {
  RenderRecord record;
  record.scene = "scenes/cornell/scene.xml";
  record.film.width = record.film.crop_width = 512;
  record.film.height = record.film.crop_height = 256;
  record.sampler.spp = 64;
  record.sampler.seed = 4000000000u;
  return record;
}

std::map<std::string, MetadataValue> metadata_of(const RenderRecord& record, bool complete) {
  const auto entries = record_metadata(record, 0xabcu, complete);
  return {entries.begin(), entries.end()};
}

TEST(RepeatCommand, NamesEverythingThePixelsDependOn) {
  RenderRecord record = cornell();
  EXPECT_EQ(repeat_command(record, true),
            "penumbra render scenes/cornell/scene.xml --integrator path_mis --sampler sobol --spp 64 "
            "--seed 4000000000 --pass 16 --intersector portable");
  record.scene = "my scenes/it's.xml";
  record.defines = {"albedo=0.5", "name=a b"};
  record.settings = {"integrator.max_depth=3"};
  record.lenient = true;
  record.integrator.direct_sampling = DirectSampling::kEmitterOnly;
  record.embree = true;
  record.isa = "avx2";
  record.film.crop_x = 10;
  record.film.crop_width = 20;
  record.film.crop_y = 30;
  record.film.crop_height = 40;
  const std::string whole =
      "penumbra render 'my scenes/it'\\''s.xml' -D albedo=0.5 -D 'name=a b' --set integrator.max_depth=3 "
      "--lenient "
      "--integrator path_ems --sampler sobol --spp 64 --seed 4000000000 --pass 16 --intersector embree --isa "
      "avx2";
  EXPECT_EQ(repeat_command(record, false), whole);
  EXPECT_EQ(repeat_command(record, true), whole + " --crop 10,30,30,70");
}

TEST(RecordMetadata, IsMarkedIncompleteOnlyIfSo) {
  EXPECT_FALSE(metadata_of(cornell(), true).contains("penumbra:incomplete"));
  EXPECT_EQ(metadata_of(cornell(), false).at("penumbra:incomplete"), MetadataValue(1));
}

TEST(RecordMetadata, HoldsSettingsAndHash) {
  const auto metadata = metadata_of(cornell(), true);
  EXPECT_EQ(metadata.at("penumbra:seed"), MetadataValue("4000000000"));
  EXPECT_EQ(metadata.at("penumbra:integrator"), MetadataValue("path_mis"));
  EXPECT_EQ(metadata.at("penumbra:integrator.max_depth"), MetadataValue(-1));
  EXPECT_EQ(metadata.at("penumbra:film.rfilter"), MetadataValue("gaussian"));
  EXPECT_EQ(metadata.at("penumbra:film.rfilter_stddev"), MetadataValue("0.5"));
  EXPECT_EQ(metadata.at("penumbra:film_hash"), MetadataValue("0000000000000abc"));
  EXPECT_EQ(metadata.at("penumbra:command"), MetadataValue(repeat_command(cornell(), true)));
  EXPECT_FALSE(metadata.contains("penumbra:isa")) << "the portable intersector does not depend on it";
}

}  // namespace
}  // namespace penumbra
