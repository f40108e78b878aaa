// LCM URLs from the command line and the environment.
#include "processes/support/lcm_url.h"
#include "tests/fuzz/fuzz_target.h"

namespace waymark::fuzz {

void RunOne(Bytes data) {
  // The environment and the command line hold no zero bytes.
  const std::string_view text = Text(data).substr(0, Text(data).find('\0'));
  TakesOrRefuses([&] {
    const std::string url = CompleteLcmUrl(text);
    Expect(CompleteLcmUrl(url) == url, "completed once is complete: " + url);
    Expect(PortOf(url) >= 0 && PortOf(url) <= 65535, "port in range");
    if (PortOf(url) == 0) return;
    Expect(ReceiveBufferOf(url) > 0, "asks for a buffer: " + url);
    const std::string other = WithReceiveBuffer(url, 12345);
    Expect(ReceiveBufferOf(other) == 12345, "another buffer: " + other);
    Expect(PortOf(other) == PortOf(url), "the same port");
  });
}

std::vector<std::string> Seeds() {
  return {
      "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152",
      "udpm://239.255.76.67:7667",
      "udpm://",
      "udpm://:7668?ttl=1",
      "tcpq://localhost:7700",
      "memq://",
      "file:///tmp/a.lcm?speed=2&mode=r",
      "mpudpm://239.255.76.67:7667?nummc=5",
  };
}

}  // namespace waymark::fuzz
