#include "gl/script.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <initializer_list>
#include <span>
#include <utility>

#include "scenes/diagnostic.h"
#include "scenes/names.h"
#include "scenes/number.h"

namespace penumbra {
namespace {

constexpr std::int64_t kMostPresses = 100000;
constexpr std::int64_t kLargestWindow = 16384;  // the usual limit of textures in OpenGL
constexpr std::int64_t kMostFrame = 999'999'999;
constexpr double kLongestTimeout = 1e6;      // seconds
constexpr double kLargestAlpha = 1e6;        // as in scene files
constexpr double kLargestExposure = 100;     // stops: 2^100 leaves room in single precision
constexpr double kLargestCoordinate = 1e15;  // its square is a single-precision number

struct Word {
  std::string_view text;
  std::size_t offset = 0;  ///< of its text, or of its opening quote
  bool quoted = false;
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// Parses all lines, continuing after errors, so that all of them are reported at once.
class ScriptParser {
 public:
  ScriptParser(std::string_view text, std::string_view file_name)
      : file_{std::filesystem::path(file_name), std::string(text)} {}

  Expected<std::vector<ScriptCommand>> parse() {
    const std::string_view text = file_.text;
    std::size_t start = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
    for (line_ = 1; start <= text.size() && !diagnostics_.full(); ++line_) {
      const std::size_t end = std::min(text.find('\n', start), text.size());
      if (split(start, end) && !words_.empty()) command();
      start = end + 1;
    }
    if (diagnostics_.failed()) return std::unexpected(diagnostics_.error());
    return std::move(commands_);
  }

 private:
  /// Returns false if the line cannot be split into words.
  bool split(std::size_t at, std::size_t end) {
    const std::string_view text = file_.text;
    words_.clear();
    next_ = 0;
    while (true) {
      while (at < end && is_blank(text[at])) ++at;
      end_ = at;
      if (at == end || text[at] == '#') break;
      const std::size_t begin = at;
      if (text[at] == '"') {
        const std::size_t close = text.find('"', at + 1);
        if (close >= end) return error(begin, "this quote does not end on its line");
        at = close + 1;
        if (at < end && !is_blank(text[at]))
          return error(at, "a blank belongs between a quoted text and what follows");
        words_.push_back({text.substr(begin + 1, close - begin - 1), begin, true});
      } else {
        while (at < end && !is_blank(text[at])) ++at;
        words_.push_back({text.substr(begin, at - begin), begin, false});
      }
      if (words_.back().text.contains('\0')) return error(begin, "a byte 0 in a text");
    }
    return true;
  }

  void command() {
    struct Entry {
      std::string_view name;
      bool (ScriptParser::*parse)();
    };
    static constexpr Entry kCommands[] = {
        {"key", &ScriptParser::key},       {"camera", &ScriptParser::camera},
        {"wait", &ScriptParser::wait},     {"set", &ScriptParser::set},
        {"resize", &ScriptParser::resize}, {"screenshot", &ScriptParser::screenshot},
        {"save", &ScriptParser::save},     {"log", &ScriptParser::log},
        {"quit", &ScriptParser::quit},     {"layer", &ScriptParser::layer},
        {"zoom", &ScriptParser::zoom},     {"reference", &ScriptParser::reference},
        {"point", &ScriptParser::point},   {"compare", &ScriptParser::compare},
        {"copy", &ScriptParser::copy},     {"timeout", &ScriptParser::timeout},
        {"frame", &ScriptParser::frame},   {"play", &ScriptParser::play},
    };
    const Word word = words_[next_++];
    for (const Entry& entry : kCommands) {
      if (word.text != entry.name) continue;
      if ((this->*entry.parse)() && next_ < words_.size())
        error(words_[next_].offset, fmt::format("nothing is expected after this '{}' command", entry.name));
      return;
    }
    std::vector<std::string> names;
    for (const Entry& entry : kCommands) names.emplace_back(entry.name);
    unknown(word, "command", names);
  }

  bool key() {
    const Word* word = take("the name of a key");
    if (!word) return false;
    const auto action = action_of_key(word->text);
    if (!action) {
      return error(word->offset,
                   fmt::format("unknown key '{}'{}", word->text, suggestion(word->text, key_names())));
    }
    int times = 1;
    if (next_ < words_.size() && !take_integer("times to press it", 1, kMostPresses, times)) return false;
    return add(KeyCommand{line_, *action, times});
  }

