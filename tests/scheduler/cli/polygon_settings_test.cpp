// Integrators for polygon lights and their settings on the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// `penumbra info` of the small scene.
ProgramResult info(const std::vector<std::string>& overrides) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  std::vector<std::string> arguments = {"info", "s.xml", "--json"};
  arguments.insert(arguments.end(), overrides.begin(), overrides.end());
  return run_penumbra(folder.path(), arguments);
}

std::string need(const ProgramResult& result, const std::string& what) {
  EXPECT_EQ(result.exit_code, 0) << result.err;
  if (result.exit_code != 0) return "";
  const auto json = nlohmann::json::parse(result.out);
  return json["needs"].contains(what) ? json["needs"][what].get<std::string>() : "none";
}

TEST(PolygonSettings, OverridesReachTheDeviceScene) {
  EXPECT_EQ(need(info({}), "polygon lights"), "none");
  EXPECT_EQ(need(info({"--integrator", "polygon_area"}), "polygon lights"), "none");
  EXPECT_EQ(need(info({"--integrator", "polygon_analytic"}), "polygon lights"), "1, with 4 edges");
  EXPECT_EQ(need(info({"--integrator", "polygon_analytic"}), "estimator"), "closed form alone");
  const auto estimator = [](std::vector<std::string> overrides) {
    overrides.insert(overrides.begin(), {"--integrator", "polygon_cv"});
    return need(info(overrides), "estimator");
  };
  EXPECT_THAT(estimator({"--set", "integrator.alpha=0.25"}), HasSubstr("alpha 0.25"));
  EXPECT_THAT(estimator({"--set", "integrator.alpha=-2"}), HasSubstr("alpha -2"));
  EXPECT_THAT(estimator({"--set", "integrator.alpha=auto"}), HasSubstr("fitted"));
  EXPECT_EQ(estimator({"--set", "integrator.emitter_sampling=projected"}), "samples alone")
      << "nothing to fit";
  EXPECT_THAT(estimator({"--set", "integrator.light_choice=power"}), HasSubstr("fitted"));
  EXPECT_THAT(estimator({"--set", "integrator.emitter_sampling=area"}), HasSubstr("fitted"));
  EXPECT_THAT(estimator({"--set", "integrator.vis_samples=4"}), HasSubstr("fitted"))
      << "a parameter of the integrator that the option chooses";
  EXPECT_THAT(need(info({"--set", "integrator.nee=cv", "--set", "integrator.alpha=1"}), "estimator"),
              HasSubstr("alpha 1"));
}

TEST(PolygonSettings, WrongValuesAreBadInput) {
  const std::pair<const char*, const char*> cases[] = {
      {"integrator.alpha=much", "nor is it 'auto'"},
      {"integrator.light_choice=random", "'random' is not one of: auto, power, analytic, tree"},
      {"integrator.nee=on", "'on' is not one of: sample, cv"},
      {"integrator.trace_shadows=0", "neither true nor false"},
      {"integrator.vis_samples=0", "from 1 to 65536"},
      {"integrator.vis_samples=2",
       "integrator 'path' has no parameter 'vis_samples'; these have: polygon_cv"},
      {"integrator.light_choice=analytic", "direct_sampling = ems"}};  // the scene's path samples BSDFs too
  for (const auto& [setting, message] : cases) {
    const TemporaryFolder folder;
    write_small_scene(folder / "s.xml");
    for (const char* command : {"info", "render"}) {
      const ProgramResult result = run_penumbra(folder.path(), {command, "s.xml", "--set", setting});
      EXPECT_EQ(result.exit_code, 2) << setting;
      EXPECT_THAT(result.err, HasSubstr(message));
      EXPECT_THAT(result.out, IsEmpty());
    }
    EXPECT_THAT(folder.names(), ElementsAre("s.xml"));
  }
  const ProgramResult unknown = info({"--integrator", "polygon_cvs"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, AllOf(HasSubstr("polygon_cvs"), HasSubstr("polygon_cv")));
}

}  // namespace
}  // namespace penumbra
