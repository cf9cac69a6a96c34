#include "scheduler/report/report_assembly.h"

#include <fmt/format.h>

#include "kernels/host/text.h"
#include "scheduler/image/metrics/error_map.h"
#include "scheduler/report/crops.h"
#include "scheduler/report/curve_builder.h"

namespace penumbra {
namespace {

Expected<Image> load(const std::filesystem::path& file) {
  auto image = read_image(file);
  if (!image) return fail(fmt::format("{}; remove it and run the report again", image.error().message));
  return image;
}

struct LoadedReference {
  Reference images;
  ReferenceSummary summary;
};

Expected<std::optional<LoadedReference>> load_reference(const ScenePlan& plan, const CellStore& store,
                                                        double epsilon) {
  LoadedReference loaded;
  loaded.summary.quantity = plan.reference_quantity;
  for (const CellPlan& cell : plan.reference_cells) {
    const auto result = store.find(cell.id);
    if (!result) return std::nullopt;
    const std::string what = cell.what.substr(cell.what.find("reference "));
    loaded.summary.halves.push_back({what, result->file, *cell.options.scene.spp, result->seconds.render});
  }
  for (const auto& file : plan.reference_files) loaded.summary.halves.push_back({file.string(), file, 0, 0});
  for (std::size_t i = 0; i < loaded.summary.halves.size(); ++i) {
    auto image = load(loaded.summary.halves[i].file);
    if (!image) return std::unexpected(image.error());
    if (i == 0) {
      loaded.images.first = std::move(*image);
    } else {
      loaded.images.second = std::move(*image);
    }
  }
  if (loaded.images.second) {
    loaded.summary.z = halves_z(loaded.images.first, *loaded.images.second);
  } else if (const auto noise = reference_noise(loaded.images.first, epsilon)) {
    loaded.summary.noise_mse = noise->mse;
    loaded.summary.noise_relmse = noise->relmse;
  }
  return loaded;
}

/// Sums the relative squared error of each pixel over all images of the report.
class ErrorSum {
 public:
  ErrorSum(const PixelWindow& window, double epsilon)
      : sum_(std::size_t(window.width) * std::size_t(window.height), 0.0), epsilon_(epsilon) {}
  void add(const ImagePair& pair) {
    const ErrorMap map = relative_error_map(pair, epsilon_);
    const double mean = relative_mse(pair, epsilon_).overall;  // so that all images have equal weight
    for (std::size_t i = 0; i < sum_.size(); ++i)
      if (map.values[i] > 0 && mean > 0) sum_[i] += map.values[i] / mean;
  }
  [[nodiscard]] const std::vector<double>& values() const { return sum_; }

 private:
  std::vector<double> sum_;
  double epsilon_;
};

Expected<ErrorCurve> rendered_curve(const CurvePlan& plan, const CellStore& store, const Reference& reference,
                                    double epsilon, ErrorSum& errors, std::size_t& missing) {
  ErrorCurve curve;
  curve.name = plan.name;
  for (std::size_t i = 0; i < plan.cells.size(); ++i) {
    std::vector<ImageResult> images;
    for (const CellPlan& cell : plan.cells[i]) {
      auto result = store.find(cell.id);
      if (result) {
        images.push_back(std::move(*result));
      } else {
        ++missing;
      }
    }
    if (images.empty()) continue;
    auto point = measure_point(plan.budgets[i], std::move(images), reference, epsilon,
                               [&](const ImagePair& pair) { errors.add(pair); });
    if (!point) return std::unexpected(point.error());
    curve.points.push_back(std::move(*point));
  }
  return curve;
}

Expected<ErrorCurve> peer_curve(const Peer& peer, const Reference& reference, double epsilon,
                                ErrorSum& errors) {
  ErrorCurve curve;
  curve.name.label = peer.name;
  curve.name.peer = true;
  for (const PeerImage& image : peer.images) {
    ImageResult result;
    result.file = image.file;
    result.seconds = {0, 0, image.seconds, image.seconds};
    auto point =
        measure_point(0, {result}, reference, epsilon, [&](const ImagePair& pair) { errors.add(pair); });
    if (!point) return std::unexpected(point.error());
    curve.points.push_back(std::move(*point));
  }
  return curve;
}

/// Caveats for the reader of the report.
void add_remarks(SceneReport& scene, std::size_t missing) {
  if (missing > 0)
    scene.remarks.push_back(
        fmt::format("missing: {}; the curves are incomplete.", counted(missing, "image")));
  for (const ErrorCurve& curve : scene.curves) {
    std::uint64_t bad = 0, hidden = 0;
    for (const CurvePoint& point : curve.points) {
      for (const ImageResult& image : point.images) bad += image.bad_samples;
      hidden += point.errors.relative_mse > 0 ? 0 : 1;
    }
    if (!curve.name.same_quantity) {
      scene.remarks.push_back(
          fmt::format("{} estimates {}, the reference {}: the difference counts as error.", curve.name.label,
                      curve.name.quantity, scene.reference.quantity));
    }
    if (bad > 0)
      scene.remarks.push_back(
          fmt::format("{}: NaN or infinite: {}.", curve.name.label, counted(bad, "sample")));
    if (hidden > 0) {
      scene.remarks.push_back(
          fmt::format("{}: at {} the error is not above the reference's noise; they are not in the plots "
                      "and fits. A longer reference (--reference-spp) would show them.",
                      curve.name.label, counted(hidden, "budget")));
    }
  }
}

}  // namespace

Expected<std::optional<SceneReport>> assemble_scene(const ReportOptions& options, const ScenePlan& plan,
                                                    const CellStore& store, const ReportData& report,
                                                    std::size_t& missing) {
  auto reference = load_reference(plan, store, options.epsilon);
  if (!reference) return std::unexpected(reference.error());
  if (!*reference) {
    ++missing;
    return std::nullopt;
  }
  const Reference& truth = (*reference)->images;
  SceneReport scene;
  scene.name = plan.name;
  scene.file = plan.file;
  scene.width = plan.window.width;
  scene.height = plan.window.height;
  scene.reference = (*reference)->summary;
  ErrorSum errors(truth.window(), options.epsilon);
  std::size_t missing_here = 0;
  for (const CurvePlan& curve : plan.curves) {
    auto built = rendered_curve(curve, store, truth, options.epsilon, errors, missing_here);
    if (!built) return std::unexpected(built.error());
    scene.curves.push_back(std::move(*built));
  }
  for (const Peer& peer : plan.peers) {
    auto built = peer_curve(peer, truth, options.epsilon, errors);
    if (!built) return std::unexpected(built.error());
    scene.curves.push_back(std::move(*built));
  }
  scene.targets = options.targets;
  if (scene.targets.empty()) {
    if (const auto target = common_target(report, scene.curves)) scene.targets = {*target};
    scene.target_chosen = true;
  }
  for (ErrorCurve& curve : scene.curves) finish_curve(report, scene.targets, curve);
  add_remarks(scene, missing_here);
  missing += missing_here;
  auto crops = make_crops(report, scene, truth, errors.values(),
                          {options.crop, options.crop_seconds, options.exposure});
  if (!crops) return std::unexpected(crops.error());
  scene.crops = std::move(*crops);
  return scene;
}

}  // namespace penumbra
