// HTTP/1.1 on a connection. The only file that includes the HTTP library is http.cpp.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scheduler/web/client_connection.h"

namespace penumbra {

/// What the page's server looks at of a request.
struct WebRequest {
  std::string method;  ///< "GET"
  std::string path;    ///< without the query, decoded: "/jobs/3"
  std::string token;   ///< of the query "?token=…"; empty: none
  // Headers; empty: missing.
  std::string host, authorization, cookie, if_none_match;
};

struct WebResponse {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::vector<std::pair<std::string, std::string>> headers = {};
  // The body is one of these.
  std::string text = {};
  std::shared_ptr<const std::string> bytes = {};
  std::filesystem::path file = {};
  /// Gives the next part of a body without end; empty: nothing yet, which it says at least once a second.
  /// Nothing: the end.
  std::function<std::optional<std::string>()> stream = {};
};

/// Answers a request. Called from the thread of each connection.
using WebHandler = std::function<WebResponse(const WebRequest& request)>;

class HttpServer {
 public:
  /// `headers` are part of every response, also to requests that cannot be read.
  HttpServer(WebHandler handler, const std::vector<std::pair<std::string, std::string>>& headers);
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  ~HttpServer();

  /// Answers requests until the connection ends.
  void serve(ClientConnection& connection) const;

 private:
  class Routes;
  std::unique_ptr<Routes> routes_;
};

}  // namespace penumbra
