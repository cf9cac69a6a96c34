// The tev client against a server that decodes its bytes by the protocol's description, with a decoder of its
// own.
#include "scheduler/watch/tev.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <utility>

#include "tests/scheduler/watch/fake_tev.h"
#include "tests/scheduler/watch/silent_name_service.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;
using std::chrono::steady_clock;
using testing::HasSubstr;

constexpr milliseconds kShort{250};
constexpr milliseconds kSoon = kTevSoon;

const std::vector<std::string> kRgb = {"R", "G", "B"};

template <typename T>
T or_throw(Expected<T> value) {
  if (!value) throw std::runtime_error(value.error().message);
  return std::move(*value);
}
void or_throw(const Expected<void>& value) {
  if (!value) throw std::runtime_error(value.error().message);
}

TEST(TevPackets, CreateImageByteForByte) {
  const std::vector<std::string> channels = {"R", "diff.G"};
  const std::vector<std::uint8_t> expected = {
      31,   0,    0,   0,                        // length
      4,                                         // create
      1,                                         // grab focus
      'a',  ' ',  'b', 0,                        // name
      0x80, 0x07, 0,   0,   0x38, 0x04, 0,   0,  // 1920 x 1080
      2,    0,    0,   0,                        // channels
      'R',  0,    'd', 'i', 'f',  'f',  '.', 'G', 0,
  };
  ASSERT_EQ(expected.size(), 31u);
  EXPECT_EQ(or_throw(encode_create_image("a b", 1920, 1080, channels)), expected);
  auto unfocused = expected;
  unfocused[5] = 0;
  EXPECT_EQ(or_throw(encode_create_image("a b", 1920, 1080, channels, false)), unfocused);
}

TEST(TevPackets, CloseImageByteForByte) {
  const std::vector<std::uint8_t> expected = {9, 0, 0, 0, 2, 'i', 'm', 'g', 0};
  EXPECT_EQ(or_throw(encode_close_image("img")), expected);
}

TEST(TevPackets, UpdateTileByteForByte) {
  // One pixel of two channels at (258, 1): 1 is 0x3F800000, -2 is 0xC0000000.
  const std::vector<std::string> channels = {"x", "y"};
  const float values[] = {1.0f, -2.0f};
  const std::vector<std::uint8_t> expected = {
      72, 0, 0,    0,    6, 0, 'n', 0,    2, 0, 0, 0, 'x', 0, 'y', 0,  //
      2,  1, 0,    0,    1, 0, 0,   0,    1, 0, 0, 0, 1,   0, 0,   0,  // x, y, width, height
      0,  0, 0,    0,    0, 0, 0,   0,    1, 0, 0, 0, 0,   0, 0,   0,  // offsets
      2,  0, 0,    0,    0, 0, 0,   0,    2, 0, 0, 0, 0,   0, 0,   0,  // strides
      0,  0, 0x80, 0x3F, 0, 0, 0,   0xC0,                              // values
  };
  ASSERT_EQ(expected.size(), 72u);
  EXPECT_EQ(or_throw(encode_update_tile("n", {258, 1, 1, 1}, channels, values, TevLayout::kInterleaved)),
            expected);
}

TEST(TevPackets, BothLayoutsSayTheSame) {
  constexpr int kWidth = 5, kHeight = 3, kPixels = kWidth * kHeight;
  std::vector<float> interleaved(kPixels * 3), planar(kPixels * 3);
  for (int p = 0; p < kPixels; ++p) {
    for (int c = 0; c < 3; ++c)
      interleaved[std::size_t(3 * p + c)] = planar[std::size_t(c * kPixels + p)] = float(100 * c + p);
  }
  const TevTile tile{7, 9, kWidth, kHeight};
  for (const TevLayout layout : {TevLayout::kInterleaved, TevLayout::kPlanar}) {
    const auto& values = layout == TevLayout::kPlanar ? planar : interleaved;
    const Update update = decode_update(or_throw(encode_update_tile("i", tile, kRgb, values, layout)));
    EXPECT_EQ(update.channels, kRgb);
    for (int p = 0; p < kPixels; ++p) {
      for (int c = 0; c < 3; ++c) EXPECT_EQ(update.at(std::size_t(c), p), float(100 * c + p));
    }
  }
}

