// The files of a report contain the values that it was made from.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>

#include "scheduler/files/html_text.h"
#include "scheduler/report/curve_builder.h"
#include "scheduler/report/html.h"
#include "scheduler/report/plot.h"
#include "scheduler/report/plot_axes.h"
#include "scheduler/report/plot_svg.h"
#include "scheduler/report/report_json.h"
#include "scheduler/report/summary_table.h"
#include "tests/scheduler/report/some_report.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Fields of RFC 4180, none of which holds a line end here.
std::vector<std::vector<std::string>> read_csv(const std::string& text) {
  std::vector<std::vector<std::string>> rows(1, std::vector<std::string>(1));
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string& field = rows.back().back();
    if (quoted) {
      if (text[i] != '"') {
        field += text[i];
      } else if (i + 1 < text.size() && text[i + 1] == '"') {
        field += text[i++];
      } else {
        quoted = false;
      }
    } else if (text[i] == '"') {
      quoted = true;
    } else if (text[i] == ',') {
      rows.back().emplace_back();
    } else if (text[i] == '\n') {
      rows.emplace_back(1);
    } else if (text[i] != '\r') {
      field += text[i];
    }
  }
  rows.pop_back();
  return rows;
}

TEST(ReportJson, IntervalsOfSlopesHaveTheirEnds) {
  ReportData report = some_report();
  Slope& slope = report.scenes[0].curves[0].mse_over_time;
  ASSERT_TRUE(slope.fit);
  slope.fit->low = -1.25;
  slope.fit->high = -0.75;
  const auto fit = report_data_json(report)["scenes"][0]["curves"][0]["fits"]["mse_over_time"];
  EXPECT_EQ(fit["low"], -1.25);
  EXPECT_EQ(fit["high"], -0.75);
}

TEST(ReportJson, ReadsBack) {
  const auto json = nlohmann::json::parse(report_data_json(some_report()).dump());
  const auto& scene = json["scenes"][0];
  EXPECT_EQ(scene["file"], "a&b.xml");
  EXPECT_EQ(scene["reference"]["images"][0]["spp"], 64);
  const auto& curve = scene["curves"][0];
  EXPECT_EQ(curve["label"], "one, \"quoted\"");
  EXPECT_NEAR(curve["fits"]["mse_over_time"]["slope"].get<double>(), -1, 1e-12);
  EXPECT_NEAR(curve["efficiency"].get<double>(), 1, 1e-12);
  EXPECT_NEAR(scene["curves"][1]["fits"]["mse_over_spp"]["slope"].get<double>(), -2, 1e-12);
  EXPECT_TRUE(scene["curves"][1]["efficiency"].is_null()) << "its slope is not -1";
  EXPECT_EQ(scene["curves"][1]["no_efficiency_because"], "slope is not -1");
  // relMSE is 2 / T: 0.5 at 4 s; MSE 1e-9 lies at 1e9 s.
  EXPECT_NEAR(curve["time_to_target"][0]["seconds"].get<double>(), 4, 1e-9);
  EXPECT_TRUE(curve["time_to_target"][0]["longer_than"].is_null());
  EXPECT_TRUE(curve["time_to_target"][1]["seconds"].is_null()) << "nothing is extrapolated";
  EXPECT_EQ(curve["time_to_target"][1]["longer_than"], 8.0);
  EXPECT_TRUE(scene["curves"][2]["fits"]["mse_over_time"]["slope"].is_null());
  EXPECT_THAT(scene["curves"][2]["fits"]["mse_over_time"]["none_because"].get<std::string>(),
              HasSubstr("fewer than 3 budgets"));
  const auto& point = curve["points"][2];
  EXPECT_EQ(point["spp"], 4);
  EXPECT_EQ(point["seconds"]["render"], 4.0);
  EXPECT_EQ(point["errors"]["mse"], 0.25);
  EXPECT_TRUE(point["errors"]["bias"].is_null()) << "not a number";
  EXPECT_TRUE(scene["curves"][2]["points"][0]["spp"].is_null());
}

