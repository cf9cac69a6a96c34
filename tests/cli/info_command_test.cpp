// `penumbra info`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/cli/small_scene.h"
#include "tests/outputs/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(InfoCommand, CountsWhatTheSceneHolds) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const ProgramResult result = run_penumbra(folder.path(), {"info", "s.xml", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["shapes"], 2);
  EXPECT_EQ(json["triangles"], 4);
  EXPECT_EQ(json["lights"], 2) << "each triangle of the square";
  EXPECT_EQ(json["film"]["width"], 24);
  EXPECT_EQ(json["settings"]["integrator"], "path_mis");
  EXPECT_EQ(json["settings"]["sampler"], "independent");
  EXPECT_EQ(json["settings"]["spp"], "8");
  EXPECT_EQ(json["settings"]["intersector"], "portable");
  EXPECT_GT(json["device_scene_bytes"], 4 * 48);
  EXPECT_FALSE(json["needs"].empty());
  EXPECT_FALSE(json["left_out"].empty());
}

TEST(InfoCommand, ShowsTheOverrides) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const ProgramResult result = run_penumbra(folder.path(), {"info", "s.xml", "-D", "spp=32", "--integrator",
                                                            "direct", "--set", "film.rfilter=tent"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("direct"), HasSubstr("32"), HasSubstr("tent"), Not(HasSubstr("path_mis"))));
}

}  // namespace
}  // namespace penumbra
