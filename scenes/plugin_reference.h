// The reference of all plugins that are read, made from the rows of their parameters.
#pragma once

#include <string>

namespace penumbra {

/// Markdown: each plugin with its parameters, their values, defaults and meaning.
std::string plugin_reference();

}  // namespace penumbra
