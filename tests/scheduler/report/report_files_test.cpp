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
#include "scheduler/report/report_json.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

CurvePoint point_of(std::uint32_t spp, double seconds, double mse) {
  CurvePoint point;
  point.spp = spp;
  ImageResult image;
  image.file = "cells/a,b.exr";
  image.seconds = {0.01, 0.02, seconds, seconds + 0.04};
  image.render_seconds = {seconds};
  image.film_hash = "00ff";
  image.seed = 5;
  image.errors.mse = mse;
  image.errors.relative_mse = 2 * mse;
  image.errors.block_relative_mse = mse / 4;
  image.errors.bias = NAN;
  point.images = {image, image};
  point.seconds = image.seconds;
  point.errors = image.errors;
  point.squared = {mse, mse, 1e-9, 1e-8};
  point.relative = {2 * mse, 2 * mse, 1e-9, 1e-8};
  return point;
}

/// Two curves with MSE = 1 / T and 1 / T^2, and one of a peer.
ReportData some_report() {
  ReportData report;
  report.version = "1";
  report.host = "<host>";
  report.command_line = {"penumbra", "report", "a \"b\".xml"};
  report.cores = 4;
  SceneReport scene;
  scene.name = "s";
  scene.file = "a&b.xml";
  scene.targets = {{true, 0.5}, {false, 1e-9}};
  scene.reference.halves = {{"truth", "t.exr", 64, 1.5}};
  for (const double slope : {1.0, 2.0}) {
    Curve curve;
    curve.name.label = slope == 1 ? "one, \"quoted\"" : "two";
    curve.name.sampler = slope == 1 ? "independent" : "sobol";
    for (const std::uint32_t spp : {1u, 2u, 4u, 8u})
      curve.points.push_back(point_of(spp, spp, std::pow(spp, -slope)));
    scene.curves.push_back(curve);
  }
  Curve peer;
  peer.name.label = "peer";
  peer.name.peer = true;
  peer.points = {point_of(0, 3, 0.3)};
  scene.curves.push_back(peer);
  for (Curve& curve : scene.curves) finish_curve(report, scene.targets, curve);
  scene.remarks = {"<script>"};
  report.scenes = {scene};
  return report;
}

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
  EXPECT_EQ(curve["time_to_target"][0]["extrapolated"], false);
  EXPECT_NEAR(curve["time_to_target"][1]["seconds"].get<double>(), 1e9, 1);
  EXPECT_EQ(curve["time_to_target"][1]["extrapolated"], true);
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
  for (Curve& curve : scene.curves) finish_curve(report, scene.targets, curve);
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

TEST(ReportHtml, IsSelfContainedAndEscaped) {
  ReportData report = some_report();
  report.scenes[0].plots = {{"time",
                             "t",
                             "<?xml?><!-- c --><svg xmlns=\"http://www.w3.org/2000/svg\"><g id=\"a\"/></svg>",
                             {1, 2}}};
  const std::string html = report_html(report);
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, HasSubstr("&lt;script&gt;"));
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
  const std::string script = sampler_plot_script(report.scenes[0]);
  EXPECT_THAT(script, HasSubstr("expected order -1'"));
  EXPECT_THAT(script, HasSubstr("expected order -3"));
  SceneReport one = report.scenes[0];
  one.curves.resize(1);
  EXPECT_EQ(sampler_plot_script(one), "") << "one sampler is no comparison";
}

TEST(Plots, HoldEveryPointThatHasALogarithm) {
  ReportData report = some_report();
  report.scenes[0].curves[0].points[1].errors.relative_mse = -1;
  const std::string script = time_plot_script(report, report.scenes[0]);
  EXPECT_THAT(script, HasSubstr("\n1 2\n4 0.5\n8 0.25\nEOD"));
  EXPECT_THAT(script, HasSubstr("'one, \"quoted\" ("));
}

TEST(EqualTime, ErrorIsInterpolatedInLogarithms) {
  const ReportData report = some_report();
  EXPECT_NEAR(error_at_time(report, report.scenes[0].curves[0], 3), 2.0 / 3, 1e-12);
  EXPECT_TRUE(std::isnan(error_at_time(report, report.scenes[0].curves[0], 9)));
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
}

TEST(CommonTarget, IsWhatEveryCurveReaches) {
  const auto target = common_target(some_report().scenes[0].curves);
  ASSERT_TRUE(target);
  EXPECT_DOUBLE_EQ(target->error, 0.6) << "the peer's only image";
}

}  // namespace
}  // namespace penumbra
