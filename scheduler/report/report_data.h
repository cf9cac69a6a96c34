// All data of a report: computed once, then written as HTML, CSV and JSON.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/image/metrics/error_metrics.h"
#include "scheduler/report/method.h"
#include "scheduler/report/seed_statistics.h"
#include "scheduler/report/slope_fit.h"
#include "scheduler/report/time_to_target.h"

namespace penumbra {

/// Wall-clock times of a render by phase, in seconds.
struct PhaseSeconds {
  double build = 0;  ///< from scene file to device scene
  /// Until the first worker is ready: starting workers, sending the scene, compiling kernels.
  double transfer = 0;
  double render = 0;  ///< from then until the last result is merged
  double total = 0;   ///< build and the whole render job, including its end
};

/// The errors of one image against the reference: the overall values of the metrics.
struct ImageErrors {
  double mse = 0, relative_mse = 0, trimmed_relative_mse = 0, mape = 0, smape = 0, bias = 0, largest = 0;
  double block_relative_mse = 0;
  std::uint64_t non_finite = 0;  ///< pixels that were left out
};

struct ImageResult {
  std::filesystem::path file;
  std::uint32_t seed = 0;
  PhaseSeconds seconds;                    ///< medians over the repeats
  std::vector<double> render_seconds;      ///< of each repeat
  double load_before = 0, load_after = 0;  ///< load average of the machine over a minute
  std::string film_hash;
  std::uint64_t bad_samples = 0;  ///< number of NaN or infinite samples
  ImageErrors errors;
};

/// One budget of a curve.
struct CurvePoint {
  std::uint32_t spp = 0;  ///< 0: unknown
  std::vector<ImageResult> images;
  PhaseSeconds seconds;  ///< medians over the images
  ImageErrors errors;    ///< means over the images; for `largest` and `non_finite` the maximum
  /// Standard errors over the images of the means in `errors`; NaN for a single image.
  double mse_error = NAN, relative_mse_error = NAN;
  ErrorSplit squared, relative;
};

struct CurveName {
  std::string label;
  bool peer = false;  ///< images of another renderer, of which only the times are known
  std::string integrator;
  std::vector<std::string> settings;
  std::string sampler, backend;
  std::string quantity;       ///< description of the limit image
  bool same_quantity = true;  ///< the same limit image as the reference
};

struct ErrorCurve {
  CurveName name;
  std::vector<CurvePoint> points;  ///< by budget, or by time
  Slope mse_over_time, relmse_over_time, mse_over_spp, relmse_over_spp;
  std::vector<std::optional<TimeToTarget>> to_target;  ///< for each target of the scene
  std::optional<double> efficiency;                    ///< geometric mean of 1 / (MSE T)
  std::string no_efficiency;                           ///< why there is none
};

/// One half of a reference, or all of it.
struct ReferenceHalf {
  std::string what;  ///< integrator, sampler and seed, or the file
  std::filesystem::path file;
  std::uint32_t spp = 0;  ///< 0: unknown
  double seconds = 0;
};

struct ReferenceSummary {
  std::vector<ReferenceHalf> halves;  ///< one or two
  std::string quantity;               ///< description of the limit image; empty: unknown
  /// The z-score of the mean of A - B, see halves_z; only with two halves.
  std::optional<double> z;
  /// The amounts of MSE and relMSE due to the reference's own noise, from its variance; only for a single
  /// reference.
  std::optional<double> noise_mse, noise_relmse;
};

/// The crop of one method at the common time.
struct CropPicture {
  std::string label;
  std::uint32_t spp = 0;
  double seconds = 0;
  double relmse = 0, mse = 0;  ///< of the crop
  double image_relmse = 0;     ///< of the whole image
  std::optional<double> flip;  ///< mean FLIP of the whole image
  std::vector<std::uint8_t> png, heat_png;
  std::vector<std::uint8_t> whole_png;  ///< the whole image
};

struct CropSet {
  int x = 0, y = 0, width = 0, height = 0;  ///< in film pixels
  std::string why_here;
  double seconds = 0;  ///< common time of all methods, as near as there are images
  /// The relative errors of the darkest and the brightest colour; the scale between is logarithmic.
  double heat_low = 1e-4, heat_high = 1;
  double exposure = 0;
  std::vector<std::uint8_t> reference_png, overview_png;
  int overview_width = 0, overview_height = 0;
  int film_x = 0, film_y = 0;  ///< corner of the overview
  std::vector<CropPicture> pictures;
};

/// A plot: SVG text and PNG bytes.
struct Plot {
  std::string name, title;
  std::string svg;
  std::vector<std::uint8_t> png;
};

struct SceneReport {
  std::string name;  ///< short and unique
  std::filesystem::path file;
  int width = 0, height = 0;
  ReferenceSummary reference;
  std::vector<Target> targets;
  bool target_chosen = false;  ///< chosen by the report: the smallest error that every curve reaches
  std::vector<ErrorCurve> curves;
  std::optional<CropSet> crops;
  std::vector<Plot> plots;
  std::vector<std::string> remarks;
};

struct ReportData {
  std::string version, host, started, finished;
  std::vector<std::string> command_line;
  unsigned cores = 0;
  int workers = 1, threads = 0, repeats = 1, seeds = 0;
  std::array<double, 3> load_start{}, load_end{};  ///< load averages over 1, 5 and 15 minutes
  double epsilon = kRelativeEpsilon;
  bool total_time = false;  ///< T is PhaseSeconds::total; false: render
  std::vector<SceneReport> scenes;

  [[nodiscard]] double seconds(const PhaseSeconds& phases) const {
    return total_time ? phases.total : phases.render;
  }
};

}  // namespace penumbra