TEST(TevPackets, RefusesWhatTevCannotRead) {
  const float values[4] = {1, 2, 3, 4};
  const std::string zero("a\0b", 3);
  const auto update = [&](std::string_view name, TevTile tile, std::vector<std::string> channels, int count) {
    return encode_update_tile(name, tile, channels, std::span(values, std::size_t(count)), TevLayout::kPlanar)
        .has_value();
  };
  EXPECT_TRUE(update("n", {0, 0, 1, 1}, kRgb, 3));
  EXPECT_FALSE(update("", {0, 0, 1, 1}, kRgb, 3));
  EXPECT_FALSE(update(zero, {0, 0, 1, 1}, kRgb, 3));
  EXPECT_FALSE(update("n", {-1, 0, 1, 1}, kRgb, 3));
  EXPECT_FALSE(update("n", {0, -1, 1, 1}, kRgb, 3));
  EXPECT_FALSE(update("n", {0, 0, 0, 1}, kRgb, 0));
  EXPECT_FALSE(update("n", {0, 0, 1, -1}, kRgb, 3));
  EXPECT_FALSE(update("n", {0, 0, -1, -1}, kRgb, 3));
  EXPECT_FALSE(update("n", {0, 0, 1, 1}, {}, 0));
  EXPECT_FALSE(update("n", {0, 0, 1, 1}, {"R", "", "B"}, 3));
  EXPECT_FALSE(update("n", {0, 0, 1, 1}, {"R", zero, "B"}, 3));
  EXPECT_FALSE(update("n", {0, 0, 1, 1}, kRgb, 2));
  EXPECT_FALSE(update("n", {0, 0, 1, 1}, kRgb, 4));
  EXPECT_FALSE(update("n", {0, 0, 1, 2}, kRgb, 3));
  EXPECT_FALSE(update("n", {0, 0, INT32_MAX, INT32_MAX}, kRgb, 3));
  EXPECT_FALSE(encode_create_image("n", 0, 1, kRgb).has_value());
  EXPECT_FALSE(encode_create_image("n", 1, -5, kRgb).has_value());
  EXPECT_FALSE(encode_create_image("n", 1, 1, {}).has_value());
  EXPECT_FALSE(encode_create_image("", 1, 1, kRgb).has_value());
  EXPECT_FALSE(encode_close_image("").has_value());
  EXPECT_FALSE(encode_close_image(zero).has_value());
}

TEST(TevAddresses, WhatIsLeftOutIsTheDefault) {
  struct Case {
    std::string_view text;
    std::string host;
    int port;
  };
  for (const Case& c :
       {Case{"", "127.0.0.1", 14158}, Case{"node7", "node7", 14158}, Case{"node7:1", "node7", 1},
        Case{":65535", "127.0.0.1", 65535}, Case{"10.0.0.2:80", "10.0.0.2", 80}, Case{"[::1]:90", "::1", 90},
        Case{"[fe80::2]", "fe80::2", 14158}, Case{"fe80::2", "fe80::2", 14158}}) {
    const auto address = parse_tev_address(c.text);
    ASSERT_TRUE(address.has_value()) << c.text;
    EXPECT_EQ(address->host, c.host) << c.text;
    EXPECT_EQ(int(address->port), c.port) << c.text;
  }
}

TEST(TevAddresses, WrongOnesAreNamed) {
  for (const std::string_view text : {"host:", "host:0", "host:65536", "host:tev", "host:80x", "host:-1",
                                      "host: 80", "[::1", "[::1]80", "[::1]:", "[]:80", "[::1]:x"}) {
    const auto address = parse_tev_address(text);
    ASSERT_FALSE(address.has_value()) << text;
    EXPECT_THAT(address.error().message, HasSubstr(std::string(text)));
    const auto client = TevClient::connect(std::string(text));
    ASSERT_FALSE(client.has_value()) << text;
    EXPECT_EQ(client.error().message, address.error().message);
  }
}

