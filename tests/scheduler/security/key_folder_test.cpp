// Tests the files that `penumbra keys` writes, and how they are read.
#include "worker/keys/key_folder.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/scheduler/security/farm_keys.h"
#include "tests/support/temporary_folder.h"
#include "worker/keys/client_access.h"
#include "worker/keys/make_keys.h"

namespace penumbra {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class KeyFolderTest : public testing::Test {
 protected:
  Expected<void> make(const std::vector<std::string>& names = {"render1", "10.0.0.7"}, bool force = false) {
    return make_keys({.folder = keys(), .names = names, .force = force});
  }
  std::filesystem::path keys() const { return folder_ / "farm"; }
  static std::string error_of(const auto& result) { return result ? "none" : result.error().message; }
  std::string error_of_reading(KeyRole role, const std::string& part = "") {
    return error_of(read_keys(part.empty() ? keys() : keys() / part, role));
  }

  TemporaryFolder folder_;
};

TEST_F(KeyFolderTest, FilesAreTheirOwnersAlone) {
  const mode_t before = umask(0);
  const auto made = make();
  umask(before);
  ASSERT_TRUE(made) << error_of(made);
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(keys())) {
    struct stat status {};
    ASSERT_EQ(stat(entry.path().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, entry.is_directory() ? 0700u : 0600u) << entry.path();
    files += entry.is_directory() ? 0 : 1;
  }
  EXPECT_EQ(files, 2 + 4 * 3 + 3 + 1 + 1 + 2) << "nothing is left beside them";
}

TEST_F(KeyFolderTest, EachRoleReadsItsOwn) {
  ASSERT_TRUE(make());
  std::map<KeyRole, std::shared_ptr<const Keys>> all;
  for (const KeyRoleInfo& role : kKeyRoles) {
    const auto whole = read_keys(keys(), role.role), part = read_keys(keys() / role.folder, role.role);
    ASSERT_TRUE(whole) << error_of(whole);
    ASSERT_TRUE(part) << error_of(part);
    EXPECT_EQ((*whole)->key, (*part)->key);
    EXPECT_EQ((*whole)->tokens.watch.empty(), !role.watches);
    EXPECT_EQ((*whole)->tokens.work.empty(), !role.works);
    EXPECT_EQ((*whole)->tokens.submit.empty(), !role.submits);
    all[role.role] = *whole;
  }
  EXPECT_EQ(all[KeyRole::kScheduler]->tokens.work, all[KeyRole::kWorker]->tokens.work);
  EXPECT_EQ(all[KeyRole::kScheduler]->tokens.watch, all[KeyRole::kViewer]->tokens.watch);
  EXPECT_EQ(all[KeyRole::kScheduler]->tokens.submit, all[KeyRole::kUser]->tokens.submit);
  EXPECT_THAT(error_of_reading(KeyRole::kWorker, "viewer"),
              AllOf(HasSubstr("work.token is missing"), HasSubstr("not the keys of a worker")));
  EXPECT_THAT(error_of_reading(KeyRole::kScheduler, "worker"), HasSubstr("is not made for this use"));
  EXPECT_THAT(error_of_reading(KeyRole::kWorker, "scheduler"), HasSubstr("is not made for this use"));
}

TEST_F(KeyFolderTest, NothingIsReplacedWithoutForce) {
  ASSERT_TRUE(make());
  const std::string key = file_contents(keys() / "worker/key.pem");
  EXPECT_THAT(error_of(make()), AllOf(HasSubstr("is there already"), HasSubstr("--force")));
  // One file is enough, wherever a link leads.
  std::filesystem::remove_all(keys() / "authority");
  for (const char* folder : {"scheduler", "viewer", "user"}) std::filesystem::remove_all(keys() / folder);
  EXPECT_THAT(error_of(make()), HasSubstr("worker/authority.pem is there already"));
  EXPECT_FALSE(std::filesystem::exists(keys() / "authority")) << "nothing is written then";
  EXPECT_EQ(file_contents(keys() / "worker/key.pem"), key);
  EXPECT_TRUE(make({"render1"}, true));
  EXPECT_NE(file_contents(keys() / "worker/key.pem"), key);
}

TEST_F(KeyFolderTest, ALinkIsNotFollowed) {
  std::filesystem::create_directories(keys() / "worker");
  write_text(folder_ / "victim", "precious");
  std::filesystem::create_symlink(folder_ / "victim", keys() / "worker/key.pem");
  EXPECT_THAT(error_of(make()), HasSubstr("key.pem is there already"));
  EXPECT_TRUE(make({"render1"}, true));
  EXPECT_EQ(file_contents(folder_ / "victim"), "precious");
}

TEST_F(KeyFolderTest, NamesAreHostsOrAddresses) {
  for (const char* good : {"render1", "render1.farm.example", "*.farm.example", "10.0.0.7", "fd00::2", "a_b"})
    EXPECT_TRUE(is_certificate_name(good)) << good;
  for (const char* bad :
       {"", "a b", "a,DNS:b", "-a", "a-", "a..b", ".a", "*", "*.", "a/b", "email:x@y", "a\n"})
    EXPECT_FALSE(is_certificate_name(bad)) << bad;
  EXPECT_FALSE(is_certificate_name(std::string("a\0b", 3)));
  EXPECT_FALSE(is_certificate_name(std::string(64, 'a')));
  EXPECT_THAT(error_of(make({"a,DNS:b"})), HasSubstr("'a,DNS:b' is neither"));
  EXPECT_FALSE(std::filesystem::exists(keys()));
}

TEST_F(KeyFolderTest, WhatOthersMayReadIsRefused) {
  ASSERT_TRUE(make());
  for (const char* file : {"key.pem", "work.token"}) {
    chmod((keys() / "worker" / file).c_str(), 0640);
    EXPECT_THAT(error_of_reading(KeyRole::kWorker),
                AllOf(HasSubstr(file), HasSubstr("open to others (mode 0640)")));
    chmod((keys() / "worker" / file).c_str(), 0600);
  }
  EXPECT_EQ(error_of_reading(KeyRole::kWorker), "none");
}

TEST_F(KeyFolderTest, DamageIsNamed) {
  ASSERT_TRUE(make());
  const std::filesystem::path worker = keys() / "worker";
  const auto damaged = [&](const std::string& file, const std::string& text) {
    const std::string before = file_contents(worker / file);
    write_text(worker / file, text);
    const std::string error = error_of_reading(KeyRole::kWorker);
    write_text(worker / file, before);
    return error;
  };
  EXPECT_THAT(damaged("certificate.pem", "nonsense"), HasSubstr("is damaged"));
  EXPECT_THAT(damaged("key.pem", ""), HasSubstr("its private key is damaged"));
  EXPECT_THAT(damaged("key.pem", file_contents(keys() / "viewer/key.pem")),
              HasSubstr("does not belong to its private key"));
  EXPECT_THAT(damaged("authority.pem", "x"), HasSubstr("the authority's is damaged"));
  EXPECT_THAT(damaged("work.token", "short\n"), HasSubstr("work.token holds no token"));
  EXPECT_THAT(damaged("work.token", std::string(32, 'a') + "\nb"), HasSubstr("holds no token"));
  EXPECT_THAT(damaged("work.token", std::string(200000, 'a')), HasSubstr("work.token"));
  const FarmKeys other("penumbra farm other");
  EXPECT_THAT(damaged("authority.pem", other.client()->authority), HasSubstr("is of another authority"));
  std::filesystem::remove(worker / "key.pem");
  EXPECT_THAT(error_of_reading(KeyRole::kWorker), HasSubstr("worker/key.pem"));
  EXPECT_THAT(error_of(read_keys(folder_ / "nowhere", KeyRole::kWorker)), HasSubstr("there is no folder"));
}

TEST_F(KeyFolderTest, ExpiryIsNamedWithItsDate) {
  const FarmKeys farm;
  for (const auto& [validity, what] : {std::pair{kPast, "has expired on "},
                                       std::pair{kFuture, "is valid from "}, std::pair{kGood, "none"}}) {
    const auto keys = farm.client(validity);
    EXPECT_THAT(
        error_of(check_certificate(keys->authority, keys->certificate, keys->key, CertificateUse::kClient)),
        HasSubstr(what));
  }
}

TEST_F(KeyFolderTest, AnotherHostIsNotReachedWithoutKeys) {
  setenv("PENUMBRA_TOKEN", "0123", 1);
  const auto here = client_access("127.0.0.1:7000", "", KeyRole::kWorker);
  ASSERT_TRUE(here);
  EXPECT_EQ(here->token, "0123");
  EXPECT_EQ(getenv("PENUMBRA_TOKEN"), nullptr) << "no child is to inherit it";
  EXPECT_THAT(error_of(client_access("render1:7000", "", KeyRole::kWorker)),
              AllOf(HasSubstr("--keys"), HasSubstr("'worker'"), HasSubstr("ssh -L")));
  EXPECT_TRUE(client_access("unix:/tmp/x", (folder_ / "nowhere").string(), KeyRole::kWorker)) << "needs none";
  ASSERT_TRUE(make());
  const auto there = client_access("render1:7000", keys().string(), KeyRole::kViewer);
  ASSERT_TRUE(there) << error_of(there);
  EXPECT_EQ(there->token, there->keys->tokens.watch);
}

TEST(Secrets, AreComparedWhole) {
  EXPECT_TRUE(are_equal_secrets("", ""));
  EXPECT_TRUE(are_equal_secrets("abc", "abc"));
  for (const char* other : {"", "ab", "abcd", "abd", "bbc"})
    EXPECT_FALSE(are_equal_secrets("abc", other)) << other;
}

}  // namespace
}  // namespace penumbra
