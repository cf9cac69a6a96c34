#include "worker/protocol/text.h"

#include <algorithm>

#include "kernels/host/text.h"

namespace penumbra {
namespace {

constexpr std::string_view kCut = "...";

}  // namespace

std::string wire_text(std::string_view text, std::size_t longest) {
  std::string valid;
  valid.reserve(std::min(text.size(), longest));
  std::size_t cut = 0;  // where the text may end so that there is room for the mark
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = character_length(text, at);
    const std::size_t size = std::max<std::size_t>(length, 1);
    if (valid.size() + size > longest) return valid.substr(0, cut).append(kCut);
    valid += length > 0 ? text.substr(at, length) : "?";
    if (valid.size() + kCut.size() <= longest) cut = valid.size();
    at += size;
  }
  return valid;
}

}  // namespace penumbra