/// A render's way: create, two tiles, close. Special values arrive with all their bits.
void stream_an_image(FakeTev& tev, const std::string& host) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  const std::vector<float> first = {0.5f, -0.0f, 1e-40f, nan, infinity, -1e30f};
  std::vector<float> second(3 * 4 * 2);
  std::iota(second.begin(), second.end(), 0.25f);
  {
    TevClient client = or_throw(TevClient::connect(host));
    EXPECT_TRUE(client.connected());
    or_throw(client.create_image("render", 8, 6, kRgb));
    or_throw(client.update_tile("render", 6, 5, 2, 1, kRgb, first));
    TevClient moved = std::move(client);
    or_throw(moved.update_tile("render", 0, 1, 4, 2, kRgb, second, TevLayout::kPlanar));
    or_throw(moved.close_image("render"));
  }
  const auto packets = tev.packets();
  ASSERT_EQ(packets.size(), 4u);

  Decoder create = open(packets[0], 4);
  EXPECT_EQ(int(create.byte()), 1);
  EXPECT_EQ(create.text(), "render");
  EXPECT_EQ(create.int32(), 8);
  EXPECT_EQ(create.int32(), 6);
  EXPECT_EQ(create.int32(), 3);
  for (const std::string& channel : kRgb) EXPECT_EQ(create.text(), channel);
  EXPECT_EQ(create.left(), 0u);

  const Update a = decode_update(packets[1]);
  EXPECT_FALSE(a.grab_focus);  // tev goes on showing the image that its user has selected
  EXPECT_EQ(a.name, "render");
  EXPECT_EQ(a.channels, kRgb);
  EXPECT_THAT((std::vector{a.x, a.y, a.width, a.height}), testing::ElementsAre(6, 5, 2, 1));
  EXPECT_THAT(a.offsets, testing::ElementsAre(0, 1, 2));
  EXPECT_THAT(a.strides, testing::ElementsAre(3, 3, 3));
  ASSERT_EQ(a.values.size(), first.size());
  EXPECT_EQ(std::memcmp(a.values.data(), first.data(), first.size() * sizeof(float)), 0);

  const Update b = decode_update(packets[2]);
  EXPECT_EQ(b.name, "render");
  EXPECT_THAT((std::vector{b.x, b.y, b.width, b.height}), testing::ElementsAre(0, 1, 4, 2));
  EXPECT_THAT(b.offsets, testing::ElementsAre(0, 8, 16));
  EXPECT_THAT(b.strides, testing::ElementsAre(1, 1, 1));
  EXPECT_EQ(b.values, second);

  Decoder close = open(packets[3], 2);
  EXPECT_EQ(close.text(), "render");
  EXPECT_EQ(close.left(), 0u);
}

TEST(TevClient, EveryByteArrives) {
  FakeTev tev;
  ASSERT_NE(tev.listener().port, 0);
  stream_an_image(tev, tev.listener().host());
}

TEST(TevClient, AServerMayReadAFewBytesAtATime) {
  FakeTev tev(3);
  ASSERT_NE(tev.listener().port, 0);
  stream_an_image(tev, fmt::format("localhost:{}", tev.listener().port));
}

TEST(TevClient, SpeaksIpv6) {
  FakeTev tev(4096, AF_INET6);
  if (tev.listener().port == 0) GTEST_SKIP() << "no IPv6 here";
  stream_an_image(tev, fmt::format("[::1]:{}", tev.listener().port));
}

TEST(TevClient, APacketLargerThanAnyBufferArrivesWhole) {
  constexpr int kSide = 1024;
  FakeTev tev;
  ASSERT_NE(tev.listener().port, 0);
  std::vector<float> values(std::size_t{kSide} * kSide * 3);  // 12 MiB
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(i * 2654435761u % 16777213);
  {
    TevClient client = or_throw(TevClient::connect(tev.listener().host()));
    or_throw(client.update_tile("large", 0, 0, kSide, kSide, kRgb, values));
  }
  const auto packets = tev.packets();
  ASSERT_EQ(packets.size(), 1u);
  // The values are the packet's end; decoding each of so many by itself would say no more.
  ASSERT_GT(packets[0].size(), values.size() * 4);
  EXPECT_EQ(std::memcmp(packets[0].data() + packets[0].size() - values.size() * 4, values.data(),
                        values.size() * 4),
            0);
}

