#include "scheduler/record/render_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "scenes/settings.h"
#include "scheduler/files/quoting.h"
#include "scheduler/record/version.h"

namespace penumbra {
namespace {

std::string_view bsdf_sampling_name(BsdfSampling sampling) {
  switch (sampling) {
    case BsdfSampling::kBsdf:
      return "bsdf";
    case BsdfSampling::kCosine:
      return "cosine";
    case BsdfSampling::kUniform:
      return "uniform";
  }
  return "?";
}

std::string_view light_choice_name(LightChoice choice) {
  switch (choice) {
    case LightChoice::kAuto:
      return "auto";
    case LightChoice::kPower:
      return "power";
    case LightChoice::kAnalytic:
      return "analytic";
  }
  return "?";
}

bool has_crop(const Film& film) {
  return film.crop_x != 0 || film.crop_y != 0 || film.crop_width != film.width ||
         film.crop_height != film.height;
}

}  // namespace

std::string_view filter_name(FilterKind kind) {
  switch (kind) {
    case FilterKind::kBox:
      return "box";
    case FilterKind::kTent:
      return "tent";
    case FilterKind::kGaussian:
      return "gaussian";
    case FilterKind::kMitchell:
      return "mitchell";
  }
  return "?";
}

std::string_view sampler_name(SamplerKind kind) {
  switch (kind) {
    case SamplerKind::kIndependent:
      return "independent";
    case SamplerKind::kStratified:
      return "stratified";
    case SamplerKind::kHalton:
      return "halton";
    case SamplerKind::kSobol:
      return "sobol";
  }
  return "?";
}

std::string_view integrator_name(const IntegratorSettings& integrator) {
  if (integrator.kind == IntegratorKind::kDirect) return "direct";
  if (integrator.kind == IntegratorKind::kPolygonAnalytic) return "polygon_analytic";
  if (integrator.kind == IntegratorKind::kPolygonArea) return "polygon_area";
  if (integrator.kind == IntegratorKind::kPolygonCv) return "polygon_cv";
  switch (integrator.direct_sampling) {
    case DirectSampling::kBsdfOnly:
      return "path_mats";
    case DirectSampling::kEmitterOnly:
      return "path_ems";
    case DirectSampling::kMis:
      return "path_mis";
  }
  return "?";
}

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

std::string repeat_command(const RenderRecord& record, bool with_crop) {
  std::string command = "penumbra render " + shell_quoted_file(record.scene);
  const auto add = [&](const std::string& option, const std::string& value) {
    command += " " + option + " " + shell_quoted(value);
  };
  for (const std::string& define : record.defines) add("-D", define);
  for (const std::string& setting : record.settings) add("--set", setting);
  if (record.lenient) command += " --lenient";
  add("--integrator", std::string(integrator_name(record.integrator)));
  add("--sampler", std::string(sampler_name(record.sampler.kind)));
  add("--spp", fmt::to_string(record.sampler.spp));
  if (record.stop_after) add("--stop-after", fmt::to_string(*record.stop_after));
  add("--seed", fmt::to_string(record.sampler.seed));
  add("--pass", fmt::to_string(record.samples_per_pass));
  add("--intersector", record.embree ? "embree" : "portable");
  if (!record.isa.empty()) add("--isa", record.isa);
  if (record.backend != Backend::kNative) add("--backend", std::string(backend_name(record.backend)));
  if (!record.feature_layers) command += " --no-features";
  const Film& film = record.film;
  if (with_crop && has_crop(film)) {
    add("--crop", fmt::format("{},{},{},{}", film.crop_x, film.crop_y, film.crop_x + film.crop_width,
                              film.crop_y + film.crop_height));
  }
  return command;
}

std::vector<std::pair<std::string, MetadataValue>> record_entries(const RenderRecord& record) {
  const Film& film = record.film;
  const IntegratorSettings& integrator = record.integrator;
  std::vector<std::pair<std::string, MetadataValue>> entries;
  const auto text = [&](const char* name, std::string_view value) {
    entries.emplace_back(name, std::string(value));
  };
  const auto number = [&](const char* name, float value) {
    entries.emplace_back(name, fmt::format("{}", value));
  };
  text("scene", record.scene);
  text("scene_hash", hash_text(record.scene_hash));
  text("integrator", integrator_name(integrator));
  if (integrator.kind == IntegratorKind::kPath) {
    entries.emplace_back("integrator.max_depth", integrator.max_depth);
    entries.emplace_back("integrator.rr_depth", integrator.rr_depth);
    text("integrator.nee", integrator.next_event == NextEvent::kCv ? "cv" : "sample");
  } else if (integrator.kind == IntegratorKind::kPolygonCv) {
    entries.emplace_back("integrator.vis_samples", integrator.vis_samples);
  } else if (integrator.kind != IntegratorKind::kPolygonAnalytic) {
    entries.emplace_back("integrator.emitter_samples", integrator.emitter_samples);
    entries.emplace_back("integrator.trace_shadows", int(integrator.trace_shadows));
  }
  if (integrator.kind == IntegratorKind::kDirect) {
    entries.emplace_back("integrator.bsdf_samples", integrator.bsdf_samples);
    text("integrator.bsdf_sampling", bsdf_sampling_name(integrator.bsdf_sampling));
  }
  if (has_control_variate(integrator)) {
    text("integrator.alpha", integrator.alpha ? fmt::format("{}", *integrator.alpha) : "auto");
    text("integrator.estimator", integrator.estimator == CvEstimator::kRatio ? "ratio" : "cv");
  }
  text("integrator.light_choice", light_choice_name(integrator.light_choice));
  text("integrator.emitter_sampling", emitter_sampling_name(integrator.emitter_sampling));
  text("integrator.mis", integrator.heuristic == MisHeuristic::kPower ? "power" : "balance");
  entries.emplace_back("integrator.hide_emitters", int(integrator.hide_emitters));
  if (integrator.hide_emitters)
    text("integrator.hidden_emitters",
         integrator.hidden_emitters == HiddenEmitters::kLookedThrough ? "looked_through" : "unlit");
  text("sampler", sampler_name(record.sampler.kind));
  // Unsigned 32-bit values do not fit the format's int.
  text("spp", fmt::to_string(record.sampler.spp));
  if (record.stop_after) text("stop_after", fmt::to_string(*record.stop_after));
  text("seed", fmt::to_string(record.sampler.seed));
  text("samples_per_pass", fmt::to_string(record.samples_per_pass));
  text("film.rfilter", filter_name(film.filter));
  number("film.rfilter_radius", film.filter_radius);
  if (film.filter == FilterKind::kGaussian) number("film.rfilter_stddev", film.filter_stddev);
  if (film.filter == FilterKind::kMitchell) {
    number("film.rfilter_b", film.filter_b);
    number("film.rfilter_c", film.filter_c);
  }
  text("intersector", record.embree ? "embree" : "portable");
  text("backend", std::string(backend_name(record.backend)));
  if (!record.isa.empty()) text("isa", record.isa);
  if (!record.defines.empty()) text("defines", fmt::format("{}", fmt::join(record.defines, "\n")));
  if (!record.settings.empty()) text("set", fmt::format("{}", fmt::join(record.settings, "\n")));
  return entries;
}

RenderRecord record_of_rendered(RenderRecord record, const RenderedSamples& rendered) {
  // Where there are gaps, counts do not tell which samples there are.
  if (!rendered.has_gaps && rendered.most > 0 && rendered.most < record.sampler.spp)
    record.stop_after = std::uint32_t(rendered.most);
  return record;
}

std::vector<std::pair<std::string, MetadataValue>> record_metadata(const RenderRecord& record,
                                                                   std::uint64_t film_hash,
                                                                   const RenderedSamples& rendered) {
  RenderRecord portable = record;
  portable.scene = std::filesystem::path(record.scene).filename().string();
  std::vector<std::pair<std::string, MetadataValue>> metadata;
  metadata.emplace_back("penumbra:version", std::string(kVersion));
  metadata.emplace_back(rendered.repeatable() ? "penumbra:command" : "penumbra:nearest_command",
                        repeat_command(portable, true));
  for (const auto& [name, value] : record_entries(portable)) metadata.emplace_back("penumbra:" + name, value);
  metadata.emplace_back("penumbra:film_hash", hash_text(film_hash));
  if (!rendered.complete) metadata.emplace_back("penumbra:incomplete", 1);
  if (!rendered.repeatable()) {
    metadata.emplace_back("penumbra:samples_per_pixel",
                          fmt::format("{} to {}", rendered.least, rendered.most));
  }
  return metadata;
}

}  // namespace penumbra
