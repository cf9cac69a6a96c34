#include "scheduler/cli/compare_shot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "scheduler/denoise/flicker.h"
#include "scheduler/files/json_number.h"
#include "scheduler/report/gnuplot.h"

namespace penumbra {
namespace {

struct Column {
  const char* name;
  std::optional<double> FrameError::*value;
};
constexpr Column kColumns[] = {
    {"relmse", &FrameError::relative_mse}, {"flip", &FrameError::flip}, {"flicker", &FrameError::flicker}};

std::optional<double> mean_of(const std::vector<FrameError>& frames,
                              std::optional<double> FrameError::*value) {
  double sum = 0;
  int count = 0;
  for (const FrameError& frame : frames)
    if (frame.*value) {
      sum += *(frame.*value);
      ++count;
    }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

std::string number_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.4g}", *value) : "-";
}

}  // namespace

std::vector<FrameError> compare_shots(
    const FrameFiles& images, const FrameFiles& reference, const CompareOptions& options,
    const std::function<void(const std::string& image, const Comparison&)>& check) {
  std::set<int> numbers;
  for (const FrameFiles* files : {&images, &reference})
    for (const int frame : files->find()) numbers.insert(frame);
  std::vector<FrameError> errors;
  std::optional<std::pair<Image, Image>> before;  // the frame before, and its reference
  for (const int number : numbers) {
    FrameError error;
    error.frame = number;
    auto image = read_image(images.file(number)), truth = read_image(reference.file(number));
    const auto compared = !image   ? std::unexpected(image.error())
                          : !truth ? std::unexpected(truth.error())
                                   : compare_images({.image = *image, .reference = *truth}, options);
    if (!compared) {
      error.error = compared.error().message;
      before.reset();
      errors.push_back(std::move(error));
      continue;
    }
    check(images.file(number).string(), *compared);
    error.relative_mse = compared->relative_mse.overall;
    if (compared->flip) error.flip = compared->flip->mean;
    if (before && errors.back().frame == number - 1) {
      const auto change = flicker({before->first, *image}, {before->second, *truth}, options.epsilon);
      if (change)
        error.flicker = *change;
      else
        error.no_flicker = change.error().message;
    }
    before.emplace(std::move(*image), std::move(*truth));
    errors.push_back(std::move(error));
  }
  return errors;
}

std::string shot_text(const std::vector<FrameError>& frames) {
  std::string text = "frame";
  for (const Column& column : kColumns) text += fmt::format(" {:>11}", column.name);
  text += '\n';
  for (const FrameError& frame : frames) {
    text += fmt::format("{:5}", frame.frame);
    if (!frame.error.empty()) {
      text += " " + frame.error + "\n";
      continue;
    }
    for (const Column& column : kColumns) text += fmt::format(" {:>11}", number_text(frame.*column.value));
    text += '\n';
  }
  text += " mean";
  for (const Column& column : kColumns)
    text += fmt::format(" {:>11}", number_text(mean_of(frames, column.value)));
  text += '\n';
  const auto left_out =
      std::ranges::find_if(frames, [](const FrameError& frame) { return !frame.no_flicker.empty(); });
  return left_out == frames.end()
             ? text
             : text + fmt::format("no flicker from frame {} to {}: {}\n", left_out->frame - 1,
                                  left_out->frame, left_out->no_flicker);
}

nlohmann::ordered_json shot_json(const std::vector<FrameError>& frames) {
  const auto json_of = [](const std::optional<double>& value) { return json_number(value.value_or(NAN)); };
  nlohmann::ordered_json json = {{"frames", nlohmann::ordered_json::array()},
                                 {"mean", nlohmann::ordered_json::object()}};
  for (const FrameError& frame : frames) {
    nlohmann::ordered_json entry = {{"frame", frame.frame}};
    if (!frame.error.empty()) entry["error"] = frame.error;
    for (const Column& column : kColumns) entry[column.name] = json_of(frame.*column.value);
    json["frames"].push_back(std::move(entry));
  }
  for (const Column& column : kColumns) json["mean"][column.name] = json_of(mean_of(frames, column.value));
  return json;
}

Expected<void> plot_shot(const std::vector<FrameError>& frames, const std::string& name) {
  const auto gnuplot = find_gnuplot();
  if (!gnuplot) return std::unexpected(gnuplot.error());
  std::string script =
      "set xlabel 'frame'\nset logscale y\nset format y '%.0e'\nset grid ytics\nset key outside right\n";
  std::string curves;
  for (const Column& column : kColumns) {
    if (!mean_of(frames, column.value)) continue;
    script += fmt::format("${} << end\n", column.name);
    for (const FrameError& frame : frames)
      if (frame.*column.value) script += fmt::format("{} {:.9g}\n", frame.frame, *(frame.*column.value));
    script += "end\n";
    curves += fmt::format("{}${} using 1:2 with linespoints title '{}'", curves.empty() ? "plot " : ", ",
                          column.name, column.name);
  }
  if (curves.empty()) return fail("there is nothing to plot");
  const std::filesystem::path path = std::filesystem::absolute(name);
  const auto drawn = run_gnuplot(*gnuplot, path.parent_path(), path.filename().string(),
                                 {.script = script + curves,
                                  .title = "Error of frames",
                                  .description = "relMSE, FLIP and flicker over the frames of a shot",
                                  .width = 800,
                                  .height = 450});
  return drawn ? Expected<void>() : std::unexpected(drawn.error());
}

}  // namespace penumbra
