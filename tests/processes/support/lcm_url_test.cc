#include "processes/support/lcm_url.h"

#include "estimation/base/input_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace waymark {
namespace {

using testing::HasSubstr;

std::string ErrorOf(const std::string& url) {
  try {
    return "none: " + CompleteLcmUrl(url);
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(LcmUrl, CompletesWhatUdpmLeavesOpen) {
  EXPECT_EQ(CompleteLcmUrl("udpm://239.255.76.67:7667"),
            "udpm://239.255.76.67:7667?recv_buf_size=2097152&ttl=0");
  EXPECT_EQ(CompleteLcmUrl("udpm://"), "udpm://?recv_buf_size=2097152&ttl=0");
  EXPECT_EQ(CompleteLcmUrl("udpm://239.255.76.67:7667?ttl=1"),
            "udpm://239.255.76.67:7667?ttl=1&recv_buf_size=2097152");
  EXPECT_EQ(CompleteLcmUrl("udpm://:7668?recv_buf_size=1000"),
            "udpm://:7668?recv_buf_size=1000&ttl=0");
  const std::string complete =
      "udpm://239.255.76.67:7667?recv_buf_size=4194304&ttl=1";
  EXPECT_EQ(CompleteLcmUrl(complete), complete);
}

TEST(LcmUrl, LeavesOtherProvidersAlone) {
  for (const char* url : {"memq://",
                          "tcpq://localhost:7700",
                          "file:///tmp/a.lcm?speed=2",
                          "mpudpm://239.255.76.67:7667?ttl=1"}) {
    EXPECT_EQ(CompleteLcmUrl(url), url);
  }
}

TEST(LcmUrl, BadOnesAreOneLine) {
  EXPECT_EQ(ErrorOf("239.255.76.67:7667"),
            "LCM URL 239.255.76.67:7667: must be provider://..., for example "
            "udpm://239.255.76.67:7667");
  EXPECT_EQ(ErrorOf("upd://239.255.76.67:7667"),
            "LCM URL upd://239.255.76.67:7667: unknown provider; known: udpm, "
            "memq, tcpq, file, mpudpm");
  EXPECT_EQ(ErrorOf("udpm://10.0.0.1:7667"),
            "LCM URL udpm://10.0.0.1:7667: the group must be an address in "
            "224.0.0.0/4");
  EXPECT_EQ(ErrorOf("udpm://robot"),
            "LCM URL udpm://robot: the group must be an address in "
            "224.0.0.0/4");
  for (const char* port : {"0", "65536", "-1", "x", "", "7667x"}) {
    const std::string url = std::string("udpm://239.255.76.67:") + port;
    EXPECT_EQ(ErrorOf(url),
              "LCM URL " + url + ": the port must be a number in [1, 65535]");
  }
  EXPECT_EQ(ErrorOf("udpm://?ttl=256"),
            "LCM URL udpm://?ttl=256: ttl must be a number in [0, 255]");
  EXPECT_EQ(ErrorOf("udpm://?ttl"),
            "LCM URL udpm://?ttl: ttl must be a number in [0, 255]");
  EXPECT_EQ(ErrorOf("udpm://?recv_buf_size=2M"),
            "LCM URL udpm://?recv_buf_size=2M: recv_buf_size must be a number "
            "in [1, 2147483647]");
  EXPECT_EQ(ErrorOf("udpm://?recv_buf_size=0"),
            "LCM URL udpm://?recv_buf_size=0: recv_buf_size must be a number "
            "in [1, 2147483647]");
  EXPECT_EQ(ErrorOf("udpm://?ttl=0&ttl=1"),
            "LCM URL udpm://?ttl=0&ttl=1: ttl stands there twice");
  EXPECT_EQ(ErrorOf("udpm://?transmit_only=a?ttl=0"),
            "LCM URL udpm://?transmit_only=a?ttl=0: transmit_only holds a "
            "second '?'");
  EXPECT_EQ(ErrorOf("udpm://?recv_buffer=1"),
            "LCM URL udpm://?recv_buffer=1: unknown option recv_buffer; "
            "known: ttl, recv_buf_size");
}

TEST(LcmUrl, FlagThenEnvironmentThenDefault) {
  ::setenv("LCM_DEFAULT_URL", "udpm://239.255.76.67:7668?ttl=1", 1);
  EXPECT_EQ(LcmUrl("memq://"), "memq://");
  EXPECT_EQ(LcmUrl(""),
            "udpm://239.255.76.67:7668?ttl=1&recv_buf_size=2097152");
  ::setenv("LCM_DEFAULT_URL", "", 1);
  EXPECT_EQ(LcmUrl(""),
            "udpm://239.255.76.67:7667?recv_buf_size=2097152&ttl=0");
  ::unsetenv("LCM_DEFAULT_URL");
  EXPECT_EQ(LcmUrl(""),
            "udpm://239.255.76.67:7667?recv_buf_size=2097152&ttl=0");
}

TEST(LcmUrl, PartsOfIt) {
  const std::string url = CompleteLcmUrl("udpm://:7668");
  EXPECT_EQ(PortOf(url), 7668);
  EXPECT_EQ(PortOf("udpm://"), 7667);
  EXPECT_EQ(PortOf("memq://"), 0);
  EXPECT_EQ(ReceiveBufferOf(url), 2097152);
  EXPECT_EQ(ReceiveBufferOf("memq://"), 0);
  EXPECT_EQ(WithReceiveBuffer(url, 5), "udpm://:7668?recv_buf_size=5&ttl=0");
  EXPECT_GT(LargestReceiveBuffer(), 0);
  // What can be had is asked for as it is, more never.
  EXPECT_EQ(WithGrantedBuffer("udpm://:7668?recv_buf_size=4096"),
            "udpm://:7668?recv_buf_size=4096");
  EXPECT_LE(ReceiveBufferOf(
                WithGrantedBuffer("udpm://:7668?recv_buf_size=1000000000000")),
            2 * LargestReceiveBuffer());
}

TEST(LcmUrl, NoBrokerIsOneLineThatSaysHowToStartOne) {
  // Nobody listens on port 1.
  try {
    CheckLcmReachable("tcpq://127.0.0.1:1");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no broker answers"));
    EXPECT_THAT(error.what(), HasSubstr("lcm.lcm.TCPService 1"));
  }
  CheckLcmReachable("memq://");
}

}  // namespace
}  // namespace waymark
