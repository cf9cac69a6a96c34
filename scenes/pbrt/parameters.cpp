#include "scenes/pbrt/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/number.h"

namespace penumbra::pbrt {
namespace {

constexpr std::string_view kTypes[] = {"bool",   "integer", "float",    "point2",   "vector2", "point3",
                                       "point",  "vector3", "vector",   "normal3",  "normal",  "rgb",
                                       "string", "texture", "spectrum", "blackbody"};

/// Reads a single value, or several in brackets.
void read_values(TokenReader& tokens, Parameter& parameter, ReaderReport& report) {
  const auto add = [&](const Token& token) {
    if (token.kind == TokenKind::kText || token.text == "true" || token.text == "false") {
      parameter.texts.emplace_back(token.text);
      return;
    }
    const auto number = parse_number(token.text);
    if (number)
      parameter.numbers.push_back(*number);
    else if (!report.full())
      report.error(token.location, number.error().message);
  };
  Token token = tokens.next();
  if (token.kind != TokenKind::kOpen) {
    if (token.kind == TokenKind::kEnd || token.kind == TokenKind::kClose)
      report.error(token.location, fmt::format("the parameter '{}' has no value", parameter.name));
    else
      add(token);
    return;
  }
  const SourceLocation opened = token.location;
  for (token = tokens.next(); token.kind != TokenKind::kClose; token = tokens.next()) {
    if (token.kind == TokenKind::kEnd || token.kind == TokenKind::kOpen)
      return report.error(opened, "this bracket is not closed");
    add(token);
  }
}

}  // namespace

Parameters Parameters::read(TokenReader& tokens, ReaderReport& report, const std::string& colour_space) {
  Parameters result;
  while (tokens.peek().kind == TokenKind::kText && !report.full()) {
    const Token token = tokens.next();
    const std::string_view text = trim(token.text);
    const std::size_t space = text.find_first_of(" \t");
    Parameter parameter;
    parameter.location = token.location;
    parameter.colour_space = colour_space;
    parameter.type = text.substr(0, space);
    parameter.name = space == text.npos ? "" : trim(text.substr(space));
    const bool known = std::ranges::find(kTypes, std::string_view(parameter.type)) != std::end(kTypes);
    if (!known || parameter.name.empty()) {
      std::vector<std::string> types(std::begin(kTypes), std::end(kTypes));
      report.error(
          token.location,
          fmt::format("\"{}\" is not a parameter: a type and a name, as in \"float fov\"; types are: {}",
                      text, list_names(types)));
    }
    read_values(tokens, parameter, report);
    // As in pbrt, the last one is used.
    if (std::erase_if(result.parameters_,
                      [&](const Parameter& other) { return other.name == parameter.name; }) > 0)
      report.warn(token.location,
                  fmt::format("the parameter '{}' is there twice; this one counts", parameter.name));
    result.parameters_.push_back(std::move(parameter));
  }
  return result;
}

Parameters Parameters::of(const Parameter& parameter) {
  Parameters result;
  result.parameters_.push_back(parameter);
  return result;
}

const Parameter* Parameters::find(std::string_view name) const {
  const auto found = std::ranges::find(parameters_, name, &Parameter::name);
  return found == parameters_.end() ? nullptr : &*found;
}

Parameter* Parameters::take(std::string_view name) {
  auto* parameter = const_cast<Parameter*>(find(name));
  if (parameter != nullptr) parameter->taken = true;
  return parameter;
}

SourceLocation Parameters::location(std::string_view name, SourceLocation otherwise) const {
  const Parameter* parameter = find(name);
  return parameter != nullptr ? parameter->location : otherwise;
}

std::vector<double> Parameters::numbers(std::string_view name, std::initializer_list<std::string_view> types,
                                        std::size_t size, ReaderReport& report) {
  Parameter* parameter = take(name);
  if (parameter == nullptr) return {};
  if (std::ranges::find(types, std::string_view(parameter->type)) == types.end()) {
    report.error(parameter->location,
                 fmt::format("'{}' must be of the type {}, not {}", name, *types.begin(), parameter->type));
    return {};
  }
  if (!parameter->texts.empty() || parameter->numbers.empty() || parameter->numbers.size() % size != 0) {
    report.error(parameter->location, size == 1 ? fmt::format("'{}' needs numbers", name)
                                                : fmt::format("'{}' needs numbers, {} for each", name, size));
    return {};
  }
  return parameter->numbers;
}

double Parameters::number(std::string_view name, double fallback, ReaderReport& report) {
  const std::vector<double> values = numbers(name, {"float", "integer"}, 1, report);
  if (values.size() > 1) report.error(find(name)->location, fmt::format("'{}' is one number", name));
  return values.empty() ? fallback : values.front();
}

std::int64_t Parameters::integer(std::string_view name, std::int64_t fallback, ReaderReport& report) {
  const std::vector<double> values = numbers(name, {"integer"}, 1, report);
  if (values.empty()) return fallback;
  if (values.size() == 1 && std::abs(values[0]) < 2147483648.0 && values[0] == std::floor(values[0]))
    return std::int64_t(values[0]);
  report.error(find(name)->location, fmt::format("'{}' is one whole number", name));
  return fallback;
}

bool Parameters::boolean(std::string_view name, bool fallback, ReaderReport& report) {
  const Parameter* parameter = take(name);
  if (parameter == nullptr) return fallback;
  if (parameter->type == "bool" && parameter->texts.size() == 1 &&
      (parameter->texts[0] == "true" || parameter->texts[0] == "false"))
    return parameter->texts[0] == "true";
  report.error(parameter->location, fmt::format("'{}' must be a bool: true or false", name));
  return fallback;
}

std::string Parameters::text(std::string_view name, std::string_view fallback, ReaderReport& report) {
  const Parameter* parameter = take(name);
  if (parameter == nullptr) return std::string(fallback);
  if (parameter->type == "string" && parameter->texts.size() == 1) return parameter->texts[0];
  report.error(parameter->location, fmt::format("'{}' must be a string", name));
  return std::string(fallback);
}

glm::dvec3 Parameters::point(std::string_view name, glm::dvec3 fallback, ReaderReport& report) {
  const std::vector<double> values = numbers(name, {"point3", "point", "vector3", "vector"}, 3, report);
  return values.empty() ? fallback : glm::dvec3(values[0], values[1], values[2]);
}

void Parameters::accept(std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) take(name);
}

void Parameters::add_defaults(const Parameters& defaults) {
  for (const Parameter& each : defaults.parameters_) {
    if (has(each.name)) continue;
    parameters_.push_back(each);
    parameters_.back().taken = true;  // a default need not apply to every object
  }
}

void Parameters::append(Parameters&& more) {
  for (Parameter& each : more.parameters_) {
    std::erase_if(parameters_, [&](const Parameter& p) { return p.name == each.name; });
    parameters_.push_back(std::move(each));
  }
}

void Parameters::finish(std::string_view what, ReaderReport& report) const {
  for (const Parameter& each : parameters_)
    if (!each.taken)
      report.unsupported(each.location, fmt::format("the parameter '{}' of {} is not read", each.name, what),
                         "it is ignored");
}

}  // namespace penumbra::pbrt
