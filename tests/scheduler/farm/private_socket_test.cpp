#include "scheduler/farm/private_socket.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

namespace penumbra {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::StartsWith;

class PrivateSocketTest : public testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/penumbra-test-XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    parent_ = name;
    setenv("XDG_RUNTIME_DIR", name, 1);
  }
  void TearDown() override { fs::remove_all(parent_); }

  /// A directory as another run would have made it an hour ago.
  std::string old_directory(bool someone_listens) {
    const std::string directory = parent_ + (someone_listens ? "/penumbra-alive1" : "/penumbra-dead01");
    fs::create_directory(directory);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strcpy(address.sun_path, (directory + "/socket").c_str());
    listener_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    if (someone_listens) {
      EXPECT_EQ(listen(listener_, 1), 0);
    } else {
      close(listener_);
    }
    fs::last_write_time(directory, fs::file_time_type::clock::now() - 1h);
    return directory;
  }

  std::string parent_;
  int listener_ = -1;
};

TEST_F(PrivateSocketTest, OnlyItsOwnerCanReachIt) {
  const PrivateSocket socket = PrivateSocket::create().value();
  EXPECT_THAT(socket.directory(), StartsWith(parent_ + "/penumbra-"));
  EXPECT_EQ(socket.address(), "unix:" + socket.directory() + "/socket");
  EXPECT_EQ(fs::status(socket.directory()).permissions(), fs::perms::owner_all);
}

TEST_F(PrivateSocketTest, ItIsRemovedWithItsContents) {
  std::string directory;
  {
    const PrivateSocket socket = PrivateSocket::create().value();
    directory = socket.directory();
    ASSERT_TRUE(fs::create_directory(directory + "/something"));
  }
  EXPECT_FALSE(fs::exists(directory));
}

TEST_F(PrivateSocketTest, APathThatIsTooLongForASocketIsNotUsed) {
  const std::string deep = parent_ + "/" + std::string(100, 'x');
  fs::create_directory(deep);
  setenv("XDG_RUNTIME_DIR", deep.c_str(), 1);
  const PrivateSocket socket = PrivateSocket::create().value();
  EXPECT_THAT(socket.directory(), StartsWith("/tmp/penumbra-"));
}

TEST_F(PrivateSocketTest, ADirectoryThatIsNotThereIsNotUsed) {
  setenv("XDG_RUNTIME_DIR", (parent_ + "/missing").c_str(), 1);
  EXPECT_THAT(PrivateSocket::create().value().directory(), StartsWith("/tmp/penumbra-"));
  unsetenv("XDG_RUNTIME_DIR");
  EXPECT_THAT(PrivateSocket::create().value().directory(), StartsWith("/tmp/penumbra-"));
}

/// A process that makes itself a directory, and lives until it is told to end.
class Owner {
 public:
  Owner() {
    int names[2], ends[2];
    EXPECT_EQ(pipe2(names, O_CLOEXEC), 0);
    EXPECT_EQ(pipe2(ends, O_CLOEXEC), 0);
    pid_ = fork();
    if (pid_ == 0) {
      close(ends[1]);
      const PrivateSocket socket = PrivateSocket::create().value();
      const std::string& name = socket.directory();
      char byte = 0;
      if (write(names[1], name.data(), name.size()) == ssize_t(name.size()) && read(ends[0], &byte, 1) == 0)
        kill(getpid(), SIGKILL);
      _exit(1);
    }
    close(names[1]);
    close(ends[0]);
    end_ = ends[1];
    char name[200] = {};
    EXPECT_GT(read(names[0], name, sizeof name - 1), 0);
    close(names[0]);
    directory_ = name;
  }
  Owner(const Owner&) = delete;
  ~Owner() {
    if (pid_ > 0) die();
  }
  void die() {
    close(end_);
    waitpid(std::exchange(pid_, -1), nullptr, 0);
  }
  [[nodiscard]] const std::string& directory() const { return directory_; }

 private:
  pid_t pid_ = -1;
  int end_ = -1;
  std::string directory_;
};

void make_old(const std::string& directory) {
  fs::last_write_time(directory, fs::file_time_type::clock::now() - 1h);
}

TEST_F(PrivateSocketTest, ALiveProcessKeepsItsDirectoryWithoutAListener) {
  Owner owner;
  // As after the death of a scheduler that a window will start again.
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strcpy(address.sun_path, (owner.directory() + "/socket").c_str());
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ASSERT_EQ(bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  close(listener);
  make_old(owner.directory());
  { const PrivateSocket other = PrivateSocket::create().value(); }
  EXPECT_TRUE(fs::exists(owner.directory()));
  owner.die();
  EXPECT_TRUE(fs::exists(owner.directory())) << "it was killed";
  make_old(owner.directory());
  const PrivateSocket other = PrivateSocket::create().value();
  EXPECT_FALSE(fs::exists(owner.directory()));
}

TEST_F(PrivateSocketTest, OneThatWasNeverListenedAtIsRemovedWhenItsOwnerIsDead) {
  Owner owner;
  make_old(owner.directory());
  { const PrivateSocket other = PrivateSocket::create().value(); }
  EXPECT_TRUE(fs::exists(owner.directory()));
  owner.die();
  const PrivateSocket other = PrivateSocket::create().value();
  EXPECT_FALSE(fs::exists(owner.directory()));
}

TEST_F(PrivateSocketTest, OneThatMovesStaysLocked) {
  std::optional<PrivateSocket> first(PrivateSocket::create().value());
  const PrivateSocket moved = std::move(*first);
  first.reset();
  make_old(moved.directory());
  const PrivateSocket other = PrivateSocket::create().value();
  EXPECT_TRUE(fs::exists(moved.directory()));
}

TEST_F(PrivateSocketTest, WhatOthersKeepUnderALikeNameStays) {
  for (const char* name : {"/penumbra-results", "/penumbra-notes1"}) {
    fs::create_directory(parent_ + name);
    fs::create_directory(parent_ + name + "/mine");
    make_old(parent_ + name);
  }
  const PrivateSocket socket = PrivateSocket::create().value();
  EXPECT_TRUE(fs::exists(parent_ + "/penumbra-results/mine"));
  EXPECT_TRUE(fs::exists(parent_ + "/penumbra-notes1/mine"));
}

TEST_F(PrivateSocketTest, AbandonedOnesAreRemoved) {
  const std::string directory = old_directory(false);
  const PrivateSocket socket = PrivateSocket::create().value();
  EXPECT_FALSE(fs::exists(directory));
}

TEST_F(PrivateSocketTest, ThoseInUseAreNot) {
  const std::string directory = old_directory(true);
  const PrivateSocket socket = PrivateSocket::create().value();
  EXPECT_TRUE(fs::exists(directory));
  close(listener_);
}

}  // namespace
}  // namespace penumbra
