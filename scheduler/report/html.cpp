#include "scheduler/report/html.h"

#include <fmt/format.h>

#include "kernels/host/text.h"
#include "scheduler/files/html_text.h"
#include "scheduler/files/quoting.h"
#include "scheduler/report/curve_builder.h"
#include "scheduler/report/plot_svg.h"

namespace penumbra {
namespace {

constexpr const char* kStyle = R"css(
body { max-width: 1080px; }
h2 { margin: 48px 0 8px; border-top: 2px solid var(--line); padding-top: 20px; } h3 { margin: 30px 0 6px; }
p { margin: 6px 0; max-width: 80ch; }
.warn { background: var(--warn); border-left: 4px solid #c98a00; padding: 6px 12px; margin: 8px 0; }
table { margin: 6px 0; }
th { text-align: right; font-weight: 600; color: var(--quiet); border-bottom: 1px solid var(--quiet); padding: 4px 10px; vertical-align: bottom; }
td { text-align: right; padding: 4px 10px; border-bottom: 1px solid var(--line); white-space: nowrap; vertical-align: top; }
th:first-child, td:first-child { text-align: left; padding-left: 0; }
.why { display: inline-block; min-width: 17ch; max-width: 26ch; white-space: normal; color: var(--quiet); }
.swatch { display: inline-block; width: 11px; height: 11px; border-radius: 2px; margin-right: 7px; }
figure { margin: 0; } figcaption { font-size: 13px; color: var(--quiet); overflow-wrap: anywhere; } figcaption b { color: var(--text); }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 400px), 1fr)); gap: 20px 24px; margin: 14px 0; }
.plots figure { max-width: 520px; } .plots svg { display: block; width: 100%; }
.crops { display: grid; grid-template-columns: repeat(auto-fill, minmax(150px, 1fr)); gap: 16px; margin: 10px 0; max-width: 100%; }
.crops figure { max-width: 260px; }
.crops img { width: 100%; image-rendering: pixelated; display: block; border: 1px solid var(--line); }
.crops img + img { margin-top: 4px; }
.bar { max-width: 420px; padding: 0 22px; margin: 10px 0; font-size: 13px; } .bar .ramp { height: 14px; border: 1px solid var(--quiet); }
.bar .numbers { position: relative; height: 22px; } .bar .numbers span { position: absolute; top: 4px; transform: translateX(-50%); line-height: 1.2; }
.bar .numbers span::before { content: ""; position: absolute; left: 50%; top: -4px; height: 4px; border-left: 1px solid var(--quiet); }
.flip { max-width: 640px; margin: 10px 0; } .flip .stage { position: relative; } .flip .stage:focus-visible { outline: 3px solid var(--link); }
.flip img { width: 100%; display: block; image-rendering: pixelated; border: 1px solid var(--line); margin-bottom: 4px; }
.flip.on img { cursor: pointer; margin: 0; } .flip.on img:not(.shown) { display: none; }
.flip .frame { position: absolute; border: 2px solid #e00; box-shadow: 0 0 0 1px #fff; pointer-events: none; }
.flip:not(.on) .frame { display: none; } .flip .choices { display: flex; flex-wrap: wrap; gap: 6px; margin: 8px 0; }
button { font: 600 13px/1.3 system-ui, sans-serif; color: var(--text); background: var(--soft); border: 1px solid var(--quiet);
  border-radius: 5px; padding: 6px 10px; max-width: 100%; overflow-wrap: anywhere; text-align: left; cursor: pointer; }
button[aria-pressed=true] { background: var(--text); color: var(--page); border-color: var(--text); }
details { margin: 10px 0; }
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
      "and B, d² is (x − A)(x − B), which is free of the noise of both; it may come out negative where the "
      "error is smaller than that noise, and such points have no place on a logarithmic axis.</p>\n"
      "<p>Plots: bars are ± one standard error over the seeds. Plots of one kind have the same axes in all "
      "scenes.</p>\n"
      "<p>Slopes are least-squares fits of log error over log T through the points of a curve, with a 95 % "
      "confidence interval by Student's t: −1 is what independent samples give. Budgets that take less time "
      "than the start (reading, building, starting workers), or less than {:g} times what starting the "
      "workers "
      "takes, do not count for slopes over T; there is no slope for fewer than {} budgets, or a span below a "
      "factor of {:g}. Efficiency, 1 / (MSE T), is one "
      "number for a curve only where its slope is −1, and is left out elsewhere. Times to a target are "
      "interpolated between budgets, never extrapolated; the fastest is bold where it is certain.</p>\n"
      "<p>Bias² and variance are separated over the seeds without bias: mean of (x̄ − A)(x̄ − B) − s²/R. Every "
      "image has a seed of its own, so points are independent. ± is a standard error, from the noise of "
      "every pixel.</p>\n"
      "</details>\n",
      report.total_time ? "the total time: reading, building, starting workers, rendering"
                        : "the render time: from the first worker being ready to the last result, without "
                          "reading and building the scene, starting workers and compiling kernels",
      report.epsilon, kStartsOfWorkers, kFewestFitPoints, kSmallestSpan);
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
        themed_svg(inline_svg(plot.svg, fmt::format("s{}{}-", number, plot.name))), plot.title,
        orders ? ". Dashed grey: orders expected for one smooth pixel and for one with an edge."
        : plot.name == "bias" ? ". Bias² only where it is more than three standard errors."
                              : ". In the legend: fitted slopes, where there are any.",
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
    html += plots_html(scene, i) + scene_summary_html(scene) + scene_crops_html(scene) +
            scene_tables_html(report, scene);
  }
  return html_page("Error against run time", plot_colors_css() + kStyle,
                   fmt::format("{}\n", kReportPageMarker), html + flip_script());
}

}  // namespace penumbra
