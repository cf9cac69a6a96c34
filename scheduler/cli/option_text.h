// What the tables that parse a command line say of an option's value.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace penumbra {

/// What a value is called, and what it may be: of "NAME:{a,b}" NAME, and "a, b".
struct ValueType {
  std::string name, values;
};
ValueType value_type(const CLI::Option& option);

}  // namespace penumbra
