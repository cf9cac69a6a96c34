#include "scenes/pbrt/transform_reader.h"

#include <fmt/format.h>

#include <span>
#include <string_view>

#include "scenes/number.h"
#include "scenes/transform.h"

namespace penumbra::pbrt {
namespace {

using Numbers = std::span<const double>;

Expected<glm::dmat4> translate(Numbers n) { return translation({n[0], n[1], n[2]}); }
Expected<glm::dmat4> scale(Numbers n) { return scaling({n[0], n[1], n[2]}); }

Expected<glm::dmat4> rotate(Numbers n) {
  const glm::dvec3 axis(n[1], n[2], n[3]);
  if (!(glm::length(axis) > 0.0)) return fail("a rotation needs an axis");
  return rotation(axis, n[0]);
}

Expected<glm::dmat4> look(Numbers n) {
  const auto frame = look_at({n[0], n[1], n[2]}, {n[3], n[4], n[5]}, glm::dvec3(n[6], n[7], n[8]));
  if (!frame) return std::unexpected(frame.error());
  // The same axes as up x view, up, view, but pbrt's first axis points to the right of the image.
  return glm::inverse(*frame);
}

Expected<glm::dmat4> matrix(Numbers n) {
  glm::dmat4 m;
  for (std::size_t i = 0; i < 16; ++i) m[int(i / 4)][int(i % 4)] = n[i];  // column-major
  if (m[0].w == 0 && m[1].w == 0 && m[2].w == 0 && m[3].w == 1) return m;
  return fail("the last row of a matrix must be 0 0 0 1: numbers are given column by column");
}

struct Directive {
  std::string_view name;
  std::size_t count;  ///< number of arguments
  Expected<glm::dmat4> (*of)(Numbers);
};
constexpr Directive kDirectives[] = {{"Translate", 3, translate}, {"Scale", 3, scale},
                                     {"Rotate", 4, rotate},       {"LookAt", 9, look},
                                     {"Transform", 16, matrix},   {"ConcatTransform", 16, matrix}};

}  // namespace

std::optional<std::vector<double>> read_numbers(std::size_t count, TokenReader& tokens,
                                                ReaderReport& report) {
  std::vector<double> result;
  const bool in_brackets = tokens.peek().kind == TokenKind::kOpen;
  if (in_brackets) tokens.next();
  while (result.size() < count) {
    const Token token = tokens.peek();
    const auto number = token.kind == TokenKind::kWord
                            ? parse_number(token.text)
                            : Expected<double>(fail(fmt::format("{} numbers are wanted here", count)));
    if (!number) {
      report.error(token.location, number.error().message);
      return std::nullopt;
    }
    tokens.next();
    result.push_back(*number);
  }
  if (in_brackets) {
    const Token token = tokens.peek();
    if (token.kind == TokenKind::kClose)
      tokens.next();
    else
      report.error(token.location, fmt::format("{} numbers and a closing bracket are wanted here", count));
  }
  return result;
}

std::optional<glm::dmat4> read_transform(const Token& directive, TokenReader& tokens, ReaderReport& report) {
  for (const Directive& each : kDirectives) {
    if (directive.text != each.name) continue;
    const auto numbers = read_numbers(each.count, tokens, report);
    if (!numbers) return std::nullopt;
    const auto transform = each.of(*numbers);
    if (transform) return *transform;
    report.error(directive.location, transform.error().message);
  }
  return std::nullopt;
}

}  // namespace penumbra::pbrt
