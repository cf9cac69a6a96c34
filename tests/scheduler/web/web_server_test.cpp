// Tests the page's server over HTTP: who is let in, what is answered, what a hostile client can do.
#include "scheduler/web/web_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "tests/scheduler/web/http_client.h"
#include "tests/scheduler/web/some_content.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::web_server_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kToken = "0123456789abcdef0123456789abcdef";
const std::string kBearer = "Authorization: Bearer " + kToken + "\r\n";

class WebServerTest : public ::testing::Test {
 protected:
  void listen(WebOptions options = {}) {
    options.address = "127.0.0.1:0";
    options.tokens = {kToken, "another-token-that-admits-too-0000"};
    auto server = WebServer::listen(options, content_);
    ASSERT_TRUE(server) << server.error().message;
    server_ = std::move(*server);
  }
  [[nodiscard]] HttpClient client() const { return HttpClient(server_->address()); }
  [[nodiscard]] HttpReply get(const std::string& path, const std::string& headers = kBearer,
                              const std::string& method = "GET") const {
    return client().get(path, headers, method);
  }

  SomeContent content_;
  std::unique_ptr<WebServer> server_;
};

TEST_F(WebServerTest, WhoHasNoTokenSeesNothing) {
  listen();
  for (const char* path :
       {"/", "/page.js", "/page.css", "/events", "/status.json", "/jobs/3.json", "/jobs/3/image.png",
        "/jobs/3/files/a.exr", "/nothing", "/?token=wrong", "/status.json?token="}) {
    const HttpReply reply = get(path, "");
    EXPECT_EQ(reply.status, 401) << path;
    EXPECT_THAT(reply.body, Not(HasSubstr("box.xml"))) << path;
  }
  for (const std::string& headers :
       {std::string("Authorization: Bearer 0123456789abcdef0123456789abcdeF\r\n"),
        std::string("Authorization: Bearer \r\n"), "Authorization: Basic " + kToken + "\r\n",
        std::string("Cookie: penumbra_1=" + kToken + "\r\n")})
    EXPECT_EQ(get("/status.json", headers).status, 401) << headers;
  // A token in a link is for the page alone; other addresses are not made to be passed on.
  EXPECT_EQ(get("/status.json?token=" + kToken, "").status, 401);
}

TEST_F(WebServerTest, TheLinkGivesACookieThatAdmits) {
  listen();
  const std::string link = server_->url_with_token();
  EXPECT_EQ(link, "http://" + server_->address() + "/?token=" + kToken);
  const HttpReply first = get("/?token=" + kToken, "");
  EXPECT_EQ(first.status, 303);
  EXPECT_EQ(first.header("Location"), "/");
  const std::string cookie = first.header("Set-Cookie");
  EXPECT_THAT(cookie, AllOf(HasSubstr("; HttpOnly"), HasSubstr("; SameSite=Strict"), HasSubstr("; Path=/"),
                            Not(HasSubstr(kToken))));
  const std::string headers = "Cookie: other=1; " + cookie.substr(0, cookie.find(';')) + "; more=2\r\n";
  EXPECT_EQ(get("/", headers).status, 200);
  EXPECT_THAT(get("/status.json", headers).body, HasSubstr("box.xml"));
  EXPECT_EQ(get("/status.json", "Authorization: Bearer another-token-that-admits-too-0000\r\n").status, 200);
}

