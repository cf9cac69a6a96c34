// The report in a browser.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scheduler/image/image_files.h"
#include "scheduler/report/gnuplot.h"
#include "scheduler/report/html.h"
#include "scheduler/report/plot.h"
#include "tests/scheduler/report/some_report.h"
#include "tests/support/readable_page.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

std::vector<std::uint8_t> picture(int width, int height) {
  return encode_png_bytes(width, height, std::vector<std::uint8_t>(std::size_t(3 * width * height), 90))
      .value();
}

/// A report with long labels, pictures, and plots if there is a gnuplot.
ReportData large_report(const std::filesystem::path& folder) {
  ReportData report = some_report();
  report.command_line = {"penumbra", "report",
                         "/a/long/path/without/any/spaces/" + std::string(120, 'x') + ".xml"};
  SceneReport& scene = report.scenes[0];
  scene.name = "a-scene-with-a-name-that-does-not-fit-into-a-line-of-a-phone-at-all";
  scene.curves[0].name.label = "control variates: path_mis (mis=balance, max_depth=-1, nee=cv), sobol";
  scene.curves[0].points.push_back(point_of(4096, 4096, 1e-7));  // labels with powers of ten
  finish_curve(report, scene.targets, scene.curves[0]);
  scene.curves[1].points.resize(2);
  scene.curves[1].points[1].relative_mse_error = 0.1;
  finish_curve(report, scene.targets, scene.curves[1]);  // now without slopes
  CropSet crops;
  crops.width = crops.height = 20;
  crops.overview_width = 600;
  crops.overview_height = 300;
  crops.seconds = 4;
  crops.overview_png = picture(600, 300);
  crops.reference_png = picture(20, 20);
  for (const ErrorCurve& curve : scene.curves) {
    CropPicture one;
    one.label = curve.name.label;
    one.seconds = curve.points.back().seconds.render;
    one.png = one.heat_png = picture(20, 20);
    one.whole_png = picture(600, 300);
    crops.pictures.push_back(one);
  }
  scene.crops = crops;
  report.scenes.push_back(scene);
  if (const auto gnuplot = find_gnuplot()) {
    for (SceneReport& drawn : report.scenes)
      drawn.plots = draw_plots(*gnuplot, folder, report, drawn).value();
  }
  return report;
}

TEST(ReportPage, IsReadableOnPhonesAndLaptopsInLightAndDark) {
  if (!find_browser()) GTEST_SKIP() << kNoBrowser;
  if (!find_gnuplot()) GTEST_SKIP() << find_gnuplot().error().message;
  const TemporaryFolder folder;
  // Two scenes with four plots of at least 10 labels each.
  expect_readable(report_html(large_report(folder.path())), 2 * 4 * 10);
}

/// The number of texts in an SVG that begin so.
std::size_t texts(const std::string& svg, const std::string& begin) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = svg.find("<text>" + begin, at)) != std::string::npos; ++at) ++count;
  return count;
}

TEST(ReportPage, LegendsFitWhateverTheLengthOfLabels) {
  if (!find_browser()) GTEST_SKIP() << kNoBrowser;
  const auto gnuplot = find_gnuplot();
  if (!gnuplot) GTEST_SKIP() << gnuplot.error().message;
  const TemporaryFolder folder;
  ReportData report = some_report();
  SceneReport scene = report.scenes[0];
  for (ErrorCurve& curve : scene.curves)
    for (CurvePoint& point : curve.points) {  // so that numbers at the axis are as wide as 5·10⁻⁶
      point.errors.mse *= 1e-5;
      point.errors.relative_mse *= 1e-5;
    }
  report.scenes.clear();
  for (const std::size_t length : {1, 2, 3, 4, 5, 6, 8, 11, 15, 20, 25, 34, 49}) {
    report.scenes.push_back(scene);
    report.scenes.back().curves.resize(1 + length % 3);
    report.scenes.back().name = std::to_string(length);
    for (ErrorCurve& curve : report.scenes.back().curves)
      curve.name.label = std::string("path_mis: mis=MAXIMUM, max_depth=-1, nee=CV, SOBOL").substr(0, length) +
                         curve.name.label.front();
  }
  for (SceneReport& drawn : report.scenes) {
    drawn.plots = draw_plots(*gnuplot, folder.path(), report, drawn).value();
    // gnuplot leaves entries out that do not fit.
    EXPECT_EQ(texts(drawn.plots[0].svg, "p"), drawn.curves.size()) << drawn.curves[0].name.label;
    EXPECT_EQ(texts(drawn.plots[1].svg, "p"), std::min<std::size_t>(drawn.curves.size(), 2)) << "no peer";
    EXPECT_EQ(texts(drawn.plots[1].svg, "slope −1"), 1u);
  }
  const auto seen = view_page(report_html(report), {});
  ASSERT_TRUE(seen) << seen.error().message;
  EXPECT_GE((*seen)["svg_texts"].get<int>(), 13 * 3 * 10);
  EXPECT_EQ((*seen)["cut_off"], nlohmann::json::array());
}

TEST(ReportPage, SwitchesBetweenImagesInPlace) {
  if (!find_browser()) GTEST_SKIP() << kNoBrowser;
  const TemporaryFolder folder;
  const auto seen = view_page(report_html(large_report(folder.path())), {.script = R"js((() => {
    const viewer = document.querySelector(".flip"), stage = viewer.querySelector(".stage"), shown = [];
    const note = () => {
      const visible = [...stage.querySelectorAll("img")].filter(image => image.getClientRects().length);
      const pressed = [...viewer.querySelectorAll("button")].filter(b => b.getAttribute("aria-pressed") === "true");
      shown.push([visible.map(image => image.alt), pressed.map(b => b.textContent), stage.offsetTop, stage.offsetHeight]);
    };
    const press = key => stage.dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true}));
    note();
    press("3"); note();
    press("ArrowRight"); note();
    stage.click(); note();
    press("ArrowLeft"); note();
    viewer.querySelectorAll("button")[0].click(); note();
    return shown;
  })())js"});
  ASSERT_TRUE(seen) << seen.error().message;
  const auto& shown = (*seen)["script"];
  const std::vector<std::string> expected = {"reference", "two", "peer", "reference", "peer", "reference"};
  ASSERT_EQ(shown.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(shown[i][0], nlohmann::json::array({expected[i]})) << i;
    ASSERT_EQ(shown[i][1].size(), 1u);
    EXPECT_THAT(shown[i][1][0].get<std::string>(), testing::HasSubstr(expected[i]));
    EXPECT_EQ(shown[i][2], shown[0][2]) << "in place";
    EXPECT_EQ(shown[i][3], shown[0][3]) << "in place";
  }
}

}  // namespace
}  // namespace penumbra
