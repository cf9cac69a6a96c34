// What a row of the census says, as it is written: "element/type*count@name(…)", each with what it holds.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace penumbra::census {

/// An item, or a parameter of one: "kind:name=value", the kind and the value perhaps left out.
struct Item {
  std::string tag;   ///< of a parameter its kind
  std::string type;  ///< of a parameter its name
  std::string name;  ///< of a parameter its value
  bool is_parameter = false;
  std::vector<Item> inside = {};
};

/// A failure of the test for what is not of the form.
std::vector<Item> read_items(std::string_view text);

}  // namespace penumbra::census
