#include "scenes/curve_reader.h"

#include <fmt/format.h>

#include "scenes/number.h"

namespace penumbra {

Expected<std::vector<Curve>> read_curves(const SourceFile& file, std::size_t least) {
  const std::string_view text = file.text;
  std::vector<Curve> curves;
  Curve curve;
  const auto wrong = [&](std::size_t at, const std::string& message) {
    return fail(format_diagnostic({&file, at}, "error", message));
  };
  std::size_t last_line = 0;
  const auto finish = [&]() -> Expected<void> {
    if (curve.empty()) return {};
    if (curve.size() < least)
      return wrong(last_line, fmt::format("a curve has at least {} control points; this one ends after {}",
                                          least, curve.size()));
    curves.push_back(std::move(curve));
    curve.clear();
    return {};
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = trim(text.substr(at, end - at));
    if (line.empty()) {
      if (const auto finished = finish(); !finished) return std::unexpected(finished.error());
    } else {
      const Expected<std::vector<double>> numbers = parse_numbers(line);
      if (!numbers) return wrong(at, numbers.error().message);
      if (numbers->size() != 4)
        return wrong(at,
                     fmt::format("a control point has four numbers, x y z radius, not {}", numbers->size()));
      const std::vector<double>& n = *numbers;
      if (!(n[3] >= 0.0)) return wrong(at, fmt::format("a radius must not be below 0, as {} is", n[3]));
      curve.push_back({{n[0], n[1], n[2]}, n[3]});
      last_line = at;
    }
    at = end + 1;
  }
  if (const auto finished = finish(); !finished) return std::unexpected(finished.error());
  if (curves.empty()) return wrong(0, "the file has no curves: lines of x y z radius");
  return curves;
}

}  // namespace penumbra
