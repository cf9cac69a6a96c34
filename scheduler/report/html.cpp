#include "scheduler/report/html.h"

#include <fmt/format.h>

#include "kernels/host/text.h"
#include "scheduler/files/html_text.h"
#include "scheduler/files/quoting.h"

namespace penumbra {
namespace {

constexpr const char* kStyle = R"css(
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, sans-serif; color: #1a1a1a; background: #fff; margin: 0 auto; max-width: 1180px; padding: 24px; }
h1 { font-size: 26px; margin: 0 0 4px; } h2 { font-size: 21px; margin: 40px 0 8px; border-top: 2px solid #ddd; padding-top: 20px; }
h3 { font-size: 16px; margin: 26px 0 6px; } p { margin: 6px 0; max-width: 90ch; }
.quiet { color: #666; } .warn { background: #fff4d6; border-left: 4px solid #e69f00; padding: 6px 12px; margin: 8px 0; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 14px; margin: 6px 0; }
th { text-align: right; font-weight: 600; color: #444; border-bottom: 1px solid #999; padding: 4px 10px; vertical-align: bottom; }
td { text-align: right; padding: 3px 10px; border-bottom: 1px solid #eee; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; } .scroll { overflow-x: auto; }
.best { font-weight: 700; } .swatch { display: inline-block; width: 11px; height: 11px; border-radius: 2px; margin-right: 7px; }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(460px, 1fr)); gap: 12px; } .plots figure { margin: 0; }
.plots svg { width: 100%; height: auto; } figcaption { font-size: 13px; color: #444; overflow-wrap: anywhere; }
.crops { display: flex; flex-wrap: wrap; gap: 14px; align-items: flex-start; } .crops figure { margin: 0; width: 200px; }
.crops img { width: 200px; height: auto; image-rendering: pixelated; display: block; border: 1px solid #ccc; box-sizing: border-box; }
.crops img + img { margin-top: 4px; } .overview { position: relative; } .overview img { image-rendering: auto; }
.overview .frame { position: absolute; border: 2px solid #e00; box-sizing: border-box; box-shadow: 0 0 0 1px #fff; }
.ramp { display: inline-block; width: 160px; height: 11px; vertical-align: middle; margin: 0 6px; }
code { font-size: 13px; background: #f4f4f4; padding: 1px 4px; overflow-wrap: anywhere; } details { margin: 8px 0; } summary { cursor: pointer; color: #0050a0; }
)css";

std::string load_text(const std::array<double, 3>& load) {
  return fmt::format("{:.2f}, {:.2f}, {:.2f}", load[0], load[1], load[2]);
}

/// Whether other programs used the machine before the first render.
bool was_busy(const ReportData& report) { return report.load_start[0] > 0.5 * report.cores; }

std::string machine_html(const ReportData& report) {
  std::string html = fmt::format(
      "<p>{} on {}, {}; {} with {} each. Load average over 1, 5, 15 minutes: {} at "
      "the "
      "start, {} at the end, our own work included. {} to {}. Penumbra {}.</p>\n<p><code>{}</code></p>\n",
      report.scenes.size() == 1 ? "One scene" : fmt::format("{} scenes", report.scenes.size()),
      html_escaped(report.host), counted(report.cores, "core"), counted(report.workers, "worker"),
      counted(report.threads, "thread"), load_text(report.load_start), load_text(report.load_end),
      report.started, report.finished, report.version, html_escaped(shell_command(report.command_line)));
  if (was_busy(report)) {
    html += fmt::format(
        "<p class=\"warn\">The machine was busy before this report began (load {:.2f} on {}): times "
        "are "
        "those of a shared machine.</p>\n",
        report.load_start[0], counted(report.cores, "core"));
  }
  return html;
}

std::string method_html(const ReportData& report) {
  return fmt::format(
      "<details><summary>How to read this</summary>\n"
      "<p>T is {}, the median over the images of a budget; errors are means over them. MSE: mean of d² over "
      "pixels and channels; relMSE: mean of d² / (reference² + {:g}). Where the reference has two halves A "
      "and B, "
      "d² is (x − A)(x − B), which is free of the noise of both; it may come out negative where the error is "
      "smaller than that noise, and such points have no place on a logarithmic axis.</p>\n"
      "<p>Slopes are least-squares fits of log error over log T through the points of a curve, with a 95 % "
      "confidence interval by Student's t: −1 is what independent samples give. Efficiency, 1 / (MSE T), is "
      "one "
      "number for a curve only where its slope is −1, and is left out elsewhere. Times to a target are "
      "interpolated between budgets; those in parentheses with ~ lie outside of what was measured and follow "
      "the "
      "fitted line.</p>\n"
      "<p>Bias² and variance are separated over the seeds without bias: mean of (x̄ − A)(x̄ − B) − s²/R. Every "
      "image "
      "has a seed of its own, so points are independent. ± is a standard error, from the noise of every "
      "pixel.</p>\n"
      "</details>\n",
      report.total_time ? "the total time: reading, building, starting workers, rendering"
                        : "the render time: from the first worker being ready to the last result, without "
                          "reading and building the scene, starting workers and compiling kernels",
      report.epsilon);
}

std::string reference_html(const SceneReport& scene) {
  const ReferenceSummary& reference = scene.reference;
  std::string html = "<p>Reference: ";
  for (std::size_t i = 0; i < reference.halves.size(); ++i) {
    const ReferenceHalf& half = reference.halves[i];
    html += fmt::format("{}{}{}{}", i > 0 ? "; " : "", html_escaped(half.what),
                        half.spp > 0 ? fmt::format(", {} spp", half.spp) : "",
                        half.seconds > 0 ? ", " + seconds_text(half.seconds) : "");
  }
  if (!reference.quantity.empty()) html += "; it estimates " + html_escaped(reference.quantity);
  if (reference.z) {
    html += fmt::format(". The halves' means differ by {:.1f} standard errors{}", *reference.z,
                        std::abs(*reference.z) > 4 ? ": <b>they do not estimate the same</b>" : "");
  }
  if (reference.noise_relmse) {
    html += fmt::format(". It stands alone: its own noise adds {} to every relMSE, {} to MSE",
                        number_text(*reference.noise_relmse), number_text(*reference.noise_mse));
  } else if (reference.halves.size() == 1) {
    html += ". It stands alone, and its own noise, which is not known, adds to every error";
  }
  return html + ".</p>\n";
}

std::string plots_html(const SceneReport& scene, std::size_t number) {
  if (scene.plots.empty()) return {};
  std::string html = "<div class=\"plots\">\n";
  for (const Plot& plot : scene.plots) {
    const bool orders = plot.name == "samplers";
    html += fmt::format(
        "<figure>{}<figcaption><b>{}</b>{} <a download=\"{}-{}.png\" "
        "href=\"{}\">PNG</a></figcaption></figure>\n",
        inline_svg(plot.svg, fmt::format("s{}{}-", number, plot.name)), plot.title,
        orders ? ". Dashed grey: orders expected for one smooth pixel and for one with an edge."
        : plot.name == "bias" ? ". Bias² only where it is more than three standard errors."
                              : ". In the legend: fitted slopes.",
        html_escaped(scene.name), plot.name, png_uri(plot.png));
  }
  return html + "</div>\n";
}

}  // namespace

std::string report_html(const ReportData& report) {
  std::string html = "<h1>Error against run time</h1>\n" + machine_html(report) + method_html(report);
  for (std::size_t i = 0; i < report.scenes.size(); ++i) {
    const SceneReport& scene = report.scenes[i];
    html += fmt::format("<h2>{}</h2>\n<p class=\"quiet\">{}, {} × {} pixels</p>\n", html_escaped(scene.name),
                        html_escaped(scene.file.string()), scene.width, scene.height);
    html += reference_html(scene);
    for (const std::string& remark : scene.remarks)
      html += "<p class=\"warn\">" + html_escaped(remark) + "</p>\n";
    html += plots_html(scene, i) + scene_crops_html(scene) + scene_tables_html(report, scene);
  }
  return html_page("Error against run time", kStyle, fmt::format("{}\n", kReportPageMarker), html);
}

}  // namespace penumbra
