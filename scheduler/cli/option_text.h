// The name and the accepted values of an option, from the command line's tables.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace penumbra {

/// For "NAME:{a,b}" the name NAME and the values "a, b".
struct ValueType {
  std::string name, values;
};
ValueType value_type(const CLI::Option& option);

}  // namespace penumbra
