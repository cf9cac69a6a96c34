#include "tests/scenes/census/items.h"

#include <gtest/gtest.h>

namespace penumbra::census {
namespace {

class ItemReader {
 public:
  explicit ItemReader(std::string_view text) : text_(text) {}

  std::vector<Item> read() {
    std::vector<Item> items;
    while (skip_spaces(), at_ < text_.size()) items.push_back(item());
    return items;
  }

 private:
  void skip_spaces() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  std::string word(std::string_view ends) {
    const std::size_t from = at_;
    while (at_ < text_.size() && ends.find(text_[at_]) == ends.npos) ++at_;
    return std::string(text_.substr(from, at_ - from));
  }
  bool take(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  Item item() {
    Item result{word("/ ()"), "", ""};
    if (!take('/')) {
      ADD_FAILURE() << "an item is element/type, not '" << result.tag << "' in " << text_;
      at_ = text_.size();
      return result;
    }
    result.type = word("*@( )");
    if (take('*')) word("@( )");
    if (take('@')) result.name = word("( )");
    if (take('(')) {
      while (skip_spaces(), !take(')')) {
        if (at_ >= text_.size()) {
          ADD_FAILURE() << "no ) in " << text_;
          break;
        }
        const std::size_t slash = text_.find_first_of("/=: )", at_);
        result.inside.push_back(slash != text_.npos && text_[slash] == '/' ? item() : parameter());
      }
    }
    return result;
  }

  Item parameter() {
    Item result{"", word(":= )"), "", true};
    if (take(':')) {
      result.tag = result.type;
      result.type = word("= )");
    }
    if (take('=')) {
      const bool is_quoted = take('\'');
      result.name = word(is_quoted ? "'" : " )");
      if (is_quoted) take('\'');
    }
    return result;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::vector<Item> read_items(std::string_view text) { return ItemReader(text).read(); }

}  // namespace penumbra::census
