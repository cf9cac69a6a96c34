// Why renders of a set failed: each reason is told once, and at the end for how many more it held.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace penumbra {

class FailureReasons {
 public:
  /// Counts a render of that scene file that failed. Returns whether the reason is new, and so is to be told.
  /// Reasons are the same if they differ in the name of the scene alone.
  bool add(const std::string& render, const std::string& scene, const std::string& reason);

  /// A line about each reason that several renders share, in the order of the reasons:
  /// "39 more renders failed like a-0001, from a-0002 to a-0040: no such file".
  [[nodiscard]] std::vector<std::string> repeated() const;

 private:
  struct Renders {
    std::string first, second, last, reason;  ///< reason: the first's
    std::size_t count = 0;
  };
  std::vector<std::string> reasons_;  // without names of scenes, in the order in which they came
  std::map<std::string, Renders> renders_;
};

}  // namespace penumbra
