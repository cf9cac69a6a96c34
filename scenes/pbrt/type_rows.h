// Tables of the types that a pbrt directive supports.
#pragma once

#include <fmt/format.h>

#include <initializer_list>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/reader_report.h"

namespace penumbra::pbrt {

/// The row of that `type`. If there is none, null and a message, which ends in `instead` in lenient mode.
/// `also`: names of supported types that have no row.
template <typename Rows>
const auto* find_row(const Rows& rows, const std::string& type, std::string_view what,
                     std::string_view instead, SourceLocation location, ReaderReport& report,
                     std::initializer_list<const char*> also = {}) {
  for (const auto& row : rows)
    if (type == row.type) return &row;
  std::vector<std::string> known;
  for (const auto& row : rows) known.emplace_back(row.type);
  known.insert(known.end(), also.begin(), also.end());
  report.unsupported(location,
                     fmt::format("{} '{}' is not one that Penumbra reads{}", what, type,
                                 known_names(type, known, "It reads")),
                     instead);
  return static_cast<decltype(&*std::begin(rows))>(nullptr);
}

}  // namespace penumbra::pbrt
