#include "scheduler/private_socket.h"

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>

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
