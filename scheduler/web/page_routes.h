// The answers of the page's server.
#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scheduler/web/http.h"
#include "scheduler/web/status_feed.h"
#include "scheduler/web/web_access.h"
#include "scheduler/web/web_content.h"
#include "worker/embedded_kernels.h"

namespace penumbra {

/// Headers of every answer. The browser runs no script but the page's own, sends and loads nothing elsewhere,
/// and shows the page in no frame.
const std::vector<std::pair<std::string, std::string>>& page_headers();

/// The files of page/, by their paths.
std::span<const EmbeddedFile> page_files();

/// Thread-safe.
class PageRoutes {
 public:
  /// `comes_back`: see WebOptions.
  PageRoutes(const WebAccess& access, WebContent& content, int most_streams, bool comes_back);

  WebResponse answer(const WebRequest& request);
  /// Streams send the last state and end.
  void close() { feed_.close(); }
  [[nodiscard]] int streams() const { return *streams_; }

 private:
  WebResponse events();
  WebResponse of_job(const WebRequest& request);

  const WebAccess& access_;
  WebContent& content_;
  const int most_streams_;
  const bool comes_back_;
  StatusFeed feed_;
  std::shared_ptr<std::atomic<int>> streams_ = std::make_shared<std::atomic<int>>(0);
};

}  // namespace penumbra
