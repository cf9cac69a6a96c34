#include "scheduler/report/crop_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace penumbra {
namespace {

constexpr int kSmallestCrop = 16;

std::optional<int> whole_number(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<CropChoice> parse_place(std::string_view text) {
  int v[3] = {};
  for (int i = 0; i < 3; ++i) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (i == 2)) return std::nullopt;
    const auto value = whole_number(text.substr(0, comma));
    if (!value || *value < 0) return std::nullopt;
    v[i] = *value;
    if (i < 2) text.remove_prefix(comma + 1);
  }
  if (v[2] < 1) return std::nullopt;
  return CropChoice{CropChoice::Kind::kPlace, v[0], v[1], v[2]};
}

/// A summed-area table: entry (x, y) is the sum left of x and above y.
class SummedArea {
 public:
  SummedArea(const PixelWindow& window, const std::vector<double>& values, double cap)
      : stride_(std::size_t(window.width) + 1), sums_(stride_ * (std::size_t(window.height) + 1), 0.0) {
    for (int y = 0; y < window.height; ++y)
      for (int x = 0; x < window.width; ++x) {
        const double value = values[std::size_t(y) * std::size_t(window.width) + std::size_t(x)];
        const double kept = value > 0 ? std::min(value, cap) : 0;
        sums_[at(x + 1, y + 1)] = kept + sums_[at(x, y + 1)] + sums_[at(x + 1, y)] - sums_[at(x, y)];
      }
  }
  [[nodiscard]] double sum(int x, int y, int width, int height) const {
    return sums_[at(x + width, y + height)] - sums_[at(x, y + height)] - sums_[at(x + width, y)] +
           sums_[at(x, y)];
  }

 private:
  [[nodiscard]] std::size_t at(int x, int y) const { return std::size_t(y) * stride_ + std::size_t(x); }
  std::size_t stride_;
  std::vector<double> sums_;
};

double percentile_99(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !(v > 0); });
  if (values.empty()) return 0;
  const auto at = values.begin() + std::ptrdiff_t(0.99 * double(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

}  // namespace

Expected<CropChoice> parse_crop_choice(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view name = text.substr(0, colon);
  if (name == "error" || name == "centre") {
    CropChoice choice;
    choice.kind = name == "error" ? CropChoice::Kind::kLargestError : CropChoice::Kind::kCentre;
    if (colon == std::string_view::npos) return choice;
    if (const auto size = whole_number(text.substr(colon + 1)); size && *size > 0) {
      choice.size = *size;
      return choice;
    }
  } else if (const auto place = parse_place(text)) {
    return *place;
  }
  return fail(fmt::format("'{}' is not error, centre, error:SIZE, centre:SIZE or X,Y,SIZE", text));
}

ChosenCrop choose_crop(const CropChoice& choice, const PixelWindow& window,
                       const std::vector<double>& errors) {
  const int shorter = std::min(window.width, window.height);
  const int wanted = choice.size > 0 ? choice.size : std::max(kSmallestCrop, shorter / 3);
  PixelWindow crop{0, 0, std::min(wanted, window.width), std::min(wanted, window.height)};
  const int last_x = window.width - crop.width, last_y = window.height - crop.height;
  std::string why;
  switch (choice.kind) {
    case CropChoice::Kind::kPlace:
      crop.x = std::clamp(choice.x - window.x, 0, last_x);
      crop.y = std::clamp(choice.y - window.y, 0, last_y);
      why = "as asked for";
      break;
    case CropChoice::Kind::kCentre:
      crop.x = last_x / 2;
      crop.y = last_y / 2;
      why = "the centre";
      break;
    case CropChoice::Kind::kLargestError: {
      const SummedArea sums(window, errors, percentile_99(errors));
      double most = -1;
      for (int y = 0; y <= last_y; ++y)
        for (int x = 0; x <= last_x; ++x) {
          const double sum = sums.sum(x, y, crop.width, crop.height);
          // If sums are equal up to rounding, the first place is kept.
          if (sum > most * (1 + 1e-9)) {
            most = sum;
            crop.x = x;
            crop.y = y;
          }
        }
      why = "where the relative errors of all methods together are largest";
      break;
    }
  }
  crop.x += window.x;
  crop.y += window.y;
  return {crop, why};
}

}  // namespace penumbra
