// Formats the comparison as JSON.
#include <nlohmann/json.hpp>

#include "scheduler/files/json_number.h"
#include "scheduler/image/compare.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

Json numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(json_number(value));
  return list;
}

Json flip_json(const FlipResult& flip) {
  Json json = {{"kind", flip.hdr ? "HDR" : "LDR"},
               {"mean", flip.mean},
               {"max", flip.largest},
               {"max_pixel", {flip.x, flip.y}},
               {"pixels_per_degree", flip.pixels_per_degree}};
  if (flip.hdr) {
    json["exposures"] = {
        {"start", flip.exposures.start}, {"stop", flip.exposures.stop}, {"count", flip.exposures.count}};
  }
  return json;
}

Json extreme_json(const ZExtreme& extreme, const std::vector<std::string>& channels) {
  return {{"z", json_number(extreme.z)},
          {"p", json_number(extreme.p)},
          {"pixel", {extreme.x, extreme.y}},
          {"channel", channels[extreme.channel]}};
}

/// null: the variances count as exact, or are missing.
Json samples_json(const std::optional<SampleCounts>& samples) {
  if (!samples) return nullptr;
  return {{"least", samples->least}, {"most", samples->most}, {"mean", samples->mean}};
}

Json z_json(const ZTest& z, const std::vector<std::string>& channels) {
  const ZExtreme& chi_square = z.block_chi_square;
  return {{"consistent", z.consistent},
          {"significance", z.options.significance},
          {"values", z.values},
          {"without_variance_equal", z.exact_equal},
          {"without_variance_different", z.exact_different},
          {"invalid_variances", z.invalid_variances},
          {"unknown_variances", z.unknown_variances},
          {"image_samples", samples_json(z.image_samples)},
          {"reference_samples", samples_json(z.reference_samples)},
          {"visible_image_difference", json_number(z.visible_image_difference)},
          {"visible_block_difference", json_number(z.visible_block_difference)},
          {"share_above_1_96", z.share_above_1_96},
          {"share_above_2_58", z.share_above_2_58},
          {"mean_square", json_number(z.mean_square)},
          {"max_z", extreme_json(z.largest, channels)},
          {"block", z.options.block},
          {"blocks", z.blocks},
          {"block_chi_square",
           {{"chi_square", json_number(chi_square.z)},
            {"dof", chi_square.dof},
            {"p", json_number(chi_square.p)},
            {"pixel", {chi_square.x, chi_square.y}},
            {"channel", channels[chi_square.channel]}}},
          {"block_mean", extreme_json(z.block_mean, channels)},
          {"image_mean", extreme_json(z.image_mean, channels)},
          {"channel_mean_z", numbers(z.channel_mean_z)},
          {"channel_chi_square_p", numbers(z.channel_chi_square_p)}};
}

}  // namespace

nlohmann::ordered_json comparison_json(const Comparison& c) {
  const ImagePair& pair = c.pair;
  const PixelWindow& w = pair.window;
  Json json = {{"width", w.width},
               {"height", w.height},
               {"window", {w.x, w.y, w.width, w.height}},
               {"layer", c.layer},
               {"channels", pair.channels},
               {"references", pair.second_reference.empty() ? 1 : 2},
               {"compared_pixels", pair.compared_pixels},
               {"image_non_finite_pixels", pair.image_non_finite},
               {"reference_non_finite_pixels", pair.reference_non_finite},
               {"epsilon", c.epsilon},
               {"trimmed_share", kTrimmedShare},
               {"trimmed_pixels", c.trimmed_pixels}};
  Json per_channel = Json::object();
  const auto add = [&](const char* name, const ChannelValues& values) {
    json[name] = json_number(values.overall);
    per_channel[name] = numbers(values.channels);
  };
  add("bias", c.bias);
  add("relative_bias", c.relative_bias);
  add("mse", c.mse);
  add("relmse", c.relative_mse);
  add("trimmed_relmse", c.trimmed_relative_mse);
  add("block_relmse", c.block_relative_mse);
  add("mape", c.mape);
  add("smape", c.smape);
  add("psnr", c.psnr);
  add("max", c.largest);
  json["max_pixel"] = {c.largest_at.x, c.largest_at.y};
  json["max_channel"] = pair.channels[c.largest_at.channel];
  json["per_channel"] = per_channel;
  json["image_mean"] = numbers(c.image_mean.channels);
  json["reference_mean"] = numbers(c.reference_mean.channels);
  Json ratios = Json::array();
  for (std::size_t channel = 0; channel < pair.channels.size(); ++channel)
    ratios.push_back(json_number(c.mean_ratio(channel)));
  json["mean_ratio"] = ratios;
  json["flip"] = c.flip ? flip_json(*c.flip) : Json(nullptr);
  if (!c.flip) json["flip_left_out"] = c.flip_left_out;
  json["z_test"] = c.z_test ? z_json(*c.z_test, pair.channels) : Json(nullptr);
  if (!c.z_test) json["z_test_left_out"] = c.z_test_left_out;
  json["verdict"] = verdict_name(c.verdict);
  json["verdict_reason"] = c.verdict_reason;
  return json;
}

}  // namespace penumbra
