#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "scheduler/files/quoting.h"
#include "scheduler/report/report_json.h"

namespace penumbra {
namespace {

/// The shortest digits that read back as the same number.
std::string number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

struct Row {
  const ReportData& report;
  const SceneReport& scene;
  const ErrorCurve& curve;
  const CurvePoint& point;
  const ImageResult& image;

  [[nodiscard]] const CurveName& name() const { return curve.name; }
  /// What is not known of a peer's image.
  [[nodiscard]] std::string known(std::string text) const { return name().peer ? "" : text; }
};

struct Column {
  const char* name;
  std::string (*text)(const Row& row);  ///< quoted where it may have to be
};

constexpr Column kColumns[] = {
    {"scene", [](const Row& row) { return csv_quoted(row.scene.name); }},
    {"curve", [](const Row& row) { return csv_quoted(row.name().label); }},
    {"kind", [](const Row& row) { return std::string(row.name().peer ? "peer" : "penumbra"); }},
    {"integrator", [](const Row& row) { return csv_quoted(row.name().integrator); }},
    {"settings",
     [](const Row& row) { return csv_quoted(fmt::format("{}", fmt::join(row.name().settings, " "))); }},
    {"sampler", [](const Row& row) { return csv_quoted(row.name().sampler); }},
    {"backend", [](const Row& row) { return csv_quoted(row.name().backend); }},
    {"spp", [](const Row& row) { return row.point.spp > 0 ? fmt::to_string(row.point.spp) : std::string(); }},
    {"seed", [](const Row& row) { return row.known(fmt::to_string(row.image.seed)); }},
    {"build_seconds", [](const Row& row) { return row.known(number(row.image.seconds.build)); }},
    {"transfer_seconds", [](const Row& row) { return row.known(number(row.image.seconds.transfer)); }},
    {"render_seconds", [](const Row& row) { return row.known(number(row.image.seconds.render)); }},
    {"total_seconds", [](const Row& row) { return number(row.image.seconds.total); }},
    {"seconds", [](const Row& row) { return number(row.report.seconds(row.image.seconds)); }},
    {"load_before", [](const Row& row) { return row.known(number(row.image.load_before)); }},
    {"load_after", [](const Row& row) { return row.known(number(row.image.load_after)); }},
    {"mse", [](const Row& row) { return number(row.image.errors.mse); }},
    {"relmse", [](const Row& row) { return number(row.image.errors.relative_mse); }},
    {"trimmed_relmse", [](const Row& row) { return number(row.image.errors.trimmed_relative_mse); }},
    {"block_relmse", [](const Row& row) { return number(row.image.errors.block_relative_mse); }},
    {"mape", [](const Row& row) { return number(row.image.errors.mape); }},
    {"smape", [](const Row& row) { return number(row.image.errors.smape); }},
    {"bias", [](const Row& row) { return number(row.image.errors.bias); }},
    {"max", [](const Row& row) { return number(row.image.errors.largest); }},
    {"non_finite_pixels", [](const Row& row) { return fmt::to_string(row.image.errors.non_finite); }},
    {"bad_samples", [](const Row& row) { return row.known(fmt::to_string(row.image.bad_samples)); }},
    {"film_hash", [](const Row& row) { return row.image.film_hash; }},
    {"file", [](const Row& row) { return csv_quoted(row.image.file.string()); }},
};

std::string line_of(const Row& row) {
  std::vector<std::string> fields;
  for (const Column& column : kColumns) fields.push_back(column.text(row));
  return csv_line(fields);
}

}  // namespace

std::string report_csv(const ReportData& report) {
  std::vector<std::string> names;
  for (const Column& column : kColumns) names.emplace_back(column.name);
  std::string csv = csv_line(names);
  for (const SceneReport& scene : report.scenes)
    for (const ErrorCurve& curve : scene.curves)
      for (const CurvePoint& point : curve.points)
        for (const ImageResult& image : point.images) csv += line_of({report, scene, curve, point, image});
  return csv;
}

}  // namespace penumbra
