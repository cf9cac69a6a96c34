#include "scheduler/cli/option_text.h"

#include <cctype>

namespace penumbra {

ValueType value_type(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t colon = type.find(':');
  // In an address, and in a method with parameters, the colon is part of the value.
  if (colon == std::string::npos || (colon > 0 && type[colon - 1] == '[') ||
      (colon + 1 < type.size() && std::isupper((unsigned char)type[colon + 1])))
    return {type, ""};
  std::string values = type.substr(colon + 1);
  if (values.starts_with("{") && values.ends_with("}")) {
    values = values.substr(1, values.size() - 2);
    for (std::size_t at = values.find(','); at != std::string::npos; at = values.find(',', at + 2))
      values.insert(at + 1, " ");
  }
  return {type.substr(0, colon), values};
}

}  // namespace penumbra
