// Tests `penumbra info`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "kernels/host/device_scene.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// With points on the light by area, whatever is best for it.
const std::vector<std::string> kInfo{"info", "s.xml", "--json", "--set", "integrator.emitter_sampling=area"};

TEST(InfoCommand, CountsWhatTheSceneHolds) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const ProgramResult result = run_penumbra(folder.path(), kInfo);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["shapes"], 2);
  EXPECT_EQ(json["triangles"], 4);
  EXPECT_EQ(json["lights"], 1) << "the square is one";
  EXPECT_EQ(json["film"]["width"], 24);
  EXPECT_EQ(json["settings"]["integrator"], "path_mis");
  EXPECT_EQ(json["settings"]["sampler"], "sobol");  // as rendered
  EXPECT_EQ(json["settings"]["spp"], "8");
  EXPECT_EQ(json["settings"]["intersector"], "portable");
  EXPECT_GT(json["device_scene_bytes"], 4 * 48);
  EXPECT_FALSE(json["needs"].empty());
  EXPECT_FALSE(json["left_out"].empty());
}

TEST(InfoCommand, ReadsCurves) {
  const TemporaryFolder folder;
  write_text(folder / "c.txt", "-1 0 0 .2\n0 0 0 .2\n1 0 0 .2\n2 0 0 .2\n");
  write_text(folder / "s.xml", R"(<scene version="3.0.0"><sensor type="perspective"/>
  <shape type="bsplinecurve"><string name="filename" value="c.txt"/></shape><emitter type="constant"/>
</scene>)");
  const ProgramResult result = run_penumbra(folder.path(), {"info", "s.xml", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json info = nlohmann::json::parse(result.out);
  EXPECT_EQ(info["triangles"], 0);
  EXPECT_EQ(info["needs"]["pieces of curves"], "1");  // it is straight
}

TEST(InfoCommand, SaysWhatTheFilesHold) {
  const TemporaryFolder folder;
  write_text(folder / "q.ply",
             "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
             "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
             "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  write_text(folder / "s.xml", R"(<scene version="3.0.0"><sensor type="perspective"/>
  <shape type="shapegroup" id="g"><shape type="ply"><string name="filename" value="q.ply"/></shape></shape>
  <shape type="instance"><ref id="g"/></shape>
  <shape type="instance"><ref id="g"/><transform name="to_world"><translate x="3"/></transform></shape>
  <shape type="sphere"><point name="center" x="0" y="0" z="2"/><emitter type="area"/></shape>
  <emitter type="point"/><emitter type="constant"/>
</scene>)");
  const ProgramResult text = run_penumbra(folder.path(), {"info", "s.xml"});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  for (const char* line :
       {"\n  extent                          (-1, -1, 0) to (4, 1, 3)\n",
        "\n  size                            5 x 2 x 3\n",
        "\n  triangles                       2, 4 with instances\n",
        "\n  instances                       2\n",
        "\nLights\n  area                            1\n  constant                        1\n  point  ",
        "\nFiles\n  s.xml  ", "q.ply  ", "\nDevice scene\n"})
    EXPECT_THAT(text.out, HasSubstr(line));
  EXPECT_THAT(text.out, AllOf(Not(HasSubstr("\n  feature ")), Not(HasSubstr("state of a path"))));
  EXPECT_THAT(run_penumbra(folder.path(), {"info", "s.xml", "-v"}).out,
              AllOf(HasSubstr("\n  feature "), HasSubstr("\nLeft out\n"), HasSubstr("state of a path")));
  const auto json = nlohmann::json::parse(run_penumbra(folder.path(), {"info", "s.xml", "--json"}).out);
  EXPECT_EQ(json["extent"]["size"], (nlohmann::json{5.0, 2.0, 3.0}));
  EXPECT_EQ(json["lights_by_kind"]["area"], 1);
  EXPECT_EQ(json["instances"], 2);
  ASSERT_EQ(json["files"].size(), 2u);
  EXPECT_EQ(json["files"][1]["bytes"], std::filesystem::file_size(folder / "q.ply"));
  EXPECT_FALSE(json["left_out"].empty());
}

TEST(InfoCommand, TellsTheCamera) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const auto json =
      nlohmann::json::parse(run_penumbra(folder.path(), {"info", "s.xml", "--json"}).out)["camera"];
  EXPECT_EQ(json["projection"], "perspective");
  EXPECT_EQ(json["position"], (nlohmann::json{0.0, 2.0, -4.0}));
  // From (0, 2, -4) to (0, 0.5, 0).
  const double length = std::hypot(1.5, 4.0);
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR(json["direction"][0], 0, kRounding);
  EXPECT_NEAR(json["direction"][1], -1.5 / length, kRounding);
  EXPECT_NEAR(json["direction"][2], 4 / length, kRounding);
  // 60 degrees across 24 pixels; down 20 pixels: tan(f / 2) = 20 / 24 tan(30).
  EXPECT_NEAR(json["fov"][0], 60, 1e-9);
  EXPECT_NEAR(json["fov"][1],
              2 * std::atan(20.0 / 24 * std::tan(std::numbers::pi / 6)) * 180 / std::numbers::pi, 1e-9);
  EXPECT_EQ(json["aperture_radius"], 0);
  const std::string text =
      run_penumbra(folder.path(), {"info", "s.xml", "--set", "camera.aperture_radius=0.25", "--set",
                                   "camera.focus_distance=3"})
          .out;
  EXPECT_THAT(text, AllOf(HasSubstr("(0, 2, -4)"), HasSubstr("60 degrees across, 51.39 down"),
                          HasSubstr("radius 0.25, in focus at distance 3")));
  const std::string parallel =
      run_penumbra(folder.path(), {"info", "s.xml", "--set", "camera.projection=orthographic"}).out;
  EXPECT_THAT(parallel, HasSubstr("orthographic, 2 x "));
}

TEST(InfoCommand, TellsWhatMoves) {
  const TemporaryFolder folder;
  write_text(folder / "s.xml", R"(<scene version="3.0.0"><sensor type="perspective"/>
  <shape type="sphere"><animation name="to_world"><transform time="0.5"/>
    <transform time="2"><translate x="3"/></transform></animation></shape>
  <shape type="sphere"/><emitter type="point"/>
</scene>)");
  const ProgramResult text = run_penumbra(folder.path(), {"info", "s.xml"});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  for (const char* line : {"\nMotion\n  time                            0.5 to 2 s, shown at 0 s\n",
                           "\n  frames                          12 to 48, 24 a second\n",
                           "\n  exposure                        of one instant\n",
                           "\n  shapes that move                1 of 2\n"})
    EXPECT_THAT(text.out, HasSubstr(line));
  EXPECT_THAT(text.out, Not(HasSubstr("lights that move")));
  const auto json =
      nlohmann::json::parse(run_penumbra(folder.path(), {"info", "s.xml", "--json"}).out)["motion"];
  EXPECT_EQ(json["times"], (nlohmann::json{0.5, 2.0}));
  EXPECT_EQ(json["frames"], (nlohmann::json{12, 48}));
  EXPECT_EQ(json["fps"], 24.0);
  EXPECT_EQ(json["shapes"], 1);
  EXPECT_EQ(json["camera"], false);
  // At frame 4 of 8 a second.
  std::vector<std::string> shutter = {"info",
                                      "s.xml",
                                      "--frame=4",
                                      "--fps=8",
                                      "--set=camera.shutter=0.5",
                                      "--set=camera.shutter_position=end",
                                      "--set=camera.shutter_curve=triangle",
                                      "--set=camera.rolling_shutter=0.25"};
  EXPECT_THAT(
      run_penumbra(folder.path(), shutter).out,
      HasSubstr("\n  exposure                        0.0625 s, from 0.40625 to 0.5 s, curve triangle, "
                "frame's time at\n"
                "                                  the end; the last row starts 0.03125 s later\n"));
  shutter.push_back("--json");
  const auto exposure = nlohmann::json::parse(run_penumbra(folder.path(), shutter).out)["motion"]["exposure"];
  EXPECT_EQ(exposure, (nlohmann::json{{"open", 0.40625},
                                      {"close", 0.5},
                                      {"seconds", 0.0625},
                                      {"rolling", 0.03125},
                                      {"position", "end"},
                                      {"curve", "triangle"}}));
  write_small_scene(folder / "s.xml");
  EXPECT_THAT(run_penumbra(folder.path(), {"info", "s.xml"}).out, Not(HasSubstr("Motion")));
}

TEST(InfoCommand, SaysWhichDialectOfNoriItReads) {
  const TemporaryFolder folder;
  write_text(folder / "n.xml",
             "<scene><camera type='perspective'/><mesh type='sphere'/><integrator type='normals'/></scene>");
  const ProgramResult told = run_penumbra(folder.path(), {"info", "n.xml"});
  EXPECT_THAT(told.out, HasSubstr("Dialect: nori-eth (it has a <mesh> of type 'sphere')"));
  const ProgramResult chosen = run_penumbra(folder.path(), {"info", "n.xml", "--json", "--dialect", "nori"});
  ASSERT_EQ(chosen.exit_code, 0) << chosen.err;
  EXPECT_EQ(nlohmann::json::parse(chosen.out)["dialect"], "nori (by --dialect)");
  write_small_scene(folder / "s.xml");
  EXPECT_THAT(run_penumbra(folder.path(), {"info", "s.xml"}).out, Not(HasSubstr("Dialect")));
}

TEST(InfoCommand, SaysInNumbersWhatIsLeftOut) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const ProgramResult result = run_penumbra(folder.path(), kInfo);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  const auto& costs = json["costs"];
  std::set<std::string> used, left_out;
  for (const auto& feature : costs["used"]) used.insert(feature["name"]);
  for (const auto& feature : costs["left_out"]) left_out.insert(feature["name"]);
  EXPECT_EQ(used, (std::set<std::string>{"PATH", "LAYERS", "BSDF_DIFFUSE", "LIGHT_RECTANGLE"}));
  EXPECT_TRUE(left_out.contains("BSDF_PHONG"));
  EXPECT_EQ(used.size() + left_out.size(), std::size_t(std::popcount(std::uint64_t(FEATURE_ALL)) +
                                                       std::popcount(EVERY_FAMILY) + LIGHT_KIND_COUNT));

  const auto& bytes = costs["bytes"];
  EXPECT_EQ(bytes["device_scene"]["own"], json["device_scene_bytes"]);
  // Four triangles with a normal at each corner; two polygon lights would be one outline of four corners, the
  // first repeated.
  EXPECT_EQ(bytes["tables"]["vertex normals"]["own"], 0);
  EXPECT_EQ(bytes["tables"]["vertex normals"]["everything"], 4 * sizeof(VertexNormals));
  EXPECT_EQ(bytes["tables"]["polygon lights"]["everything"], sizeof(Polygon));
  EXPECT_EQ(bytes["tables"]["corners of polygon lights"]["everything"], 5 * sizeof(PolygonCorner));
  EXPECT_EQ(bytes["tables"]["nodes of the hierarchy"]["own"], 0);
  EXPECT_GE(bytes["tables"]["nodes of the hierarchy"]["everything"], sizeof(BvhNode));
  std::int64_t more = 0;
  for (const auto& table : bytes["tables"])
    more += table["everything"].get<std::int64_t>() - table["own"].get<std::int64_t>();
  EXPECT_EQ(bytes["device_scene"]["everything"].get<std::int64_t>(),
            bytes["device_scene"]["own"].get<std::int64_t>() + more);
  // 13 planes instead of 55: those of the closed form, of denoising and on demand are not there.
  EXPECT_EQ(bytes["result_per_pixel"]["own"], 4 * 13);
  EXPECT_EQ(bytes["result_per_pixel"]["everything"], 4 * 55);
  EXPECT_LT(bytes["block_state"]["own"], bytes["block_state"]["everything"]);
  EXPECT_EQ(bytes["block_state"]["own"], kBlockPaths * bytes["path_state"]["own"].get<int>());
  EXPECT_TRUE(costs["opencl"].is_null()) << "nothing was measured";
}

TEST(InfoCommand, KnowsTheSizeOfNativeCode) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const auto native = [&](const char* integrator) {
    const ProgramResult result = run_penumbra(
        folder.path(),
        {"info", "s.xml", "--json", "--integrator", integrator, "--set", "integrator.emitter_sampling=area"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out)["costs"]["native"];
  };
  // One set of kernels for all of them, whose stages a scene calls or not.
  EXPECT_GT(native("path")["code_bytes"], 1000);
  EXPECT_EQ(native("path"), native("polygon_cv"));
}

TEST(InfoCommand, MeasuresTheOpenClCompiler) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const ProgramResult result = run_penumbra(folder.path(), {"info", "s.xml", "--json", "--compile"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto opencl = nlohmann::json::parse(result.out)["costs"]["opencl"];
  EXPECT_THAT(opencl["device"].get<std::string>(), HasSubstr("OpenCL"));
  const double own = opencl["compile_seconds"]["own"], everything = opencl["compile_seconds"]["everything"];
  EXPECT_GT(own, 0.01) << "nothing compiles in no time: a cache answered";
  EXPECT_GT(everything, own);
  EXPECT_EQ(opencl["saved_seconds"], everything - own);

  const ProgramResult embree =
      run_penumbra(folder.path(), {"info", "s.xml", "--compile", "--intersector", "embree"});
  EXPECT_EQ(embree.exit_code, 1);
  EXPECT_THAT(embree.err, HasSubstr("--intersector portable"));
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