TEST_F(WebServerTest, EveryAnswerTellsTheBrowserToBeStrict) {
  listen();
  for (const auto& [path, headers] : {std::pair<std::string, std::string>{"/", kBearer},
                                      {"/", ""},
                                      {"/none", kBearer},
                                      {"/status.json", kBearer},
                                      {"/jobs/3/thumbnail.png", kBearer}}) {
    const HttpReply reply = get(path, headers);
    const std::string policy = reply.header("Content-Security-Policy");
    EXPECT_THAT(policy,
                AllOf(HasSubstr("default-src 'none'"), HasSubstr("script-src 'self'"),
                      HasSubstr("frame-ancestors 'none'"), Not(HasSubstr("unsafe")), Not(HasSubstr("*"))))
        << path;
    EXPECT_EQ(reply.header("X-Content-Type-Options"), "nosniff") << path;
    EXPECT_EQ(reply.header("Referrer-Policy"), "no-referrer") << path;
    EXPECT_EQ(reply.header("Cache-Control"), path.ends_with(".png") ? "private, no-cache" : "no-store")
        << path;
  }
  EXPECT_THAT(client().ask("nonsense\r\n\r\n").header("Content-Security-Policy"),
              HasSubstr("default-src 'none'"));
}

TEST_F(WebServerTest, ItOnlyShows) {
  listen();
  for (const char* method : {"POST", "PUT", "DELETE", "PATCH", "OPTIONS"}) {
    const HttpReply reply = get("/status.json", kBearer + "Content-Length: 0\r\n", method);
    EXPECT_EQ(reply.status, 405) << method;
    EXPECT_EQ(reply.header("Allow"), "GET, HEAD") << method;
  }
  const HttpReply head = get("/status.json", kBearer, "HEAD");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.body, "");
  EXPECT_EQ(get("/events", kBearer, "HEAD").status, 200);
}

TEST_F(WebServerTest, ABodyIsNotTakenForAnotherRequest) {
  listen();
  const std::string inner = "GET /status.json HTTP/1.1\r\nHost: 127.0.0.1\r\n" + kBearer + "\r\n";
  for (const char* method : {"POST", "GET"}) {
    HttpClient one = client();
    one.send(fmt::format("{} / HTTP/1.1\r\nHost: 127.0.0.1\r\n{}Content-Length: {}\r\n\r\n{}", method,
                         kBearer, inner.size(), inner));
    EXPECT_TRUE(one.is_ended()) << method;
    EXPECT_THAT(one.read_until("box.xml"), Not(HasSubstr("box.xml"))) << method;
  }
}

TEST_F(WebServerTest, OnlyUnderItsOwnNames) {
  listen();
  const auto status = [&](const std::string& host) {
    return client().ask(fmt::format("GET / HTTP/1.1\r\n{}{}\r\n", host, kBearer)).status;
  };
  for (const char* host : {"127.0.0.1", "localhost", "localhost:9000", "127.0.0.1:80", "[::1]:8080",
                           "localhost.", "LocalHost:9000", "LOCALHOST.:80"})
    EXPECT_EQ(status(fmt::format("Host: {}\r\n", host)), 200) << host;
  // An attacker's name that leads here.
  for (const char* host : {"evil.example", "evil.example:8080", "127.0.0.1.evil.example",
                           "localhost.evil.example", "10.0.0.1", "localhost.."})
    EXPECT_EQ(status(fmt::format("Host: {}\r\n", host)), 421) << host;
  EXPECT_EQ(status(""), 421);
}

TEST_F(WebServerTest, FilesOfThePageAreThere) {
  listen();
  for (const auto& [path, type] : {std::pair{"/", "text/html"},
                                   {"/page.js", "text/javascript"},
                                   {"/jobs.js", "text/javascript"},
                                   {"/page.css", "text/css"},
                                   {"/base.css", "text/css"},
                                   {"/icon.svg", "image/svg+xml"}}) {
    const HttpReply reply = get(path);
    EXPECT_EQ(reply.status, 200) << path;
    EXPECT_THAT(reply.header("Content-Type"), HasSubstr(type)) << path;
    EXPECT_GT(reply.body.size(), 100u) << path;
  }
  for (const char* path :
       {"/page", "/../page.js", "/%2e%2e/web_server.h", "//page.js", "/index.html/", "/page.js%00"})
    EXPECT_EQ(get(path).status, 404) << path;
}

