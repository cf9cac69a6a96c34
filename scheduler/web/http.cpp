// cpp-httplib 0.11 parses requests and writes responses. Its own sockets are not used: there a request may be
// of any length and take any time, and descriptors beyond 1023 are refused, of which a farm has many.
#include "scheduler/web/http.h"

#include <httplib.h>

#include <fstream>

namespace penumbra {
namespace {

constexpr std::chrono::milliseconds kTimeToNextRequest{5000};
constexpr int kMostRequests = 1000;  // of a connection
constexpr std::size_t kFilePart = std::size_t(256) << 10;

/// The library's view of a connection.
class ConnectionStream final : public httplib::Stream {
 public:
  explicit ConnectionStream(ClientConnection& connection) : connection_(connection) {}

  bool is_readable() const override { return true; }
  bool is_writable() const override { return connection_.is_open(); }
  ssize_t read(char* room, size_t size) override { return connection_.read({room, size}); }
  ssize_t write(const char* bytes, size_t size) override {
    return connection_.write({bytes, size}) ? ssize_t(size) : -1;
  }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return 0; }  // the library refuses large ones

 private:
  ClientConnection& connection_;
};

void send_file(const std::filesystem::path& path, httplib::Response& response, const std::string& type) {
  const auto file = std::make_shared<std::ifstream>(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = *file ? std::streamoff(file->tellg()) : -1;
  if (size < 0) {
    response.status = 404;
    response.set_content("the file is not there (any more)\n", "text/plain; charset=utf-8");
    return;
  }
  response.set_content_provider(
      std::size_t(size), type, [file](size_t offset, size_t length, httplib::DataSink& sink) {
        std::string part(std::min(length, kFilePart), '\0');
        file->seekg(std::streamoff(offset));
        file->read(part.data(), std::streamsize(part.size()));
        return file->gcount() > 0 && sink.write(part.data(), std::size_t(file->gcount()));
      });
}

void put(WebResponse from, httplib::Response& to) {
  to.status = from.status;
  for (const auto& [name, value] : from.headers) to.set_header(name, value);
  if (from.stream) {
    to.set_chunked_content_provider(from.type,
                                    [stream = std::move(from.stream)](size_t, httplib::DataSink& sink) {
                                      if (!sink.is_writable()) return false;
                                      const std::optional<std::string> part = stream();
                                      if (!part) return sink.done(), true;
                                      return part->empty() || sink.write(part->data(), part->size());
                                    });
  } else if (!from.file.empty()) {
    send_file(from.file, to, from.type);
  } else if (from.status != 304) {
    to.set_content(from.bytes ? *from.bytes : from.text, from.type);
  }
}

}  // namespace

class HttpServer::Routes final : public httplib::Server {
 public:
  Routes(WebHandler handler, const std::vector<std::pair<std::string, std::string>>& headers)
      : handler_(std::move(handler)) {
    svr_sock_ = 0;  // otherwise streams end at once, as in a server that has been stopped
    set_default_headers({headers.begin(), headers.end()});
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      put(handler_({.method = request.method,
                    .path = request.path,
                    .token = request.get_param_value("token"),
                    .host = request.get_header_value("Host"),
                    .authorization = request.get_header_value("Authorization"),
                    .cookie = request.get_header_value("Cookie"),
                    .if_none_match = request.get_header_value("If-None-Match")}),
          response);
      return HandlerResponse::Handled;
    });
  }

  /// Returns whether another request may follow.
  bool answer(ClientConnection& connection) {
    ConnectionStream stream(connection);
    bool is_last = true;  // of what cannot be read the end is unknown
    const auto set_up = [&](httplib::Request& request) {
      request.ranges.clear();
      // Compressing costs more time than it saves here.
      request.headers.erase("Accept-Encoding");
      // A body is not read, so what follows would not be a request.
      const bool may_have_body = (request.method != "GET" && request.method != "HEAD") ||
                                 request.has_header("Content-Length") ||
                                 request.has_header("Transfer-Encoding");
      is_last = may_have_body;
      if (!may_have_body) return;
      request.headers.erase("Expect");
      request.headers.erase("Connection");
      request.headers.emplace("Connection", "close");
    };
    bool closed = false;
    return process_request(stream, false, closed, set_up) && !closed && !is_last;
  }

 private:
  const WebHandler handler_;
};

HttpServer::HttpServer(WebHandler handler, const std::vector<std::pair<std::string, std::string>>& headers)
    : routes_(std::make_unique<Routes>(std::move(handler), headers)) {}

HttpServer::~HttpServer() = default;

void HttpServer::serve(ClientConnection& connection) const {
  if (!connection.begin()) return;
  for (int i = 0; i < kMostRequests; ++i)
    if (!connection.wait_for_request(kTimeToNextRequest) || !routes_->answer(connection)) return;
}

}  // namespace penumbra
