#include "scheduler/stress/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "kernels/host/process.h"
#include "scenes/device/device_scene_builder.h"

namespace penumbra::stress {
namespace {

using Clock = std::chrono::steady_clock;

/// Runs all kernel cases on each backend, in one launch per backend.
void run_kernel_cases(std::span<const Case> cases, std::span<Backend> backends,
                      std::vector<CaseResult>& results) {
  std::vector<std::size_t> which;
  std::vector<const KernelMeasurement*> measurements;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (const auto* m = std::get_if<KernelMeasurement>(&cases[i].measurement)) {
      which.push_back(i);
      measurements.push_back(m);
    }
  }
  if (which.empty()) return;
  for (Backend& backend : backends) {
    const auto start = Clock::now();
    Expected<std::vector<Numbers>> outputs = fail(backend.broken);
    if (backend.kernels) outputs = backend.kernels->run(measurements);
    const double seconds = seconds_since(start) / double(which.size());
    for (std::size_t k = 0; k < which.size(); ++k) {
      Outcome outcome;
      outcome.backend = backend.name;
      outcome.seconds = seconds;
      if (!backend.skipped.empty()) {
        outcome.verdict = Verdict::kSkipped;
        outcome.note = backend.skipped;
      } else if (!outputs) {
        outcome.note = outputs.error().message;
      } else {
        const Numbers& all = (*outputs)[k];
        outcome.value = measurements[k]->value ? measurements[k]->value(all) : Numbers{all[0]};
      }
      results[which[k]].outcomes.push_back(std::move(outcome));
    }
  }
}

/// Renders all samples, merging passes in order.
Expected<FilmAccumulator> render(const DeviceScene& scene, const DeviceOptions& options) {
  Expected<std::unique_ptr<Device>> device = make_device(scene, options);
  if (!device) return std::unexpected(device.error());
  const int width = scene.header.film.width, height = scene.header.film.height;
  const IntegratorParameters& integrator = scene.header.integrator;
  const std::uint32_t spp = scene.header.sampler.spp;
  const std::uint32_t most = integrator.photons == PHOTONS_PROGRESSIVE
                                 ? std::uint32_t(integrator.samples_per_map)
                                 : kMaxSamplesPerUnit;
  FilmAccumulator film(0, 0, width, height, FilmLayers(scene.header.features));
  for (std::uint32_t first = 0; first < spp;) {
    RenderUnit unit{.x = 0, .y = 0, .width = width, .height = height, .first_sample = first};
    unit.sample_count = std::min(most, spp - first);
    Expected<SampleBuffer> result = (*device)->render(unit);
    if (!result) return std::unexpected(result.error());
    film.add(0, 0, *result);
    first += unit.sample_count;
  }
  return film;
}

std::uint64_t non_finite(const FilmAccumulator& film) { return non_finite_count(film.flagged()); }

Outcome run_render(const RenderMeasurement& measurement, const Backend& backend) {
  Outcome outcome;
  outcome.backend = backend.name;
  outcome.note = backend.broken;
  if (!backend.skipped.empty()) {
    outcome.verdict = Verdict::kSkipped;
    outcome.note = backend.skipped;
  }
  if (!outcome.note.empty()) return outcome;
  const Expected<DeviceScene> scene =
      build_device_scene(measurement.scene(), {.intersector = IntersectorChoice::kPortable});
  if (!scene) {
    outcome.note = scene.error().message;
    return outcome;
  }
  const Expected<FilmAccumulator> film = render(*scene, backend.render);
  if (!film) {
    outcome.note = film.error().message;
    return outcome;
  }
  outcome.value = measurement.value(*film);
  if (non_finite(*film) != measurement.non_finite)
    outcome.note = fmt::format("{} samples are NaN or infinite, where {} are expected", non_finite(*film),
                               measurement.non_finite);
  return outcome;
}

void run_other(const Case& c, std::span<Backend> backends, CaseResult& result) {
  if (const auto* m = std::get_if<HostMeasurement>(&c.measurement)) {
    const auto start = Clock::now();
    result.outcomes.emplace_back();
    result.outcomes.back().backend = "host";
    result.outcomes.back().value = m->value();
    result.outcomes.back().seconds = seconds_since(start);
  }
  if (const auto* m = std::get_if<RenderMeasurement>(&c.measurement)) {
    for (const Backend& backend : backends) {
      if (!backend.renders || (backend.render.block_of_one && !m->one_lane)) continue;
      const auto start = Clock::now();
      result.outcomes.push_back(run_render(*m, backend));
      result.outcomes.back().seconds = seconds_since(start);
    }
  }
}

}  // namespace

std::vector<CaseResult> run_cases(std::span<const Case> cases, std::span<Backend> backends,
                                  const std::function<void(const Case&)>& progress) {
  std::vector<CaseResult> results(cases.size());
  run_kernel_cases(cases, backends, results);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    CaseResult& result = results[i];
    result.tested = &c;
    progress(c);
    run_other(c, backends, result);
    const Quads truth = c.truth.value();
    for (const Quad& t : truth) result.truth.push_back(double(t));
    Allowed allowed = c.allowed;
    if (allowed.computed) allowed.absolute += allowed.computed();
    result.allowed = allowed_error(truth, allowed);
    for (Outcome& outcome : result.outcomes) {
      if (outcome.verdict != Verdict::kSkipped) judge(truth, allowed, outcome);
    }
    result.verdict = summarize(result.outcomes);
    result.same_bits = have_same_bits(result.outcomes);
  }
  return results;
}

}  // namespace penumbra::stress
