#include "scheduler/report/report_json.h"

#include <nlohmann/json.hpp>

#include "scheduler/files/json_number.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

template <typename T>
Json optional(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json seconds_json(const PhaseSeconds& seconds) {
  return {{"build", seconds.build},
          {"transfer", seconds.transfer},
          {"render", seconds.render},
          {"total", seconds.total}};
}

Json errors_json(const ImageErrors& errors) {
  return {{"mse", json_number(errors.mse)},
          {"relmse", json_number(errors.relative_mse)},
          {"trimmed_relmse", json_number(errors.trimmed_relative_mse)},
          {"block_relmse", json_number(errors.block_relative_mse)},
          {"mape", json_number(errors.mape)},
          {"smape", json_number(errors.smape)},
          {"bias", json_number(errors.bias)},
          {"max", json_number(errors.largest)},
          {"non_finite_pixels", errors.non_finite}};
}

Json split_json(const ErrorSplit& split) {
  return {{"error", json_number(split.error)},
          {"variance", json_number(split.variance)},
          {"bias_squared", json_number(split.bias_squared)},
          {"bias_squared_standard_error", json_number(split.bias_squared_error)}};
}

Json fit_json(const Slope& slope) {
  const auto& fit = slope.fit;
  if (!fit) return {{"slope", nullptr}, {"none_because", slope.none_because}};
  return {{"slope", fit->slope},         {"low", fit->low},
          {"high", fit->high},           {"confidence", fit->confidence},
          {"intercept", fit->intercept}, {"residual", fit->residual},
          {"points", fit->points}};
}

Json image_json(const ImageResult& image, bool peer) {
  if (peer) {
    return {{"file", image.file.string()},
            {"seconds", image.seconds.total},
            {"errors", errors_json(image.errors)}};
  }
  return {{"file", image.file.string()},
          {"seed", image.seed},
          {"seconds", seconds_json(image.seconds)},
          {"render_seconds", image.render_seconds},
          {"load_average", {{"before", image.load_before}, {"after", image.load_after}}},
          {"film_hash", image.film_hash},
          {"bad_samples", image.bad_samples},
          {"errors", errors_json(image.errors)}};
}

Json point_json(const CurvePoint& point, bool peer) {
  Json images = Json::array();
  for (const ImageResult& image : point.images) images.push_back(image_json(image, peer));
  return {{"spp", point.spp > 0 ? Json(point.spp) : Json(nullptr)},
          {"seconds", peer ? Json(point.seconds.total) : seconds_json(point.seconds)},
          {"errors", errors_json(point.errors)},
          {"mse_standard_error", json_number(point.mse_error)},
          {"relmse_standard_error", json_number(point.relative_mse_error)},
          {"mse_split", split_json(point.squared)},
          {"relmse_split", split_json(point.relative)},
          {"images", images}};
}

Json target_json(const Target& target) {
  return {{"metric", target.blocks     ? "block_relmse"
                     : target.relative ? "relmse"
                                       : "mse"},
          {"error", target.error}};
}

/// `seconds` only where it was measured; else the time of the run that bounds it.
Json time_json(const std::optional<TimeToTarget>& time) {
  using Kind = TimeToTarget::Kind;
  Json json = {{"seconds", nullptr}, {"shorter_than", nullptr}, {"longer_than", nullptr}};
  if (time) {
    json[time->kind == Kind::kMeasured  ? "seconds"
         : time->kind == Kind::kShorter ? "shorter_than"
                                        : "longer_than"] = json_number(time->cost);
  }
  return json;
}

Json curve_json(const ErrorCurve& curve, const std::vector<Target>& targets) {
  const CurveName& name = curve.name;
  Json points = Json::array(), to_target = Json::array();
  for (const CurvePoint& point : curve.points) points.push_back(point_json(point, name.peer));
  for (std::size_t i = 0; i < curve.to_target.size(); ++i) {
    Json entry = target_json(targets[i]);
    entry.update(time_json(curve.to_target[i]));
    to_target.push_back(std::move(entry));
  }
  return {{"label", name.label},
          {"peer", name.peer},
          {"integrator", name.integrator},
          {"settings", name.settings},
          {"sampler", name.sampler},
          {"backend", name.backend},
          {"estimates", name.quantity},
          {"estimates_what_the_reference_does", name.same_quantity},
          {"fits",
           {{"mse_over_time", fit_json(curve.mse_over_time)},
            {"relmse_over_time", fit_json(curve.relmse_over_time)},
            {"mse_over_spp", fit_json(curve.mse_over_spp)},
            {"relmse_over_spp", fit_json(curve.relmse_over_spp)}}},
          {"time_to_target", to_target},
          {"efficiency", optional(curve.efficiency)},
          {"no_efficiency_because", curve.efficiency ? Json(nullptr) : Json(curve.no_efficiency)},
          {"points", points}};
}

Json reference_json(const ReferenceSummary& reference) {
  Json halves = Json::array();
  for (const ReferenceHalf& half : reference.halves) {
    halves.push_back({{"what", half.what},
                      {"file", half.file.string()},
                      {"spp", half.spp > 0 ? Json(half.spp) : Json(nullptr)},
                      {"seconds", half.seconds}});
  }
  return {{"images", halves},
          {"estimates", reference.quantity},
          {"z_of_the_halves", reference.z ? json_number(*reference.z) : Json(nullptr)},
          {"noise_mse", optional(reference.noise_mse)},
          {"noise_relmse", optional(reference.noise_relmse)}};
}

Json crops_json(const std::optional<CropSet>& crops) {
  if (!crops) return nullptr;
  Json pictures = Json::array();
  for (const CropPicture& picture : crops->pictures) {
    pictures.push_back({{"label", picture.label},
                        {"spp", picture.spp > 0 ? Json(picture.spp) : Json(nullptr)},
                        {"seconds", picture.seconds},
                        {"crop_relmse", json_number(picture.relmse)},
                        {"crop_mse", json_number(picture.mse)},
                        {"image_relmse", json_number(picture.image_relmse)},
                        {"image_flip", optional(picture.flip)}});
  }
  return {{"x", crops->x},
          {"y", crops->y},
          {"width", crops->width},
          {"height", crops->height},
          {"chosen", crops->why_here},
          {"seconds", crops->seconds},
          {"pictures", pictures}};
}

}  // namespace

Json report_data_json(const ReportData& report) {
  Json scenes = Json::array();
  for (const SceneReport& scene : report.scenes) {
    Json curves = Json::array(), targets = Json::array();
    for (const ErrorCurve& curve : scene.curves) curves.push_back(curve_json(curve, scene.targets));
    for (const Target& target : scene.targets) targets.push_back(target_json(target));
    scenes.push_back({{"name", scene.name},
                      {"file", scene.file.string()},
                      {"width", scene.width},
                      {"height", scene.height},
                      {"reference", reference_json(scene.reference)},
                      {"targets", targets},
                      {"remarks", scene.remarks},
                      {"curves", curves},
                      {"equal_time", crops_json(scene.crops)}});
  }
  return {{"penumbra", report.version},
          {"command_line", report.command_line},
          {"host", report.host},
          {"cores", report.cores},
          {"started", report.started},
          {"finished", report.finished},
          {"load_average", {{"start", report.load_start}, {"end", report.load_end}}},
          {"workers", report.workers},
          {"threads_per_worker", report.threads},
          {"seeds", report.seeds},
          {"repeats", report.repeats},
          {"time", report.total_time ? "total" : "render"},
          {"relmse_epsilon", report.epsilon},
          {"scenes", scenes}};
}

}  // namespace penumbra
