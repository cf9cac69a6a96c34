// A page in headless Chromium, driven through its debugging pipe: pages that change, from a server.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "kernels/host/error.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {

class BrowserPage {
 public:
  /// Starts a browser with an empty page of this viewport. Error: there is none (see find_browser), or it
  /// does not answer.
  static Expected<std::unique_ptr<BrowserPage>> open(int width, int height, bool dark);
  BrowserPage(const BrowserPage&) = delete;
  BrowserPage& operator=(const BrowserPage&) = delete;
  ~BrowserPage();

  /// Changes the viewport.
  void resize(int width, int height, bool dark);
  /// Goes to the address and waits until the document is loaded.
  Expected<void> go(const std::string& url);
  /// The value of an expression in the page; an error if it throws.
  Expected<nlohmann::json> evaluate(const std::string& script);
  /// Whether the expression becomes true within a minute.
  bool comes(const std::string& script);
  /// Of the whole page, as PNG.
  void screenshot(const std::filesystem::path& file);

 private:
  BrowserPage() = default;
  Expected<nlohmann::json> call(const std::string& method, nlohmann::json parameters);
  Expected<nlohmann::json> receive();

  const TemporaryFolder folder_;
  pid_t pid_ = -1;
  int to_ = -1, from_ = -1;
  int calls_ = 0;
  std::string session_, unread_;
};

}  // namespace penumbra
