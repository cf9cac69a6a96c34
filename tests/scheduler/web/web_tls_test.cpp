// Tests the page with the keys of a farm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include "scheduler/web/web_access.h"
#include "scheduler/web/web_server.h"
#include "tests/scheduler/security/farm_keys.h"
#include "tests/scheduler/web/http_client.h"
#include "tests/scheduler/web/some_content.h"
#include "worker/keys/tcp_address.h"

namespace penumbra::web_tls_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(WebTls, OtherHostsAreEncryptedWithTheKeysOfTheFarm) {
  const FarmKeys farm;
  SomeContent content;
  const auto keys = farm.server({"farm.example", "localhost"});
  auto server =
      WebServer::listen({.address = "0.0.0.0:0", .tokens = {keys->tokens.watch}, .keys = keys}, content);
  ASSERT_TRUE(server) << server.error().message;
  const int port = std::stoi(std::string(split_address((*server)->address()).port));
  EXPECT_THAT((*server)->url(), HasSubstr("https://"));

  httplib::SSLClient client("127.0.0.1", port);
  client.enable_server_certificate_verification(false);
  const std::string bearer = "Bearer " + keys->tokens.watch;
  const auto status = [&](const std::string& host, const std::string& authorization) {
    const auto reply = client.Get("/status.json", {{"Host", host}, {"Authorization", authorization}});
    return reply ? reply->status : 0;
  };
  EXPECT_EQ(status("farm.example", bearer), 200);
  EXPECT_EQ(status("farm.example:8080", bearer), 200);
  EXPECT_EQ(status("localhost", bearer), 200);
  EXPECT_EQ(status("evil.example", bearer), 421);
  EXPECT_EQ(status("farm.example", "Bearer " + keys->tokens.work), 401);
  const auto first = client.Get(("/?token=" + keys->tokens.watch).c_str(), {{"Host", "farm.example"}});
  ASSERT_TRUE(first);
  EXPECT_EQ(first->status, 303);
  EXPECT_THAT(first->get_header_value("Set-Cookie"),
              AllOf(HasSubstr("__Host-penumbra_"), HasSubstr("; Secure")));

  HttpClient plain((*server)->address());
  EXPECT_EQ(plain.get("/status.json", "Authorization: " + bearer + "\r\n").status, 0) << "not without TLS";
}

TEST(WebTls, LoopbackIsNotEncryptedAndHasItsOwnCookie) {
  const WebAccess one("127.0.0.1:8080", {"a"}, nullptr), other("127.0.0.1:8081", {"a"}, FarmKeys().server());
  EXPECT_EQ(one.url(), "http://127.0.0.1:8080/");
  EXPECT_EQ(other.url(), "http://127.0.0.1:8081/");
  EXPECT_THAT(one.cookie(), HasSubstr("penumbra_8080="));
  EXPECT_THAT(other.cookie(), HasSubstr("penumbra_8081="));
}

}  // namespace
}  // namespace penumbra::web_tls_test