TEST_F(WebServerTest, JobsPicturesAndFiles) {
  const TemporaryFolder folder;
  const std::string name = "a \"b\"\r\n<c>.exr", contents(300'000, 'x');
  write_text(folder / "stored", contents);
  content_.files = {{name, folder / "stored"}, {"gone.png", folder / "gone"}};
  listen();
  EXPECT_THAT(get("/jobs/3.json").body, HasSubstr("a worker was lost"));
  const HttpReply small = get("/jobs/3/thumbnail.png?v=7");
  EXPECT_EQ(small.header("Content-Type"), "image/png");
  EXPECT_EQ(small.body, "picture of 256");
  EXPECT_EQ(get("/jobs/3/image.png").body, "picture of 2048");
  EXPECT_EQ(small.header("ETag"), "\"v1\"");
  EXPECT_EQ(get("/jobs/3/thumbnail.png", kBearer + "If-None-Match: \"v1\"\r\n").status, 304);
  EXPECT_EQ(get("/jobs/3/thumbnail.png", kBearer + "If-None-Match: \"v0\"\r\n").status, 200);
  const HttpReply file = get("/jobs/3/files/a%20%22b%22%0D%0A%3Cc%3E.exr");
  EXPECT_EQ(file.status, 200);
  EXPECT_TRUE(file.body == contents);
  EXPECT_EQ(file.header("Content-Disposition"), "attachment; filename*=UTF-8''a%20%22b%22%0D%0A%3Cc%3E.exr");
  EXPECT_EQ(get("/jobs/3/files/gone.png").status, 404);
  for (const char* path : {"/jobs/4.json", "/jobs/4/image.png", "/jobs/4/files/gone.png", "/jobs/3/files/",
                           "/jobs/", "/jobs/x.json", "/jobs/-3.json", "/jobs/3", "/jobs/3/",
                           "/jobs/99999999999.json", "/jobs/3/files/..%2Fjob"})
    EXPECT_EQ(get(path).status, 404) << path;
}

TEST_F(WebServerTest, HostileNamesAreTextOfJson) {
  const std::string name = "</script><script>alert(1)</script>\n\ndata: {}\n\"'\xE2\x80\xAE\xFF\x01";
  content_.rename(name);
  listen();
  const HttpReply reply = get("/status.json");
  EXPECT_THAT(reply.header("Content-Type"), HasSubstr("application/json"));
  const auto json = nlohmann::json::parse(reply.body, nullptr, false);
  ASSERT_FALSE(json.is_discarded());
  EXPECT_THAT(json["jobs"][0]["name"].get<std::string>(), HasSubstr("<script>alert(1)"));
  HttpClient events = client();
  events.send("GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n" + kBearer + "\r\n");
  const std::string stream = events.read_until("}\n\n");
  EXPECT_EQ(stream.find("\ndata: "), stream.rfind("\ndata: ")) << "a name that adds an event";
}

TEST_F(WebServerTest, EventsComeWithChanges) {
  listen();
  HttpClient events = client();
  events.send("GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n" + kBearer + "\r\n");
  EXPECT_THAT(events.read_until("\n\n"), HasSubstr("text/event-stream"));
  EXPECT_THAT(events.read_until("box.xml"), HasSubstr("box.xml"));
  content_.rename("sphere.xml");
  EXPECT_THAT(events.read_until("sphere.xml"), HasSubstr("sphere.xml"));
  server_.reset();
  EXPECT_THAT(events.read_until("event: over"), HasSubstr("event: over"));
  EXPECT_TRUE(events.is_ended());
}

TEST_F(WebServerTest, AServiceThatComesBackDoesNotSayThatItIsOver) {
  listen({.comes_back = true});
  HttpClient events = client();
  events.send("GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n" + kBearer + "\r\n");
  events.read_until("box.xml");
  server_.reset();
  EXPECT_TRUE(events.is_ended());
  EXPECT_THAT(events.read_until("over"), Not(HasSubstr("event: over")));
}

TEST_F(WebServerTest, TooManyPagesAreToldSo) {
  listen({.most_streams = 2});
  const std::string request = "GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n" + kBearer + "\r\n";
  auto first = std::make_unique<HttpClient>(server_->address());
  HttpClient second = client();
  for (HttpClient* one : {first.get(), &second}) {
    one->send(request);
    one->read_until("box.xml");
  }
  const HttpReply third = get("/events");
  EXPECT_EQ(third.status, 503);
  EXPECT_THAT(third.body, HasSubstr("2 pages"));
  EXPECT_EQ(get("/status.json").status, 200);
  first.reset();
  int status = 503;
  for (int i = 0; i < 3000 && status == 503; ++i) {
    status = get("/events", kBearer, "HEAD").status;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(status, 200) << "the place of a page that was closed is free";
}

TEST_F(WebServerTest, TooManyConnectionsAreToldSo) {
  listen({.most_connections = 2});
  HttpClient first = client(), second = client();
  for (HttpClient* one : {&first, &second}) {
    one->send("GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n" + kBearer + "\r\n");
    one->read_until("box.xml");
  }
  HttpClient third = client();
  EXPECT_THAT(third.read_until("later\n"), HasSubstr("503"));
  EXPECT_TRUE(third.is_ended());
}

TEST_F(WebServerTest, OversizedAndBrokenRequestsEndTheirConnection) {
  listen();
  const std::string host = "Host: 127.0.0.1\r\n";
  for (const std::string& request :
       {"GET /" + std::string(100'000, 'a') + " HTTP/1.1\r\n" + host + "\r\n",
        "GET / HTTP/1.1\r\n" + host + "X: " + std::string(100'000, 'a') + "\r\n\r\n",
        [&] {
          std::string many = "GET / HTTP/1.1\r\n" + host;
          for (int i = 0; i < 10'000; ++i) many += "X" + std::to_string(i) + ": y\r\n";
          return many + "\r\n";
        }(),
        std::string(100'000, 'z'), std::string(1000, '\0') + "\r\n", std::string("\r\n\r\n"),
        std::string("GET\r\n\r\n")}) {
    HttpClient one = client();
    one.send(request);
    EXPECT_TRUE(one.is_ended()) << request.substr(0, 20);
  }
  // Long ranges go through a recursive parser.
  std::string ranges = "Range: bytes=0-1";
  while (ranges.size() < 8000) ranges += ",0-1";
  EXPECT_NE(get("/status.json", kBearer + ranges + "\r\n").status, 206);
  EXPECT_EQ(get("/status.json").status, 200);
}

TEST_F(WebServerTest, SeveralRequestsOnAConnection) {
  listen();
  HttpClient one = client();
  for (int i = 0; i < 20; ++i) EXPECT_EQ(one.get("/status.json", kBearer).status, 200) << i;
}

TEST_F(WebServerTest, ItEndsWhoeverIsConnected) {
  listen();
  HttpClient silent = client(), half = client(), reading = client();
  half.send("GET / HT");
  reading.send("GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n" + kBearer + "\r\n");
  reading.read_until("box.xml");
  server_.reset();
  EXPECT_TRUE(silent.is_ended());
  EXPECT_TRUE(half.is_ended());
}

TEST_F(WebServerTest, AddressesThatCannotBe) {
  const auto error = [&](const std::string& address) {
    const auto server = WebServer::listen({.address = address, .tokens = {kToken}}, content_);
    return server ? "" : server.error().message;
  };
  EXPECT_THAT(error("0.0.0.0:0"), HasSubstr("--keys"));
  EXPECT_THAT(error("unix:/tmp/x"), HasSubstr("a browser needs host and port"));
  EXPECT_THAT(error("127.0.0.1"), HasSubstr("127.0.0.1"));
  EXPECT_THAT(error("127.0.0.1:99999"), HasSubstr("cannot listen"));
  listen();
  EXPECT_THAT(error(server_->address()), HasSubstr("in use"));
}

}  // namespace
}  // namespace penumbra::web_server_test
