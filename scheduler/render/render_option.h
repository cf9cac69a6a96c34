// The options of a render, a row each. The command line, job files, messages to a service, records,
// statistics and the command that repeats a render read this table.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"
#include "scheduler/render/render_request.h"

namespace penumbra {

/// kCount is a whole number of more than 32 bits, which the metadata of images hold as text.
enum class OptionKind { kFlag, kInteger, kCount, kNumber, kText, kList };

/// What an option determines; some commands have only the options of scene or devices.
enum class OptionPart { kScene, kDevice, kRender };

/// What an option changes.
enum class OptionEffect {
  kNone,    ///< no file
  kFiles,   ///< the files: a command that repeats them needs it, but hash, settings and channels tell it, too
  kPixels,  ///< the same, and only the record tells it
};

/// Who may give an option.
enum class OptionScope {
  kEachRender,  ///< the command, and job files for each of their renders
  kOneRender,   ///< the command, for its only render
};

struct RenderOption {
  std::string names;  ///< on the command line: "--opencl-device,--device"; "--denoise{nfor}" as for add_flag
  std::string value = {};  ///< what the help calls the value; empty: it has none
  std::string group = {};  ///< the heading of the help
  std::string help = {};
  OptionPart part = OptionPart::kRender;
  OptionEffect effect = OptionEffect::kNone;
  OptionScope scope = OptionScope::kEachRender;
  bool shows_default = false;              ///< in the help
  std::string recorded_as = {};            ///< in records; empty: the name
  std::vector<std::string> excludes = {};  ///< names of options that it cannot be given with
  /// Whether the pixels depend on it. Empty: they do.
  std::function<bool(const RenderRequest&)> matters = {};
  std::string sets = {};  ///< the key of the setting that it stands for; empty: none
  /// The value that a record's settings have for it, to repeat the render. Without: the request's.
  std::function<std::vector<std::string>(const RenderSettings&)> setting = {};
  OptionKind kind = OptionKind::kText;
  bool recorded_as_text = false;
  std::string limits = {};  ///< of the value, in words
  /// Sets the value, of a list one more, from text, which becomes the number where it is one with a unit. The
  /// error says what is wrong with the text, without the name.
  std::function<Expected<void>(RenderRequest&, std::string&)> apply = {};
  /// The value as text that apply() takes; none if there is none, or for a flag that is not set.
  std::function<std::vector<std::string>(const RenderRequest&)> print = {};

  /// The first long name, or else the first short one, without dashes.
  [[nodiscard]] std::string name() const;
  /// The same with its dashes.
  [[nodiscard]] std::string word() const;
  [[nodiscard]] std::string record_name() const;
  /// What stands for a flag without a value.
  [[nodiscard]] std::string flag_text() const;
  [[nodiscard]] bool counts_for(const RenderRequest& request) const { return !matters || matters(request); }
  /// Whether it can be given without a value.
  [[nodiscard]] bool is_flag() const { return kind == OptionKind::kFlag || names.contains('{'); }
  /// Whether a message to a service contains it. What the settings hold is there already.
  [[nodiscard]] bool is_sent() const { return scope == OptionScope::kEachRender && !setting; }
};

/// In the order in which a command that repeats a render has them.
std::span<const RenderOption> all_render_options();

/// The row with this name without dashes, or null.
const RenderOption* find_render_option(std::string_view name);

/// The values, unless they are the default.
std::vector<std::string> given_values(const RenderOption& option, const RenderRequest& request);

/// The plan with the defaults of this integrator.
PlanOptions plan_of(const RenderRequest& request, const IntegratorSettings& integrator);

/// Error if options are given that exclude each other.
Expected<void> check_exclusions(const RenderRequest& request);

/// The values of --integrator.
std::vector<std::string> integrator_choices();
/// The values of --sampler.
std::vector<std::string> sampler_names();

/// "x0,y0,x1,y1" with 0 <= x0 < x1 and 0 <= y0 < y1. Error: anything else.
Expected<CropRectangle> parse_crop(const std::string& text);
/// "x,y", neither negative. Error: anything else.
Expected<PixelPosition> parse_pixel(const std::string& text);

}  // namespace penumbra
