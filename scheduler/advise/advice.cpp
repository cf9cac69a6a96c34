#include "scheduler/advise/advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>
#include <numeric>

#include "kernels/host/process.h"
#include "scenes/device/device_scene_builder.h"
#include "scheduler/advise/pilot_error.h"
#include "scheduler/advise/work.h"

namespace penumbra {
namespace {

// The best number of photons is found from a pilot with at most so many. It is a lower bound where points of
// low discrepancy hide the photons' share of the variance; fewer than kFewestPhotons leave rare bright
// pixels.
constexpr int kPilotPhotons = 50'000;
constexpr int kFewestPhotons = 10'000, kMostPhotonPaths = 1'000'000;
constexpr int kMostPolygons = 32;
// What advice may cost: this share of a render of the scene's film, or this much work, some 2 s of a core.
constexpr double kMostOfRender = 0.03, kLeastBudget = 8e6;
constexpr int kFewestTiles = 16;
// What the first candidate and photons take: maps, and so many times the paths of the first one. Only where
// these two exceed the budget, there are fewer tiles: few tiles miss caustics.
constexpr double kMapsWork = 2e6, kBothOverFirst = 2.2;
// Work of building a device scene's tables, for each word: 5 to 11 ns, where a unit of work takes 250 ns.
constexpr double kWordWork = 0.03;
// What replaces something else must be better by this factor, and by so many standard errors. Photons by
// fewer: rare bright samples of paths, which make the standard error large, are what photons are for, and a
// pilot that meets few of them is more often too sure of paths than too doubtful.
constexpr double kLeastGain = 1.05, kStandardErrors = 2, kStandardErrorsOfPhotons = 1;

/// A candidate that was rendered.
struct Measured {
  Technique candidate;
  Pilot pilot;
  std::vector<TileError> tiles = {};
  double vertex_work = 0;  ///< per sample
  double photon_work = 0;  ///< per photon path
  double alpha = 1;        ///< of shrinking radii
  int photons = 0;         ///< paths of a pilot's map; 0: none
  int chosen_photons = 0;  ///< of a render's map
};

/// The variance of kAdvisedSamples maps' mean over that of the first. The variance of a map falls with its
/// radius squared, and radii with k^((alpha - 1) / 2): the mean of N has N^-alpha / (2 - alpha) (Knaus and
/// Zwicker 2011).
double variance_of_maps(double alpha) { return std::pow(double(kAdvisedSamples), -alpha) / (2 - alpha); }

/// A tile's part in the error of a render.
double tile_error(const Measured& m, std::size_t t) {
  const TileError& error = m.tiles[t];
  double sum = (error.paths + error.missed) / kAdvisedSamples;
  if (m.photons > 0) sum += error.photons * m.photons / m.chosen_photons * variance_of_maps(m.alpha);
  return sum;
}

double error_without(const Measured& m, std::optional<std::size_t> left_out = {}) {
  double sum = 0;
  for (std::size_t t = 0; t < m.tiles.size(); ++t)
    if (t != left_out) sum += tile_error(m, t);
  return std::max(sum, 1e-30);
}

/// Whole numbers of one digit, 1, 2 or 5 times a power of ten.
int round_photons(double photons) {
  const double power = std::pow(10, std::floor(std::log10(std::max(photons, 1.0))));
  for (const double digit : {1.0, 2.0, 5.0})
    if (photons <= digit * power * 1.5) return int(digit * power);
  return int(10 * power);
}

class Adviser {
 public:
  Adviser(SceneDescription& scene, const AdviceOptions& options) : scene_(scene), options_(options) {
    pixels_ = double(scene.film.crop_width) * scene.film.crop_height;
  }

  Expected<Advice> run() {
    const Technique first = first_candidate(scene_);
    if (auto done = measure(first); !done) return std::unexpected(done.error());
    if (auto done = try_photons(first); !done) return std::unexpected(done.error());
    const std::size_t technique = better(0, 1), variations_begin = measured_.size();
    for (const Technique& changed : variations(scene_, measured_[technique].candidate))
      if (auto done = try_variation(changed); !done) return std::unexpected(done.error());
    if (is_black_) return fail("nothing can be compared: the pilots see no light");
    if (measured_.size() < 2)
      return fail("nothing is left to choose: the options and the scene fix everything");
    return advice(better(technique, variations_begin));
  }

