#include "scenes/curve_reader.h"

#include <fmt/format.h>

#include <iterator>

#include "scenes/number.h"

namespace penumbra {

Expected<Curves> read_curves(const SourceFile& file, CurveForm form) {
  const std::size_t least = form == CurveForm::kBalls ? 2 : 4;
  const bool ribbons = is_ribbon(form);
  const std::string_view text = file.text;
  Curves read{form, {}};
  std::vector<Curve>& curves = read.curves;
  Curve curve;
  const auto wrong = [&](std::size_t at, const std::string& message) {
    return fail(format_diagnostic({&file, at}, "error", message));
  };
  std::size_t last_line = 0;
  const auto finish = [&]() -> Expected<void> {
    if (curve.empty() && read.ranges.size() <= curves.size()) return {};
    if (curve.size() < least)
      return wrong(last_line, fmt::format("a curve has at least {} control points; this one ends after {}",
                                          least, curve.size()));
    curves.push_back(std::move(curve));
    curve.clear();
    if (!read.ranges.empty() && read.ranges.size() != curves.size())
      return wrong(last_line, "a curve without a parameter where it begins and ends, which others have");
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
      last_line = at;
      if (numbers->size() == 2 && curve.empty() && read.ranges.size() == curves.size()) {
        const glm::dvec2 range((*numbers)[0], (*numbers)[1]);
        if (!(glm::vec2(range).x < glm::vec2(range).y))
          return wrong(at,
                       fmt::format("the parameter of a curve must grow from its beginning to its end, not "
                                   "from {} to {}",
                                   range.x, range.y));
        read.ranges.emplace_back(range);
        at = end + 1;
        continue;
      }
      if (numbers->size() != 4)
        return wrong(at,
                     fmt::format("a control point has four numbers, x y z radius, not {}", numbers->size()));
      const std::vector<double>& n = *numbers;
      if (!ribbons && !(n[3] >= 0.0))
        return wrong(at, fmt::format("a radius must not be below 0, as {} is", n[3]));
      curve.push_back({{n[0], n[1], n[2]}, n[3]});
    }
    at = end + 1;
  }
  if (const auto finished = finish(); !finished) return std::unexpected(finished.error());
  if (curves.empty()) return wrong(0, "the file has no curves: lines of x y z radius");
  return read;
}

std::string text_of(const Curves& curves) {
  std::string text;
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < curves.curves.size(); ++i) {
    if (i > 0) text += '\n';
    if (!curves.ranges.empty()) fmt::format_to(out, "{} {}\n", curves.ranges[i].x, curves.ranges[i].y);
    for (const ControlPoint& at : curves.curves[i])
      fmt::format_to(out, "{} {} {} {}\n", at.position.x, at.position.y, at.position.z, at.radius);
  }
  return text;
}

}  // namespace penumbra
