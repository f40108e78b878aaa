// Raw images among all other traffic on loopback: nothing is lost where the
// kernel may hold enough; where it may not, the loss is counted and told.
#include "processes/support/channels.h"
#include "processes/support/lcm_bus.h"
#include "processes/support/lcm_url.h"
#include "tests/network/network_test.h"

#include <waymark/encoders_t.hpp>
#include <waymark/image_t.hpp>
#include <waymark/planar_lidar_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/position_fix_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sched.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;
using Steady = std::chrono::steady_clock;

constexpr std::string_view kImage = "IMAGE_FRONT";
constexpr std::string_view kDone = "STREAM_DONE";
constexpr int kImageRate = 30;
constexpr int kTicksPerSecond = 300;          // Of the sender's loop.
constexpr std::int64_t kStockLimit = 212992;  // Debian's net.core.rmem_max.

std::int64_t WallNow() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

image_t Image(int bytes_per_pixel, std::int64_t seq) {
  image_t image;
  image.utime = WallNow();
  image.width = 640;
  image.height = 480;
  image.row_stride = 640 * bytes_per_pixel;
  image.pixelformat = image_t::PIXEL_FORMAT_GRAY;
  if (bytes_per_pixel == 3) image.pixelformat = image_t::PIXEL_FORMAT_RGB;
  image.size = image.row_stride * image.height;
  image.data.assign(static_cast<std::size_t>(image.size),
                    static_cast<std::uint8_t>(seq));
  image.nmetadata = 1;
  image.metadata.resize(1);
  image.metadata[0].key = "seq";
  image.metadata[0].n = 8;
  for (int shift = 56; shift >= 0; shift -= 8) {
    image.metadata[0].value.push_back(static_cast<std::uint8_t>(seq >> shift));
  }
  return image;
}

// All that a robot sends beside its images.
void PublishTheRest(LcmBus* bus, int tick) {
  if (tick % 3 == 0) {  // 100 Hz.
    encoders_t encoders;
    encoders.utime = WallNow();
    encoders.seq = tick / 3;
    bus->Publish(kEncoders, encoders);
    pose_t pose;
    pose.utime = encoders.utime;
    pose.seq = tick / 3;
    bus->Publish(kPose, pose);
  }
  if (tick % 30 == 0) {  // 10 Hz.
    position_fix_t fix;
    fix.utime = WallNow();
    fix.seq = tick / 30;
    bus->Publish(kPositionFix, fix);
    planar_lidar_t ranges;
    ranges.utime = fix.utime;
    ranges.nranges = 1081;
    ranges.ranges.resize(1081);
    bus->Publish(kRanges, ranges);
  }
}

// Whether the receiver may read while an image is being sent.
enum class Reader { kFree, kStarved };

