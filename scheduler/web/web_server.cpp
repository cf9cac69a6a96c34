#include "scheduler/web/web_server.h"

#include <algorithm>
#include <exception>
#include <list>
#include <mutex>
#include <optional>
#include <thread>

#include "scheduler/farm/acceptor.h"
#include "scheduler/web/page_routes.h"

namespace penumbra {
namespace {

constexpr int kMostStrangers = 64;
constexpr std::chrono::milliseconds kTimeToEndStreams{500}, kPause{5};

constexpr std::string_view kTooMany =
    "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\nRetry-After: 10\r\nConnection: close\r\n"
    "Content-Length: 43\r\n\r\ntoo many browsers are connected; try later\n";

}  // namespace

struct WebServer::State {
  State(const WebOptions& given, WebContent& content, std::unique_ptr<Acceptor> listener,
        std::shared_ptr<SSL_CTX> context)
      : options(given),
        tls(std::move(context)),
        access(listener->address(), given.tokens, given.keys),
        routes(access, content, given.most_streams, given.comes_back),
        acceptor(std::move(listener)) {}

  void take(int descriptor);
  void serve(int descriptor);

  const WebOptions options;
  const std::shared_ptr<SSL_CTX> tls;  // null: not encrypted
  const WebAccess access;
  PageRoutes routes;

  struct Served {
    std::thread thread;
    bool is_over = false;
  };
  std::mutex mutex;
  std::list<Served> served;
  std::unique_ptr<Acceptor> acceptor;
};

/// Called from the acceptor's thread.
void WebServer::State::take(int descriptor) {
  std::list<Served> ended;
  {
    const std::lock_guard lock(mutex);
    for (auto at = served.begin(); at != served.end();) {
      const auto next = std::next(at);
      if (at->is_over) ended.splice(ended.end(), served, at);
      at = next;
    }
    if (int(served.size()) < options.most_connections) {
      Served& one = served.emplace_back();
      one.thread = std::thread([this, &one, descriptor] {
        serve(descriptor);
        const std::lock_guard at_end(mutex);
        one.is_over = true;
      });
      descriptor = -1;
    }
  }
  for (Served& one : ended) one.thread.join();
  if (descriptor < 0) return;
  ClientConnection refused(descriptor, nullptr);
  if (!tls) refused.write(kTooMany);  // fits into the socket's buffer
}

void WebServer::State::serve(int descriptor) {
  ClientConnection connection(descriptor, tls.get());
  const HttpServer http(
      [&](const WebRequest& request) {
        if (access.admits(request) || access.is_token(request.token)) acceptor->admit(descriptor);
        return routes.answer(request);
      },
      page_headers());
  try {
    http.serve(connection);
  } catch (const std::exception&) {
    // Usually out of memory; only this connection ends.
  }
}

WebServer::WebServer(std::unique_ptr<State> state) : state_(std::move(state)) {}

Expected<std::unique_ptr<WebServer>> WebServer::listen(const WebOptions& options, WebContent& content) {
  if (const auto checked = check_web_address(options.address, options.keys != nullptr); !checked)
    return std::unexpected(checked.error());
  std::shared_ptr<SSL_CTX> tls;
  if (is_encrypted_at(options.address)) {
    auto context = make_tls_context(*options.keys);
    if (!context) return std::unexpected(context.error());
    tls = std::move(*context);
  }
  keep_out_of_core_dumps();
  // One more, so that a thread here can say that there are too many.
  const AcceptorLimits limits{.connections = options.most_connections + 1, .strangers = kMostStrangers};
  auto acceptor = Acceptor::listen(options.address, limits, options.keys != nullptr);
  if (!acceptor) return std::unexpected(acceptor.error());
  std::unique_ptr<WebServer> server(
      new WebServer(std::make_unique<State>(options, content, std::move(*acceptor), std::move(tls))));
  State& state = *server->state_;
  state.acceptor->start([&state](int descriptor, int) { state.take(descriptor); });
  return server;
}

WebServer::~WebServer() {
  state_->acceptor->stop();
  state_->routes.close();
  for (auto left = kTimeToEndStreams; left > kPause && state_->routes.streams() > 0; left -= kPause)
    std::this_thread::sleep_for(kPause);
  state_->acceptor->cut_off();
  for (State::Served& one : state_->served) one.thread.join();
}

const std::string& WebServer::address() const { return state_->acceptor->address(); }

std::string WebServer::url() const { return state_->access.url(); }

std::string WebServer::url_with_token() const { return url() + "?token=" + state_->options.tokens.front(); }

}  // namespace penumbra