TEST(ReportJson, TargetsOfBlocks) {
  ReportData report = some_report();
  SceneReport& scene = report.scenes[0];
  scene.targets = {{.relative = true, .error = 0.125, .blocks = true}};
  for (ErrorCurve& curve : scene.curves) finish_curve(report, scene.targets, curve);
  const auto json = nlohmann::json::parse(report_data_json(report).dump())["scenes"][0];
  EXPECT_EQ(json["targets"][0]["metric"], "block_relmse");
  // Of blocks it is 1 / (4 T) and 1 / (4 T^2).
  EXPECT_NEAR(json["curves"][0]["time_to_target"][0]["seconds"].get<double>(), 2, 1e-9);
  EXPECT_NEAR(json["curves"][1]["time_to_target"][0]["seconds"].get<double>(), std::sqrt(2.0), 1e-9);
  EXPECT_EQ(json["curves"][0]["points"][2]["errors"]["block_relmse"], 0.25 / 4);
}

TEST(ReportCsv, ReadsBack) {
  const auto rows = read_csv(report_csv(some_report()));
  ASSERT_EQ(rows.size(), 1u + 2 * (4 + 4 + 1));
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  const auto column = [&](const std::string& name) {
    return std::size_t(std::ranges::find(rows[0], name) - rows[0].begin());
  };
  EXPECT_EQ(rows[1][column("curve")], "one, \"quoted\"");
  EXPECT_EQ(rows[1][column("file")], "cells/a,b.exr");
  EXPECT_EQ(std::stod(rows[7][column("mse")]), 0.125);
  EXPECT_EQ(std::stod(rows[7][column("seconds")]), 8);
  EXPECT_EQ(rows[7][column("bias")], "");
  EXPECT_EQ(rows.back()[column("kind")], "peer");
  EXPECT_EQ(rows.back()[column("spp")], "");
}

TEST(Csv, ColumnsHaveUniqueNames) {
  const ReportData report = some_report();
  for (const std::string& csv : {report_csv(report), summary_csv(report)}) {
    std::vector<std::string> names = read_csv(csv)[0];
    std::ranges::sort(names);
    EXPECT_EQ(std::ranges::adjacent_find(names), names.end()) << csv.substr(0, csv.find('\n'));
  }
}