// The sending process: streams until `seconds` have passed. On the receiver's
// only processor and above its priority, a starving sender puts a whole image
// into the receive buffer before anything is read.
void Send(int bytes_per_pixel, int seconds, Reader reader) {
  if (reader == Reader::kStarved) {
    sched_param above{};
    above.sched_priority = 50;  // LcmBus reads at 1.
    if (::sched_setscheduler(0, SCHED_FIFO, &above) != 0) ::_exit(1);
  }
  LcmBus bus("sender", LcmUrl("udpm://"));
  bus.Advertise<image_t>(kImage);
  bus.Advertise<encoders_t>(kEncoders);
  bus.Advertise<pose_t>(kPose);
  bus.Advertise<position_fix_t>(kPositionFix);
  bus.Advertise<planar_lidar_t>(kRanges);
  bus.Advertise<encoders_t>(kDone);
  const auto start = Steady::now();
  std::int64_t num_images = 0;
  for (int tick = 0; tick < seconds * kTicksPerSecond; ++tick) {
    std::this_thread::sleep_until(
        start +
        std::chrono::microseconds(1'000'000LL * tick / kTicksPerSecond));
    if (tick % (kTicksPerSecond / kImageRate) == 0) {
      bus.Publish(kImage, Image(bytes_per_pixel, num_images++));
    }
    PublishTheRest(&bus, tick);
  }
  // Says how many there were, a few times: it may be lost too.
  for (int i = 0; i < 20; ++i) {
    encoders_t done;
    done.utime = WallNow();
    done.seq = i;
    done.left_ticks = num_images;
    bus.Publish(kDone, done);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

struct StreamResult {
  std::int64_t num_sent = 0;
  std::int64_t first = -1;  // Number of the first image that arrived.
  std::int64_t num_received = 0;
  std::int64_t num_unmatched = 0;  // Images whose bytes were not the sent ones.
  std::vector<std::int64_t> ages_us;
  status_t status;
  std::string log;

  [[nodiscard]] std::int64_t num_missing() const {
    return num_sent - first - num_received;
  }
  [[nodiscard]] double AgeMs(double quantile) {
    if (ages_us.empty()) return 0.0;
    std::sort(ages_us.begin(), ages_us.end());
    const auto last = static_cast<double>(ages_us.size() - 1);
    return 1e-3 * static_cast<double>(
                      ages_us[static_cast<std::size_t>(quantile * last)]);
  }
};

StreamResult Stream(int bytes_per_pixel,
                    int seconds,
                    Reader reader = Reader::kFree) {
  std::optional<OneProcessor> shared;
  if (reader == Reader::kStarved) shared.emplace();
  std::ostringstream log;
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(
      "test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log)));
  StreamResult result;
  LcmBus bus("receiver", LcmUrl("udpm://"));
  std::int64_t num_done = -1;
  bus.Subscribe<image_t>(kImage, Keep::All(60), [&](const image_t& m, Time) {
    const std::int64_t seq = SequenceOf(m);
    if (result.first < 0) result.first = seq;
    ++result.num_received;
    result.ages_us.push_back(WallNow() - m.utime);
    const auto value = static_cast<std::uint8_t>(seq);
    if (m.data.front() != value || m.data.back() != value) {
      ++result.num_unmatched;
    }
  });
  const auto ignore = [](const auto&, Time) {};
  bus.Subscribe<encoders_t>(kEncoders, Keep::All(), ignore);
  bus.Subscribe<pose_t>(kPose, Keep::All(), ignore);
  bus.Subscribe<position_fix_t>(kPositionFix, Keep::All(), ignore);
  bus.Subscribe<planar_lidar_t>(kRanges, Keep::Latest(), ignore);
  bus.Subscribe<encoders_t>(kDone, Keep::All(), [&](const auto& m, Time) {
    num_done = m.left_ticks;
  });
  const pid_t sender = ::fork();
  if (sender == 0) {
    Send(bytes_per_pixel, seconds, reader);
    ::_exit(0);
  }
  bus.Start();
  const auto deadline = Steady::now() + std::chrono::seconds(seconds + 20);
  auto next_status = Steady::now();
  while (num_done < 0 && Steady::now() < deadline) {
    if (Steady::now() > next_status) {
      result.status = bus.MakeStatus();
      next_status += std::chrono::seconds(1);
    }
    if (bus.HandleOne()) continue;
    pollfd wait{bus.wake_fd(), POLLIN, 0};
    ::poll(&wait, 1, 100);
  }
  ::waitpid(sender, nullptr, 0);
  result.num_sent = num_done;
  result.status = bus.MakeStatus();
  spdlog::default_logger()->flush();
  result.log = log.str();
  return result;
}

void Print(const std::string& what, StreamResult* result) {
  std::printf(
      "%s: %lld of %lld images after joining at number %lld, %lld messages "
      "lost in numbers, %lld dropped in the mailbox, %lld datagrams dropped by "
      "the kernel; age median %.1f ms, p99 %.1f ms, worst %.1f ms\n",
      what.c_str(),
      static_cast<long long>(result->num_received),
      static_cast<long long>(result->num_sent -
                             std::max<std::int64_t>(result->first, 0)),
      static_cast<long long>(result->first),
      static_cast<long long>(result->status.num_lost),
      static_cast<long long>(result->status.num_dropped),
      static_cast<long long>(result->status.num_datagrams_dropped),
      result->AgeMs(0.5),
      result->AgeMs(0.99),
      result->AgeMs(1.0));
}

int Seconds() {
  return std::getenv("WAYMARK_LONG") != nullptr ? 60 : 10;
}

// Images come every 33 ms, and the stock buffer holds one and a bit: where the
// machine stood still for longer than this, nobody could have read in time.
constexpr std::chrono::milliseconds kBearableStall{20};

class ImageStreamTest : public NetworkTest {
 protected:
  // Nothing is lost; where the machine stood still meanwhile it is tried anew.
  static void ExpectNoLoss(const std::string& what, int bytes_per_pixel) {
    StreamResult result;
    const bool is_measured = OnARunningMachine(
        kBearableStall,
        [&] {
          result = Stream(bytes_per_pixel, Seconds());
          Print(what, &result);
        },
        [&] {
          return result.num_missing() == 0 && result.status.num_lost == 0 &&
                 result.status.num_datagrams_dropped == 0;
        });
    if (!is_measured) return;
    ASSERT_GE(result.first, 0);
    // Joined at once: the receiver subscribed before the sender started.
    EXPECT_LE(result.first, 1);
    EXPECT_EQ(result.num_missing(), 0);
    EXPECT_EQ(result.num_unmatched, 0);
    EXPECT_EQ(result.status.num_lost, 0);
    EXPECT_EQ(result.status.num_bad, 0);
    EXPECT_EQ(result.status.num_datagrams_dropped, 0);
  }
};

TEST_F(ImageStreamTest, GrayWithTheStockLimitLosesNothing) {
  if (!SetReceiveBufferLimit(kStockLimit)) return;
  ExpectNoLoss("gray 640x480 at 30 Hz, rmem_max 212992", 1);
}

TEST_F(ImageStreamTest, ColourWithFourMebibytesLosesNothing) {
  if (!SetReceiveBufferLimit(4194304)) return;
  ExpectNoLoss("colour 640x480 at 30 Hz, rmem_max 4194304", 3);
}

TEST_F(ImageStreamTest, TooSmallBufferIsCountedAndSaysWhatToSet) {
  if (!SetReceiveBufferLimit(kStockLimit)) return;
  StreamResult result = Stream(3, 4, Reader::kStarved);
  Print("colour 640x480 at 30 Hz, no reading while it is sent, rmem_max 212992",
        &result);
  EXPECT_LT(result.num_received, result.num_sent);
  EXPECT_GT(result.status.num_datagrams_dropped, 0);
  EXPECT_THAT(result.log,
              HasSubstr("the receive buffer is too small (416 of 4096 KiB): "
                        "sudo sysctl -w net.core.rmem_max=2097152"));
  EXPECT_EQ(result.status.num_bad, 0);
}

}  // namespace
}  // namespace waymark
