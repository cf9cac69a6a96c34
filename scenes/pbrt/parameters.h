// The parameters of pbrt's directives: "float fov" 40, "rgb L" [1 2 3]. Every parameter must be requested, so
// that unknown ones are detected.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/pbrt/tokens.h"

namespace penumbra::pbrt {

struct Parameter {
  std::string type, name;
  SourceLocation location;
  std::vector<double> numbers;
  std::vector<std::string> texts;
  std::string colour_space = "srgb";  ///< colour space of an rgb parameter
  bool taken = false;
};

class Parameters {
 public:
  /// Reads the parameters after a directive's names. `colour_space` applies to its rgb parameters.
  static Parameters read(TokenReader& tokens, ReaderReport& report, const std::string& colour_space);
  /// A list with only this parameter.
  static Parameters of(const Parameter& parameter);

  /// The value of a parameter, or `fallback` if it is not given. It is an error if it has another type.
  double number(std::string_view name, double fallback, ReaderReport& report);
  std::int64_t integer(std::string_view name, std::int64_t fallback, ReaderReport& report);
  bool boolean(std::string_view name, bool fallback, ReaderReport& report);
  std::string text(std::string_view name, std::string_view fallback, ReaderReport& report);
  /// The numbers of a parameter that has one of these types, in groups of `size`. Empty if it is not given.
  std::vector<double> numbers(std::string_view name, std::initializer_list<std::string_view> types,
                              std::size_t size, ReaderReport& report);
  glm::dvec3 point(std::string_view name, glm::dvec3 fallback, ReaderReport& report);

  [[nodiscard]] const Parameter* find(std::string_view name) const;
  [[nodiscard]] bool has(std::string_view name) const { return find(name) != nullptr; }
  /// The parameter, which is marked as requested.
  Parameter* take(std::string_view name);
  [[nodiscard]] SourceLocation location(std::string_view name, SourceLocation otherwise) const;

  /// Accepts parameters that have no effect on the image.
  void accept(std::initializer_list<std::string_view> names);

  /// Adds those of `defaults` that are not given (directive "Attribute").
  void add_defaults(const Parameters& defaults);
  void append(Parameters&& more);

  /// Reports parameters that were not requested. `what` is "of diffuse", for example.
  void finish(std::string_view what, ReaderReport& report) const;

 private:
  std::vector<Parameter> parameters_;
};

}  // namespace penumbra::pbrt