 private:
  /// Renders the candidate's pilot.
  Expected<void> measure(const Technique& candidate) {
    auto settings = settings_with(scene_, candidate.settings);
    if (!settings) return std::unexpected(settings.error());
    const bool has_maps = settings->integrator.is<ProgressivePhotonIntegrator>();
    Measured m{.candidate = candidate, .pilot = {}};
    if (auto* photons = std::get_if<ProgressivePhotonIntegrator>(&settings->integrator.method)) {
      m.photons = photons->photon_count = std::min(photons->photon_count, kPilotPhotons);
      m.alpha = photons->alpha.value_or(2.0f / 3.0f);
    }
    const WithSettings changed(scene_, *settings);
    DeviceSceneOptions device_options{.intersector = options_.intersector,
                                      .feature_layers = false,
                                      .hierarchy_cache = options_.hierarchy_cache,
                                      .earlier = first_scene_.get()};
    auto device = build_device_scene(scene_, device_options);
    if (!device) return std::unexpected(device.error());
    device->header.sampler.seed = 0;
    if (first_scene_ != nullptr) spent_ += build_work();
    // The same words and header are the same render.
    if (first_scene_ != nullptr && device->words == first_scene_->words &&
        std::memcmp(&device->header, &first_scene_->header, sizeof device->header) == 0)
      return {};
    // Every vertex evaluates the closed form of every light: the pilot would take longer than all others.
    if (first_scene_ != nullptr && device->header.integrator.estimator != ESTIMATOR_SAMPLES &&
        device->header.tables.polygons.count > kMostPolygons) {
      not_compared_.push_back(candidate);
      not_compared_.back().not_because = fmt::format("more than {} polygon lights", kMostPolygons);
      return {};
    }
    if (has_maps) device->header.integrator.samples_per_map = kPilotSamples;
    const WorkWeights weights = work_weights(device->header);
    if (first_scene_ == nullptr)
      if (auto done = choose_tiles(*device, weights); !done) return std::unexpected(done.error());
    auto pilot = render_pilot(*device, tiles_, options_.threads);
    if (!pilot) return std::unexpected(pilot.error());
    spent_ += path_work(pilot->traced, weights) + photon_work(pilot->traced, weights);
    m.vertex_work = path_work(pilot->traced, weights) / double(pilot->samples);
    if (m.photons > 0)
      m.photon_work = photon_work(pilot->traced, weights) / (double(m.photons) * kPilotBatches);
    if (first_scene_ == nullptr) first_scene_ = std::make_unique<DeviceScene>(std::move(*device));
    m.pilot = std::move(*pilot);
    measured_.push_back(std::move(m));
    judge();
    return {};
  }

  /// Sets the budget by a few tiles of the first candidate, and takes so many tiles that photons meet it.
  Expected<void> choose_tiles(const DeviceScene& first, const WorkWeights& weights) {
    const std::vector<PilotTile> few = pilot_tiles(scene_.film, kFewestTiles);
    const auto probe = render_pilot(first, few, options_.threads);
    if (!probe) return std::unexpected(probe.error());
    spent_ = path_work(probe->traced, weights);
    const double of_render = kMostOfRender * kAdvisedSamples * pixels_ * spent_ / double(probe->samples);
    budget_ = std::max(kLeastBudget, of_render);
    const double built = kWordWork * double(first.words.size());
    const double left = budget_ - spent_ - built - kMapsWork;
    const double tiles = double(few.size()) * left / std::max(kBothOverFirst * spent_, 1.0);
    tiles_ = pilot_tiles(scene_.film, int(std::clamp(tiles, double(kFewestTiles), double(kPilotTiles))));
    return {};
  }

  [[nodiscard]] double build_work() const { return kWordWork * double(first_scene_->words.size()); }

  /// Whether another candidate, which takes as much as the first, would exceed the budget.
  [[nodiscard]] bool is_too_much() const {
    const Measured& first = measured_.front();
    return spent_ + build_work() + first.vertex_work * double(first.pilot.samples) > budget_;
  }

  Expected<void> try_photons(const Technique& first) {
    Technique photons = photon_candidate(scene_, first, options_.takes_photons);
    if (is_fixed(photons)) photons.not_because = "other options fix it";
    if (photons.not_because.empty()) {
      const auto done = measure(photons);
      if (done) return {};
      photons.not_because = done.error().message;
    }
    not_compared_.push_back(std::move(photons));
    return {};
  }

  Expected<void> try_variation(const Technique& changed) {
    if (is_fixed(changed)) return {};
    if (changed.not_because.empty() && !is_too_much()) return measure(changed);
    not_compared_.push_back(changed);
    std::string& reason = not_compared_.back().not_because;
    if (reason.empty()) reason = "its pilot would cost too much";
    return {};
  }

  /// Whether the candidate changes what the user has chosen.
  [[nodiscard]] bool is_fixed(const Technique& candidate) const {
    return std::ranges::any_of(candidate.settings, [&](const auto& setting) {
      return setting.first != "integrator.type" && std::ranges::count(options_.fixed, setting.first) > 0;
    });
  }