  bool camera() {
    CameraCommand camera{.line = line_};
    const std::size_t command_offset = words_[next_ - 1].offset;
    bool has_eye = false, has_at = false;
    std::size_t at_offset = 0, up_offset = 0;
    while (next_ < words_.size()) {
      const Word word = words_[next_++];
      const bool is_eye = word.text == "eye", is_at = word.text == "at", is_up = word.text == "up";
      if (!is_eye && !is_at && !is_up) return unknown(word, "part of a camera", {"eye", "at", "up"});
      if ((is_eye && has_eye) || (is_at && has_at) || (is_up && camera.up))
        return error(word.offset, fmt::format("a second '{}'", word.text));
      glm::dvec3 value;
      for (int axis = 0; axis < 3; ++axis) {
        if (!take_number(fmt::format("the {} coordinate of '{}'", "xyz"[axis], word.text),
                         -kLargestCoordinate, kLargestCoordinate, value[axis]))
          return false;
      }
      if (is_eye) camera.eye = value, has_eye = true;
      if (is_at) camera.at = value, has_at = true, at_offset = word.offset;
      if (is_up) camera.up = value, up_offset = word.offset;
    }
    if (!has_eye) return error(command_offset, "a camera needs 'eye X Y Z'");
    if (!has_at) return error(command_offset, "a camera needs 'at X Y Z'");
    if (camera.eye == camera.at) return error(at_offset, "the camera looks at the point where it is");
    if (camera.up) {
      constexpr double kLeastSine = 1e-6;
      const double length = glm::length(*camera.up);
      if (!(length > 0)) return error(up_offset, "'up' has no direction");
      const glm::dvec3 forward = glm::normalize(camera.at - camera.eye);
      if (!(glm::length(glm::cross(forward, *camera.up / length)) > kLeastSine))
        return error(up_offset, "'up' is along the view");
    }
    return add(camera);
  }

  bool wait() {
    const Word* what = take("samples, analytic, finished, connected, denoised, layer, message or frame");
    if (!what) return false;
    WaitCommand wait{.line = line_};
    if (what->text == "samples") {
      wait.what = WaitFor::kSamples;
      if (!take_integer("a number of samples", 1, INT32_MAX, wait.samples)) return false;
    } else if (what->text == "analytic") {
      wait.what = WaitFor::kAnalytic;
      wait.samples = 1;
      const bool says_how_many = next_ < words_.size() && words_[next_].text != "timeout";
      if (says_how_many && !take_integer("a number of frames", 1, INT32_MAX, wait.samples)) return false;
    } else if (what->text == "finished") {
      wait.what = WaitFor::kFinished;
    } else if (what->text == "connected") {
      wait.what = WaitFor::kConnected;
    } else if (what->text == "denoised") {
      wait.what = WaitFor::kDenoised;
    } else if (what->text == "layer") {
      wait.what = WaitFor::kLayer;
    } else if (what->text == "message") {
      wait.what = WaitFor::kMessage;
      const Word* text = take("a part of the message");
      if (!text) return false;
      wait.text = text->text;
    } else if (what->text == "frame") {
      wait.what = WaitFor::kFrame;
      if (!take_integer("the number of a frame", 0, kMostFrame, wait.samples)) return false;
    } else {
      return unknown(
          *what, "thing to wait for",
          {"samples", "analytic", "finished", "connected", "denoised", "layer", "message", "frame"});
    }
    if (next_ < words_.size()) {
      const Word word = words_[next_++];
      if (word.text != "timeout") return unknown(word, "part of a wait", {"timeout"});
      double seconds = 0;
      if (!take_timeout(seconds)) return false;
      wait.timeout_seconds = seconds;
    }
    return add(wait);
  }

  bool timeout() {
    TimeoutCommand timeout{.line = line_};
    return take_timeout(timeout.seconds) && add(timeout);
  }

  bool frame() {
    FrameCommand frame{.line = line_};
    return take_integer("the number of a frame", 0, kMostFrame, frame.frame) && add(frame);
  }

  bool play() {
    if (next_ == words_.size()) return add(PlayCommand{line_, true});
    const Word word = words_[next_++];
    if (word.text != "on" && word.text != "off") return unknown(word, "way to play", {"on", "off"});
    return add(PlayCommand{line_, word.text == "on"});
  }

  bool set() {
    const Word* what = take("alpha or exposure");
    if (!what) return false;
    double value = 0;
    if (what->text == "alpha")
      return take_number("a value", -kLargestAlpha, kLargestAlpha, value) &&
             add(SetAlphaCommand{line_, value});
    if (what->text == "exposure")
      return take_number("stops", -kLargestExposure, kLargestExposure, value) &&
             add(SetExposureCommand{line_, value});
    return unknown(*what, "setting", {"alpha", "exposure"});
  }

  bool layer() {
    const Word* name = take("the name of a layer");
    return name && add(LayerCommand{line_, std::string(name->text)});
  }

  bool reference() {
    const Word* file = take("a file name");
    return file && add(ReferenceCommand{line_, std::string(file->text)});
  }

  bool compare() {
    static constexpr std::array<std::pair<const char*, ShownComparison>, 4> kNames{
        {{"none", ShownComparison::kNone},
         {"reference", ShownComparison::kReference},
         {"difference", ShownComparison::kDifference},
         {"relative", ShownComparison::kRelativeError}}};
    const Word* what = take("none, reference, difference or relative");
    if (!what) return false;
    for (const auto& [name, comparison] : kNames)
      if (what->text == name) return add(CompareCommand{line_, comparison});
    return unknown(*what, "comparison", {"none", "reference", "difference", "relative"});
  }