TEST(TevClient, WhatCannotBeEncodedLeavesTheConnectionAsItIs) {
  FakeTev tev;
  ASSERT_NE(tev.listener().port, 0);
  {
    TevClient client = or_throw(TevClient::connect(tev.listener().host()));
    const float value = 1;
    EXPECT_FALSE(client.update_tile("i", 0, 0, 1, 1, kRgb, {&value, 1}).has_value());
    EXPECT_FALSE(client.create_image("i", -1, 1, kRgb).has_value());
    EXPECT_TRUE(client.connected());
    or_throw(client.close_image("i"));
  }
  EXPECT_EQ(tev.packets().size(), 1u);
}

/// The error of the first of many tiles that does not arrive.
std::string error_of_many_tiles(TevClient& client) {
  const std::vector<float> values(std::size_t{256} * 256 * 3, 1.0f);
  for (int tile = 0; tile < 1000; ++tile) {
    const auto sent = client.update_tile("i", 0, 0, 256, 256, kRgb, values);
    if (!sent) return sent.error().message;
  }
  return "";
}

TEST(TevClient, ClosingInTheMiddleIsAnErrorAndNoSignal) {
  struct sigaction action {};
  ASSERT_EQ(sigaction(SIGPIPE, nullptr, &action), 0);
  ASSERT_EQ(action.sa_handler, SIG_DFL) << "a signal would not be noticed";
  const std::vector<float> values(std::size_t{2048} * 2048 * 3, 1.0f);  // 48 MiB, more than buffers hold
  // The end of the other side's bytes first makes the reset after it a broken pipe.
  for (const bool ends_first : {false, true}) {
    const Listener listener;
    ASSERT_NE(listener.port, 0);
    const int small = 4096;
    ASSERT_EQ(::setsockopt(listener.socket, SOL_SOCKET, SO_RCVBUF, &small, sizeof small), 0);
    TevClient client = or_throw(TevClient::connect(listener.host()));
    std::thread server([&] {
      Descriptor connection(listener.accept());
      char some[1000];
      (void)!::recv(connection, some, sizeof some, MSG_WAITALL);
      if (ends_first) ::shutdown(connection, SHUT_WR);
      connection.reset();  // with bytes that are not read: a reset
    });
    const auto sent = client.update_tile("i", 0, 0, 2048, 2048, kRgb, values);
    server.join();
    ASSERT_FALSE(sent.has_value());
    EXPECT_THAT(sent.error().message,
                HasSubstr("the connection to tev at " + listener.host() + " is lost: "));
    EXPECT_FALSE(client.connected());
    const auto again = client.close_image("i");
    ASSERT_FALSE(again.has_value());
    EXPECT_THAT(again.error().message, HasSubstr(listener.host() + " is closed"));
  }
}

TEST(TevClient, TheFirstPacketAfterTevHasClosedIsAnErrorAlready) {
  const Listener listener;
  ASSERT_NE(listener.port, 0);
  TevClient client = or_throw(TevClient::connect(listener.host()));
  or_throw(client.create_image("i", 1, 1, kRgb));
  {
    Descriptor connection(listener.accept());
    char packet[64];
    ASSERT_GT(::recv(connection, packet, sizeof packet, 0),
              0);  // unread bytes would turn closing into a reset
    ASSERT_EQ(::shutdown(connection, SHUT_WR), 0);
    // The loopback device delivers before shutdown returns.
    const auto sent = client.close_image("i");
    ASSERT_FALSE(sent.has_value());
    EXPECT_THAT(sent.error().message, HasSubstr("tev has closed it"));
  }
}

