// The files of page/, embedded in the binary.
#pragma once

#include <span>
#include <string_view>

namespace penumbra::web_page {

struct EmbeddedFile {
  std::string_view name;  ///< "scheduler/web/page/page.css"
  std::string_view text;
};

std::span<const EmbeddedFile> page_files();

}  // namespace penumbra::web_page
