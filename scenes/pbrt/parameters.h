// The parameters of pbrt's directives: "float fov" 40, "rgb L" [1 2 3]. Each must be requested.
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
  std::string colour_space = "srgb";  ///< of an rgb
  bool taken = false;
};

class Parameters {
 public:
  /// Reads what follows a directive's names; its rgb are of the colour space.
  static Parameters read(TokenReader& tokens, ReaderReport& report, const std::string& colour_space);
  /// With that one alone.
  static Parameters of(const Parameter& parameter);

  /// The value of a parameter, or `fallback` where it is not given; an error where it is of another type.
  double number(std::string_view name, double fallback, ReaderReport& report);
  std::int64_t integer(std::string_view name, std::int64_t fallback, ReaderReport& report);
  bool boolean(std::string_view name, bool fallback, ReaderReport& report);
  std::string text(std::string_view name, std::string_view fallback, ReaderReport& report);
  /// Numbers of one of these types, each vector of `size` of them; empty where it is not given.
  std::vector<double> numbers(std::string_view name, std::initializer_list<std::string_view> types,
                              std::size_t size, ReaderReport& report);
  glm::dvec3 point(std::string_view name, glm::dvec3 fallback, ReaderReport& report);

  [[nodiscard]] const Parameter* find(std::string_view name) const;
  [[nodiscard]] bool has(std::string_view name) const { return find(name) != nullptr; }
  /// The parameter, which counts as requested.
  Parameter* take(std::string_view name);
  [[nodiscard]] SourceLocation location(std::string_view name, SourceLocation otherwise) const;

  /// Known, but without effect on the image.
  void accept(std::initializer_list<std::string_view> names);

  /// Those of `defaults` that are not given ("Attribute").
  void add_defaults(const Parameters& defaults);
  void append(Parameters&& more);

  /// Says which were not requested: "of diffuse".
  void finish(std::string_view what, ReaderReport& report) const;

 private:
  std::vector<Parameter> parameters_;
};

}  // namespace penumbra::pbrt
