#include "gl/overlay_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

namespace penumbra {
namespace {

constexpr const char* kUnknown = "unknown";

bool unknown(double x) { return !std::isfinite(x) || x < 0; }

/// Three digits, with only as many decimals as needed.
std::string three_digits(double x) {
  if (x >= 99.95) return fmt::format("{:.0f}", x);
  return x >= 9.995 ? fmt::format("{:.1f}", x) : fmt::format("{:.2f}", x);
}

bool starts_with_word(std::string_view message, std::string_view word) {
  return message.size() >= word.size() &&
         std::equal(word.begin(), word.end(), message.begin(),
                    [](char a, char b) { return a == char(std::tolower(static_cast<unsigned char>(b))); });
}

}  // namespace

std::string duration_text(double seconds) {
  if (unknown(seconds)) return kUnknown;
  if (seconds < 0.9995) return fmt::format("{:.0f} ms", 1000 * seconds);
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  if (seconds < 59.5) return fmt::format("{:.0f} s", seconds);
  if (seconds > 1e9) return "more than 30 years";
  const long long whole = std::llround(seconds);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  const long long minutes = (whole + 30) / 60;
  if (minutes < 24 * 60) return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
  const long long hours = (whole + 1800) / 3600;
  return fmt::format("{} d {} h", hours / 24, hours % 24);
}

std::string count_text(double count) {
  if (unknown(count)) return kUnknown;
  if (count < 999.5) return count == std::floor(count) ? fmt::format("{:.0f}", count) : three_digits(count);
  if (count < 999.5e3) return three_digits(count / 1e3) + " k";
  if (count < 999.5e6) return three_digits(count / 1e6) + " M";
  return three_digits(count / 1e9) + " G";
}

std::string percent_text(double fraction) {
  if (unknown(fraction)) return kUnknown;
  const double percent = 100 * fraction;
  if (percent == 0) return "0 %";
  const int decimals = percent >= 9.95 ? 0 : std::clamp(1 - int(std::floor(std::log10(percent))), 1, 8);
  return fmt::format("{:.{}f} %", percent, decimals);
}

std::string connection_text(const ViewStatus& status) {
  switch (status.connection) {
    case ConnectionState::kStarting:
      return "connecting";
    case ConnectionState::kConnected:
      return "connected";
    case ConnectionState::kLost:
      return "connection lost, reconnecting";
    case ConnectionState::kRefused:
      return "connection refused";
    case ConnectionState::kEnded:
      return "the render is over";
    case ConnectionState::kFile:
      return "a file";
  }
  return kUnknown;
}

std::string key_text(std::string_view key) {
  static constexpr auto kPrinted = std::to_array<std::pair<std::string_view, std::string_view>>({
      {"plus", "+"},
      {"minus", "-"},
      {"left_bracket", "["},
      {"right_bracket", "]"},
      {"escape", "esc"},
      {"period", "."},
      {"comma", ","},
  });
  for (const auto& [name, printed] : kPrinted) {
    if (key == name) return std::string(printed);
  }
  std::string text(key);
  std::ranges::replace(text, '_', ' ');
  return text;
}

MessageKind message_kind(std::string_view message) {
  const auto is_of = [message](std::string_view kind) {
    return starts_with_word(message, kind) ||
           message.find(": " + std::string(kind)) != std::string_view::npos;
  };
  if (is_of("error:")) return MessageKind::kError;
  return is_of("warning:") ? MessageKind::kWarning : MessageKind::kPlain;
}

std::string why_no_closed_form(const ViewStatus& status) {
  if (status.hybrid) return {};
  return "This render has no closed form of its light: that takes polygon lights, a pinhole "
         "camera and the integrator polygon_cv or polygon_analytic.";
}

std::string why_no_alpha(const ViewStatus& status) {
  if (!status.hybrid || status.interactive) return why_no_closed_form(status);
  return "A batch render keeps the alpha that it began with.";
}

std::string why_no_camera(const ViewStatus& status) {
  if (status.interactive) return {};
  if (status.connection == ConnectionState::kFile) return "A file has no camera to move.";
  return "A batch render keeps the camera that it began with.";
}

std::string why_no_reload(const ViewStatus& status) {
  if (status.interactive || status.connection == ConnectionState::kFile) return {};
  return "A batch render goes on with the scene that it began with.";
}

std::string why_no_more_samples(const ViewStatus& status) {
  if (!status.interactive) return "A batch render takes the samples that it was asked for, and no others.";
  if (status.connection != ConnectionState::kConnected) return "There is no connection to the scheduler.";
  return {};
}

std::string why_no_copy(const ViewStatus& status) {
  return status.has_camera ? "" : "The window does not know the camera of this picture.";
}

std::string why_no_save(const ViewStatus& status) {
  return status.film_width > 0 ? "" : "There is no picture yet.";
}

}  // namespace penumbra