  bool zoom() {
    ZoomCommand zoom{.line = line_};
    if (next_ < words_.size() && words_[next_].text == "fit") return ++next_, add(zoom);
    if (!take_number("fit, or screen pixels per pixel", kLeastZoom, kMostZoom, zoom.factor)) return false;
    if (next_ == words_.size()) return add(zoom);
    zoom.middle.emplace();
    return take_number("a column of the image", 0, kLargestWindow, (*zoom.middle)[0]) &&
           take_number("a row of the image", 0, kLargestWindow, (*zoom.middle)[1]) && add(zoom);
  }

  bool point() {
    PointCommand point{.line = line_};
    return take_number("a column of the window", 0, kLargestWindow, point.x) &&
           take_number("a row of the window", 0, kLargestWindow, point.y) && add(point);
  }

  bool copy() {
    const Word* what = take("settings, mitsuba or tinyrender");
    if (!what) return false;
    for (const CameraFormat format :
         {CameraFormat::kSettings, CameraFormat::kMitsuba, CameraFormat::kTinyRender})
      if (what->text == kCameraFormatNames[int(format)]) return add(CopyCommand{line_, format});
    return unknown(*what, "format of a camera", {"settings", "mitsuba", "tinyrender"});
  }

  bool resize() {
    ResizeCommand resize{.line = line_};
    return take_integer("a width in pixels", 1, kLargestWindow, resize.width) &&
           take_integer("a height in pixels", 1, kLargestWindow, resize.height) && add(resize);
  }

  bool screenshot() {
    const Word* file = take("a file name");
    if (!file) return false;
    if (extension_of(file->text) != ".png") return error(file->offset, "a screenshot is written as FILE.png");
    return add(ScreenshotCommand{line_, std::string(file->text)});
  }

  bool save() {
    const Word* file = take("a file name");
    if (!file) return false;
    const std::string extension = extension_of(file->text);
    if (extension != ".exr" && extension != ".png")
      return error(file->offset, "an image is saved as FILE.exr or FILE.png");
    return add(SaveCommand{line_, extension == ".exr" ? SaveFormat::kExr : SaveFormat::kPng,
                           std::string(file->text)});
  }

  bool log() {
    const Word* first = take("a text");
    if (!first) return false;
    std::string_view text = first->text;
    if (next_ < words_.size()) {  // the rest of the line exactly as written, with quotes and blanks
      const std::size_t begin = first->offset;
      text = trim(std::string_view(file_.text).substr(begin, end_ - begin));
      next_ = words_.size();
    }
    return add(LogCommand{line_, std::string(text)});
  }

  bool quit() { return add(QuitCommand{line_}); }

  const Word* take(std::string_view what) {
    if (next_ < words_.size()) return &words_[next_++];
    error(end_of_words(), fmt::format("{} is missing", what));
    return nullptr;
  }

  bool take_number(std::string_view what, double low, double high, double& value) {
    const Word* word = take(what);
    if (!word) return false;
    const auto number = parse_number(word->text);
    if (!number) return error(word->offset, number.error().message);
    if (*number < low || *number > high)
      return error(word->offset, fmt::format("'{}' is not between {} and {}", word->text, low, high));
    value = *number;
    return true;
  }

  bool take_timeout(double& seconds) {
    if (!take_number("seconds", 0, kLongestTimeout, seconds)) return false;
    return seconds > 0 || error(words_[next_ - 1].offset, "a timeout is longer than 0 seconds");
  }

  template <typename T>
  bool take_integer(std::string_view what, std::int64_t low, std::int64_t high, T& value) {
    const Word* word = take(what);
    if (!word) return false;
    const auto number = parse_integer(word->text, low, high);
    if (!number) return error(word->offset, number.error().message);
    value = static_cast<T>(*number);
    return true;
  }

  [[nodiscard]] std::size_t end_of_words() const {
    const Word& last = words_.back();
    return last.offset + last.text.size() + (last.quoted ? 2 : 0);
  }

  bool unknown(const Word& word, std::string_view what, std::span<const std::string> names) {
    const std::string near = suggestion(word.text, names);
    return error(word.offset,
                 fmt::format("unknown {} '{}'{}", what, word.text,
                             near.empty() ? fmt::format("; there are: {}", list_names(names)) : near));
  }
  bool unknown(const Word& word, std::string_view what, std::initializer_list<std::string> names) {
    return unknown(word, what, std::span(names.begin(), names.size()));
  }

  bool error(std::size_t offset, std::string_view message) {
    diagnostics_.error({&file_, offset}, message);
    return false;
  }

  template <typename Command>
  bool add(Command command) {
    commands_.emplace_back(std::in_place_type<Command>, std::move(command));
    return true;
  }

  SourceFile file_;
  Diagnostics diagnostics_;
  std::vector<ScriptCommand> commands_;
  int line_ = 0;
  std::vector<Word> words_;  ///< of the line
  std::size_t next_ = 0;     ///< index of the next word
  std::size_t end_ = 0;      ///< end of the line, or start of its comment
};

}  // namespace

int line_of(const ScriptCommand& command) {
  return std::visit([](const auto& c) { return c.line; }, command);
}

Expected<std::vector<ScriptCommand>> parse_script(std::string_view text, std::string_view file_name) {
  return ScriptParser(text, file_name).parse();
}

}  // namespace penumbra
