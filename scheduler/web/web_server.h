// The page in the browser: an HTTP server that only shows.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/web/web_content.h"
#include "worker/keys/key_folder.h"

namespace penumbra {

struct WebOptions {
  std::string address = {};  ///< "127.0.0.1:8080"; port 0: any free port
  /// Any of them admits; the links contain the first. Never empty.
  std::vector<std::string> tokens = {};
  std::shared_ptr<const Keys> keys = {};  ///< for addresses of other hosts, which are encrypted with them
  bool comes_back = false;                ///< at the end, pages wait for another process at the same address
  int most_connections = 256;
  int most_streams = 64;  ///< pages that receive changes at the same time
};

/// A thread for each connection. Everything that is shown is text of others, so the page's script only makes
/// text of it, and the browser is told to load nothing from elsewhere.
///
///   /                       the page; with ?token=… it sets a cookie
///   /events                 the state whenever it changes (server-sent events)
///   /status.json            the state, as `penumbra status --json`
///   /jobs/N.json            a job with its problems
///   /jobs/N/thumbnail.png   its image as far as it is rendered, small
///   /jobs/N/image.png       and large
///   /jobs/N/files/NAME      one of its files
class WebServer {
 public:
  /// Errors: an address that is in use, is not one of this host, or is reachable from other hosts without
  /// keys.
  static Expected<std::unique_ptr<WebServer>> listen(const WebOptions& options, WebContent& content);
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;
  /// Ends all connections and joins the threads.
  ~WebServer();

  /// The address with its actual port.
  [[nodiscard]] const std::string& address() const;
  /// "http://127.0.0.1:8080/"
  [[nodiscard]] std::string url() const;
  /// The same with a token, to be opened in a browser.
  [[nodiscard]] std::string url_with_token() const;

 private:
  struct State;
  explicit WebServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace penumbra