  /// Computes all errors, by the mean of all pilots.
  void judge() {
    std::vector<const Pilot*> pilots;
    for (const Measured& m : measured_) pilots.push_back(&m.pilot);
    const std::vector<double> reference = pilot_reference(pilots, tiles_);
    is_black_ = std::ranges::all_of(reference, [](double value) { return value == 0; });
    const auto with_photons =
        std::ranges::find_if(measured_, [](const Measured& m) { return m.photons > 0; });
    for (Measured& m : measured_) {
      m.tiles = tile_errors(m.pilot, m.photons > 0, tiles_, reference);
      if (with_photons == measured_.end()) continue;
      if (m.photons == 0)
        add_missed(m.pilot, with_photons->pilot, tiles_, reference, m.tiles);
      else
        add_missed(m.pilot, measured_.front().pilot, tiles_, reference, m.tiles);
    }
    for (Measured& m : measured_)
      if (m.photons > 0) choose_photons(m);
  }

  /// The number of photons for which error times work is least: (A + C / n) (w + u n), with the variance A of
  /// paths and C of a photon, and the work w of a sample and u of a photon.
  void choose_photons(Measured& m) const {
    double paths = 0, photons = 0;
    for (const TileError& error : m.tiles) {
      paths += (error.paths + error.missed) / kAdvisedSamples;
      photons += error.photons * m.photons * variance_of_maps(m.alpha);
    }
    const double per_photon = m.photon_work / pixels_;
    const double ideal =
        std::sqrt(std::max(photons, 0.0) * m.vertex_work / std::max(paths * per_photon, 1e-30));
    m.chosen_photons = round_photons(std::clamp(ideal, double(kFewestPhotons), double(kMostPhotonPaths)));
  }

  [[nodiscard]] double work(const Measured& m) const {
    return m.vertex_work + m.photon_work * m.chosen_photons / pixels_;
  }

  /// log(error * work) of one over that of another, with its standard error by leaving out one tile after
  /// the other.
  struct Comparison {
    double log_ratio = 0, standard_error = 0;
  };
  [[nodiscard]] Comparison compare(const Measured& a, const Measured& b) const {
    const double of_work = std::log(work(a) / work(b));
    Comparison found{std::log(error_without(a) / error_without(b)) + of_work, 0};
    std::vector<double> left_out;
    for (std::size_t t = 0; t < tiles_.size(); ++t)
      left_out.push_back(std::log(error_without(a, t) / error_without(b, t)));
    const double n = double(left_out.size());
    const double mean = std::accumulate(left_out.begin(), left_out.end(), 0.0) / n;
    double squares = 0;
    for (const double value : left_out) squares += (value - mean) * (value - mean);
    found.standard_error = std::sqrt(squares * (n - 1) / n);
    return found;
  }

  /// Of the candidates from `begin` on, the best of those that are surely better than `than`; else that.
  [[nodiscard]] std::size_t better(std::size_t than, std::size_t begin) const {
    std::size_t chosen = than;
    for (std::size_t i = begin; i < measured_.size(); ++i) {
      const Comparison found = compare(measured_[i], measured_[than]);
      const bool adds_photons = measured_[i].photons > 0 && measured_[than].photons == 0;
      const double errors = adds_photons ? kStandardErrorsOfPhotons : kStandardErrors;
      const bool is_better = found.log_ratio < -std::max(std::log(kLeastGain), errors * found.standard_error);
      if (is_better && compare(measured_[i], measured_[chosen]).log_ratio < 0) chosen = i;
    }
    return chosen;
  }

  Advice advice(std::size_t chosen_index) const {
    Advice advice;
    advice.chosen = chosen_index;
    advice.work = spent_;
    advice.most_work = budget_;
    const Measured& chosen = measured_[advice.chosen];
    const double pixels =
        std::accumulate(tiles_.begin(), tiles_.end(), 0.0,
                        [](double sum, const auto& tile) { return sum + double(tile.width) * tile.height; });
    for (const Measured& m : measured_) {
      const Comparison to_chosen = compare(m, chosen);
      AdviceRow row{m.candidate, error_without(m) / pixels, work(m), std::exp(to_chosen.log_ratio),
                    to_chosen.standard_error};
      if (m.photons > 0)
        row.candidate.settings.emplace_back("integrator.photon_count", fmt::to_string(m.chosen_photons));
      advice.rows.push_back(std::move(row));
    }
    for (const Technique& candidate : not_compared_) advice.rows.push_back({.candidate = candidate});
    return advice;
  }

  SceneDescription& scene_;
  const AdviceOptions& options_;
  std::vector<PilotTile> tiles_;
  double pixels_ = 0;
  double spent_ = 0, budget_ = 0;  ///< in units of work; the first device scene is not counted
  std::unique_ptr<DeviceScene> first_scene_;
  std::vector<Measured> measured_;
  std::vector<Technique> not_compared_;
  bool is_black_ = false;
};

}  // namespace

Expected<Advice> advise(SceneDescription& scene, const AdviceOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  auto advice = Adviser(scene, options).run();
  if (advice) advice->seconds = seconds_since(begin);
  return advice;
}

}  // namespace penumbra