TEST(TevClient, AServerThatStopsReadingIsAnErrorAfterTheTimeout) {
  const Listener listener;
  ASSERT_NE(listener.port, 0);
  TevClient client = or_throw(TevClient::connect(listener.host(), kShort));
  const Descriptor connection(listener.accept());
  const auto begin = steady_clock::now();
  const std::string error = error_of_many_tiles(client);
  const auto taken = steady_clock::now() - begin;
  EXPECT_THAT(error,
              HasSubstr(fmt::format("the connection to tev at {} is lost: tev has taken nothing for 0.25 s",
                                    listener.host())));
  EXPECT_GE(taken, kShort);
  EXPECT_LT(taken, kSoon);
  EXPECT_FALSE(client.connected());
}

TEST(TevClient, BytesFromTevAreIgnored) {
  const Listener listener;
  ASSERT_NE(listener.port, 0);
  TevClient client = or_throw(TevClient::connect(listener.host()));
  const Descriptor connection(listener.accept());
  const std::vector<char> noise(10000, 'x');
  ASSERT_EQ(::send(connection, noise.data(), noise.size(), MSG_NOSIGNAL), ssize_t(noise.size()));
  or_throw(client.close_image("img"));
  std::uint8_t packet[9];
  ASSERT_EQ(::recv(connection, packet, sizeof packet, MSG_WAITALL), 9);
  EXPECT_EQ(int(packet[4]), 2);
  // Nor do they hide that it closes.
  ASSERT_EQ(::send(connection, noise.data(), noise.size(), MSG_NOSIGNAL), ssize_t(noise.size()));
  ASSERT_EQ(::shutdown(connection, SHUT_WR), 0);
  EXPECT_FALSE(client.close_image("img").has_value());
}

TEST(TevClient, NoListener) {
  const Listener bound(AF_INET, -1);  // the port is taken, so no other process can listen there meanwhile
  ASSERT_NE(bound.port, 0);
  const auto client = TevClient::connect(bound.host());
  ASSERT_FALSE(client.has_value());
  EXPECT_THAT(client.error().message, HasSubstr("no connection to tev at " + bound.host() + ": "));
  EXPECT_THAT(client.error().message, HasSubstr("is it running?"));
}

TEST(TevClient, AHostThatDoesNotAnswerIsAnErrorAfterTheTimeout) {
  // A full queue of connections drops what else comes, like a host that is off.
  const Listener listener(AF_INET, 0);
  ASSERT_NE(listener.port, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(listener.port);
  std::vector<std::unique_ptr<Descriptor>> waiting;
  for (int i = 0; i < 8; ++i) {
    waiting.push_back(std::make_unique<Descriptor>(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0)));
    (void)::connect(*waiting.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }
  const auto begin = steady_clock::now();
  const auto client = TevClient::connect(listener.host(), kShort);
  const auto taken = steady_clock::now() - begin;
  ASSERT_FALSE(client.has_value());
  EXPECT_EQ(client.error().message, "no connection to tev at " + listener.host() + ": no answer in 0.25 s");
  EXPECT_GE(taken, kShort);
  EXPECT_LT(taken, kSoon);
}

TEST(TevClient, AHostThatCannotExist) {
  const std::string host(70, 'x');  // a name's part has 63 letters at most: no name service is asked
  const auto client = TevClient::connect(host + ":14158");
  ASSERT_FALSE(client.has_value());
  EXPECT_THAT(client.error().message, HasSubstr("no connection to tev at " + host + ":14158: "));
}

TEST(TevClient, ANameServiceThatDoesNotAnswerIsGivenUp) {
  const SilentNameService silence;
  const auto client = TevClient::connect(kSilentHost, kShort);
  ASSERT_FALSE(client);
  EXPECT_THAT(client.error().message, HasSubstr("the name service does not answer"));
}

TEST(TevClient, AStopDoesNotWaitForTheNameService) {
  const SilentNameService silence;
  std::jthread asking([](const std::stop_token& stop) {
    EXPECT_FALSE(TevClient::connect(kSilentHost, std::chrono::hours(1), stop));
  });
  std::this_thread::sleep_for(kShort);
}

}  // namespace
}  // namespace penumbra
