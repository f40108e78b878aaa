// The one place that builds the URL with which LCM is created, and says what
// is wrong where LCM cannot work with it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace waymark {

// What the kernel is asked to hold for a socket between two reads, bytes. Two
// raw colour images of 640x480 fit (the kernel doubles the number, and counts
// its own overhead); LCM's default loses nearly all raw images.
inline constexpr std::int64_t kReceiveBufferBytes = 2097152;

// `from_flag`, else the environment's LCM_DEFAULT_URL, else LCM's default
// group and port; completed by CompleteLcmUrl.
[[nodiscard]] std::string LcmUrl(std::string_view from_flag);

// Adds to a udpm URL what it leaves open: recv_buf_size=2097152 and ttl=0
// (messages stay on this host). Other providers' URLs are returned unchanged.
// Throws InputError where LCM would refuse or misread the URL: no provider,
// an unknown one, a bad group, port or option.
[[nodiscard]] std::string CompleteLcmUrl(std::string_view url);

// Throws InputError with one line that says how to mend it where the kernel
// has no multicast route for a udpm URL, or no broker answers at a tcpq URL.
void CheckLcmReachable(std::string_view url);

// The receive buffer that a URL asks for, 0 where it is no udpm URL, and the
// URL with another one.
[[nodiscard]] std::int64_t ReceiveBufferOf(std::string_view url);
[[nodiscard]] std::string WithReceiveBuffer(std::string_view url,
                                            std::int64_t num_bytes);

// The URL with a receive buffer that can be had: the kernel doubles what it is
// asked for, and LCM complains in three lines of its own where the result is
// less than it asked for.
[[nodiscard]] std::string WithGrantedBuffer(std::string_view url);

// UDP port of a udpm URL, 0 of any other.
[[nodiscard]] int PortOf(std::string_view url);

// The largest receive buffer that a socket of this process can get
// (net.core.rmem_max), bytes; found by asking for more.
[[nodiscard]] std::int64_t LargestReceiveBuffer();

}  // namespace waymark
