#include <fmt/format.h>

#include <cmath>

#include "scheduler/files/quoting.h"
#include "scheduler/report/report_json.h"

namespace penumbra {
namespace {

/// The shortest digits that read back as the same number.
std::string number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

/// Appends a row; text fields must be quoted already.
void add_row(std::string& csv, const std::vector<std::string>& fields) {
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (i > 0) csv += ',';
    csv += fields[i];
  }
  csv += "\r\n";
}

std::vector<std::string> row(const ReportData& report, const SceneReport& scene, const Curve& curve,
                             const CurvePoint& point, const ImageResult& image) {
  const CurveName& name = curve.name;
  std::string settings;
  for (const std::string& setting : name.settings) settings += (settings.empty() ? "" : " ") + setting;
  const auto known = [&](const std::string& text) { return name.peer ? "" : text; };
  const ImageErrors& e = image.errors;
  return {csv_quoted(scene.name),
          csv_quoted(name.label),
          name.peer ? "peer" : "penumbra",
          csv_quoted(name.integrator),
          csv_quoted(settings),
          csv_quoted(name.sampler),
          csv_quoted(name.backend),
          point.spp > 0 ? fmt::to_string(point.spp) : "",
          known(fmt::to_string(image.seed)),
          known(number(image.seconds.build)),
          known(number(image.seconds.transfer)),
          known(number(image.seconds.render)),
          number(image.seconds.total),
          number(report.seconds(image.seconds)),
          known(number(image.load_before)),
          known(number(image.load_after)),
          number(e.mse),
          number(e.relative_mse),
          number(e.trimmed_relative_mse),
          number(e.block_relative_mse),
          number(e.mape),
          number(e.smape),
          number(e.bias),
          number(e.largest),
          fmt::to_string(e.non_finite),
          known(fmt::to_string(image.bad_samples)),
          image.film_hash,
          csv_quoted(image.file.string())};
}

}  // namespace

std::string report_csv(const ReportData& report) {
  std::string csv;
  add_row(csv, {"scene",
                "curve",
                "kind",
                "integrator",
                "settings",
                "sampler",
                "backend",
                "spp",
                "seed",
                "build_seconds",
                "transfer_seconds",
                "render_seconds",
                "total_seconds",
                "seconds",
                "load_before",
                "load_after",
                "mse",
                "relmse",
                "relmse_trimmed",
                "block_relmse",
                "mape",
                "smape",
                "bias",
                "max",
                "non_finite_pixels",
                "bad_samples",
                "film_hash",
                "file"});
  for (const SceneReport& scene : report.scenes)
    for (const Curve& curve : scene.curves)
      for (const CurvePoint& point : curve.points)
        for (const ImageResult& image : point.images) add_row(csv, row(report, scene, curve, point, image));
  return csv;
}

}  // namespace penumbra