TEST(ReportHtml, IsSelfContainedAndEscaped) {
  ReportData report = some_report();
  report.scenes[0].plots = {{"time",
                             "t",
                             "<?xml?><!-- c --><svg xmlns=\"http://www.w3.org/2000/svg\"><g id=\"a\"/></svg>",
                             {1, 2}}};
  const std::string html = report_html(report);
  std::string rest = html;
  rest.erase(rest.find(flip_script()), flip_script().size());
  EXPECT_THAT(rest, Not(HasSubstr("<script")));
  EXPECT_THAT(rest, HasSubstr("&lt;script&gt;"));
  EXPECT_THAT(html, HasSubstr("&lt;host&gt;"));
  const std::regex link(R"re((src|href)\s*=\s*["'](?!data:|#))re"), address(R"(https?://)");
  EXPECT_FALSE(std::regex_search(html, link));
  const std::string without_namespaces =
      std::regex_replace(html, std::regex(R"re(xmlns(:\w+)?="[^"]*")re"), "");
  EXPECT_FALSE(std::regex_search(without_namespaces, address));
}

TEST(HtmlText, Base64OfRfc4648) {
  const auto encoded = [](const std::string& text) {
    return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xff\xfe\xfd"), "//79");
}

TEST(HtmlText, InlineSvgHasIdsOfItsOwn) {
  EXPECT_EQ(
      inline_svg("<?xml?>\n<svg><!-- x --><g id=\"a\"/><use xlink:href='#a'/><p c=\"url(#a)\"/></svg>", "p-"),
      "<svg><g id=\"p-a\"/><use xlink:href='#p-a'/><p c=\"url(#p-a)\"/></svg>");
  EXPECT_EQ(inline_svg("nothing", "p-"), "");
}

TEST(HtmlText, NumbersAndTimesForPeople) {
  EXPECT_EQ(number_text(0.012345), "0.0123");
  EXPECT_EQ(number_text(1.2345e-5), "1.23e-05");
  EXPECT_EQ(number_text(0), "0");
  EXPECT_EQ(number_text(NAN), "–");
  EXPECT_EQ(seconds_text(0.01234), "0.0123 s");
  EXPECT_EQ(seconds_text(125.9), "2 min 05 s");
  EXPECT_EQ(seconds_text(9000), "2.5 h");
}

TEST(Plots, OfSamplersShowExpectedOrders) {
  const ReportData report = some_report();
  const std::string script = sampler_plot_script(report, report.scenes[0]);
  EXPECT_THAT(script, HasSubstr("expected order -1'"));
  EXPECT_THAT(script, HasSubstr("expected order -3"));
  SceneReport one = report.scenes[0];
  one.curves.resize(1);
  EXPECT_EQ(sampler_plot_script(report, one), "") << "one sampler is no comparison";
}

TEST(Plots, HoldEveryPointThatHasALogarithm) {
  ReportData report = some_report();
  report.scenes[0].curves[0].points[1].errors.relative_mse = -1;
  const std::string script = time_plot_script(report, report.scenes[0]);
  EXPECT_THAT(script, HasSubstr("\n1 2 2 2\n4 0.5 0.5 0.5\n8 0.25 0.25 0.25\nEOD"));
  EXPECT_THAT(script, HasSubstr("'one, \"quoted\" ("));
}

TEST(Plots, HaveErrorBarsOverSeedsAndALineOfSlopeMinusOne) {
  ReportData report = some_report();
  report.scenes[0].curves[0].points[2].relative_mse_error = 0.1;
  const std::string script = time_plot_script(report, report.scenes[0]);
  EXPECT_THAT(script, HasSubstr("\n4 0.5 0.4 0.6\n"));
  EXPECT_THAT(script, HasSubstr("using 1:2:3:4 with yerrorlines"));
  // The last data block is the line: its product of time and error is the same at both ends, and less than
  // that of all points: 2 T^-2 at 8 s has 0.25.
  const std::size_t begin = script.rfind(" << EOD\n") + 8;
  double x[2], y[2];
  ASSERT_EQ(std::sscanf(script.c_str() + begin, "%lf %lf\n%lf %lf\nEOD", &x[0], &y[0], &x[1], &y[1]), 4);
  EXPECT_NEAR(x[0] * y[0], x[1] * y[1], 1e-6);
  EXPECT_LT(x[0] * y[0], 0.25);
  EXPECT_LT(x[0], x[1]);
}

/// "[0.1:2]" of the axis.
std::string range_in(const std::string& script, char axis) {
  const std::size_t at = script.find(std::string("set ") + axis + "range ");
  return script.substr(at, script.find('\n', at) - at);
}

TEST(Plots, OfOneKindHaveTheSameAxesInAllScenes) {
  ReportData report = some_report();
  report.scenes.push_back(report.scenes[0]);
  report.scenes[1].curves[1].points.push_back(point_of(64, 300, 1e-6));
  for (const char axis : {'x', 'y'}) {
    const std::string range = range_in(time_plot_script(report, report.scenes[0]), axis);
    EXPECT_EQ(range, range_in(time_plot_script(report, report.scenes[1]), axis));
    EXPECT_NE(range, range_in(time_plot_script(some_report(), some_report().scenes[0]), axis));
  }
}

TEST(Plots, AreOneObjectForScreenReadersAndFollowThePage) {
  const std::string svg =
      "<?xml?>\n<svg width=\"1\"\n>\n<title>Gnuplot</title>\n<desc>Produced by</desc>\n<g fill=\"black\" "
      "stroke='rgb(  0, 114, 178)' color=\"#DDDDDD\"/></svg>";
  const std::string described = described_svg(svg, "a < b", "text");
  EXPECT_THAT(described, HasSubstr("role=\"img\" aria-label=\"a &lt; b. text\""));
  EXPECT_THAT(described, HasSubstr("<title>a &lt; b</title>\n<desc>text</desc>"));
  EXPECT_THAT(described, Not(HasSubstr("Gnuplot")));
  EXPECT_THAT(themed_svg(described), HasSubstr("<g fill=\"var(--plot-text)\" stroke='var(--curve-0)' "
                                               "color=\"var(--plot-grid)\"/>"));
}

TEST(Plots, TicksOfPowersOfTen) {
  EXPECT_EQ(tick_text(0.05), "0.05");
  EXPECT_EQ(tick_text(0.001), "0.001");
  EXPECT_EQ(tick_text(1e-12), "10⁻¹²");
  EXPECT_EQ(tick_text(2e-5), "2·10⁻⁵");
  EXPECT_EQ(tick_text(1e6), "10⁶");
}

TEST(Slopes, AreNotClaimedFromRunsShorterThanTheStart) {
  // Starts of 3.5 s, all of it building; and starting workers in a fourth of that.
  for (const auto& [build, transfer] : {std::pair{3.5, 0.0}, {0.0, 0.875}}) {
    ReportData report = some_report();
    ErrorCurve& curve = report.scenes[0].curves[0];
    const auto start = [&, build = build, transfer = transfer] {
      for (CurvePoint& point : curve.points)
        for (ImageResult& image : point.images) {
          image.seconds.build = build;
          image.seconds.transfer = transfer;
        }
      finish_curve(report, report.scenes[0].targets, curve);
    };
    start();
    EXPECT_EQ(shortest_timed(curve), 3.5);
    // The runs of 1 and 2 s do not count, and two are left.
    EXPECT_FALSE(curve.mse_over_time.fit);
    EXPECT_EQ(curve.mse_over_time.none_because, "2 of 4 budgets are too short to time, below 3.5 s");
    EXPECT_FALSE(curve.efficiency);
    EXPECT_EQ(curve.no_efficiency, "no slope");
    EXPECT_TRUE(curve.mse_over_spp.fit) << "samples are counted, not timed";
    EXPECT_THAT(report_html(report), HasSubstr("no slope: 2 of 4 budgets are too short to time"));
    // With longer runs the same curve has a slope, from those.
    curve.points.push_back(point_of(16, 16, 1.0 / 16));
    start();
    ASSERT_TRUE(curve.mse_over_time.fit) << curve.mse_over_time.none_because;
    EXPECT_EQ(curve.mse_over_time.fit->points, 3);
  }
}

TEST(Slopes, OfPeersCountAllRuns) {
  ReportData report = some_report();
  ErrorCurve& peer = report.scenes[0].curves[2];
  for (const double seconds : {0.01, 0.02, 0.04}) peer.points.push_back(point_of(0, seconds, 1 / seconds));
  finish_curve(report, report.scenes[0].targets, peer);
  ASSERT_TRUE(peer.mse_over_time.fit);
  EXPECT_EQ(peer.mse_over_time.fit->points, 4);
}

TEST(SummaryTable, HoldsTimesAsTheyWereMeasured) {
  ReportData report = some_report();
  const auto rows = read_csv(summary_csv(report));
  ASSERT_EQ(rows.size(), 1u + 3 * 2);
  const auto column = [&](const std::string& name) {
    return std::size_t(std::ranges::find(rows[0], name) - rows[0].begin());
  };
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  EXPECT_EQ(rows[1][column("method")], "one, \"quoted\"");
  EXPECT_NEAR(std::stod(rows[1][column("seconds")]), 4, 1e-9);
  EXPECT_EQ(rows[2][column("seconds")], "");
  EXPECT_EQ(rows[2][column("longer_than")], "8");
  EXPECT_EQ(rows[5][column("longer_than")], "3") << "the peer's only image";
}

TEST(SummaryTable, LatexIsEscaped) {
  ReportData report = some_report();
  report.host = "a_b";
  report.scenes[0].curves[0].name.label = "50% \\input{x} & #1_$";
  const std::string latex = summary_latex(report);
  EXPECT_TRUE(latex.starts_with(kLatexMarker));
  EXPECT_THAT(latex, HasSubstr("\n50\\% \\textbackslash{}input\\{x\\} \\& \\#1\\_\\$ & "));
  EXPECT_THAT(latex, HasSubstr("\\textbf{$2$}")) << "relMSE 0.5 of 2 T^-2";
  EXPECT_THAT(latex, HasSubstr("$>$ $8$ \\\\"));
  EXPECT_THAT(latex, HasSubstr(" $10^{-9}$"));
  EXPECT_THAT(latex, Not(HasSubstr("–")));
}

TEST(EqualTime, ErrorIsInterpolatedInLogarithms) {
  const ReportData report = some_report();
  EXPECT_NEAR(error_at_time(report, report.scenes[0].curves[0], 3), 2.0 / 3, 1e-12);
  EXPECT_TRUE(std::isnan(error_at_time(report, report.scenes[0].curves[0], 9)));
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
}

TEST(CommonTarget, IsWhatEveryCurveReaches) {
  const auto target = common_target(some_report(), some_report().scenes[0].curves);
  ASSERT_TRUE(target);
  EXPECT_DOUBLE_EQ(target->error, 0.6) << "the peer's only image";
}

}  // namespace
}  // namespace penumbra
