#include "drivers/video/live_frames.h"

#include "tests/support/test_video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>

namespace waymark {
namespace {

using testing::HasSubstr;

// A camera of which a test turns the crank. Shared by all that are opened.
struct Crank {
  std::atomic<int> num_asked{0};    // Reads that have begun.
  std::atomic<int> num_allowed{0};  // Images that may come.
  std::atomic<int> num_opened{0};
  std::atomic<bool> is_there{true};
  std::atomic<bool> must_end{false};
};

class CrankedCamera final : public CameraDevice {
 public:
  explicit CrankedCamera(Crank* crank) : crank_(crank) {}
  bool Read(cv::Mat* image) override {
    const int number = crank_->num_asked++;
    while (crank_->num_allowed <= number) {
      if (crank_->must_end || !crank_->is_there) {
        --crank_->num_asked;
        return false;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    *image = NumberedImage(number % 30);
    return true;
  }

 private:
  Crank* crank_;
};

struct World {
  World()
      : frames(
            LiveFramesOptions{"/dev/video7", 0.01, 2.0},
            [this](std::string* error) -> std::unique_ptr<CameraDevice> {
              if (!crank.is_there) {
                *error = "/dev/video7: cannot open: No such device";
                return nullptr;
              }
              ++crank.num_opened;
              return std::make_unique<CrankedCamera>(&crank);
            },
            [this] { return TimeFromMicroseconds(clock_us); }) {}
  ~World() { crank.must_end = true; }

  // Lets images come until the camera waits for the next one.
  void Turn(int num) {
    crank.num_allowed += num;
    ASSERT_TRUE(Until([&] { return crank.num_asked > crank.num_allowed; }));
  }
  [[nodiscard]] static bool Until(const std::function<bool()>& done) {
    for (int i = 0; i < 10000; ++i) {
      if (done()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  Crank crank;
  std::atomic<std::int64_t> clock_us{1'000'000};
  LiveFrames frames;
};

const Time kNow = TimeFromMicroseconds(1'000'000);

TEST(LiveFrames, GivesTheNewestOnceWithItsTime) {
  World world;
  EXPECT_FALSE(world.frames.Take(kNow));
  world.clock_us = 1'234'567;
  world.Turn(3);
  world.clock_us = 9'999'999;
  const auto frame = world.frames.Take(kNow);
  ASSERT_TRUE(frame);
  EXPECT_EQ(NumberOf(frame->image), 2);
  EXPECT_EQ(Microseconds(frame->time), 1'234'567);
  EXPECT_EQ(world.frames.num_missed(), 2);
  EXPECT_FALSE(world.frames.Take(kNow));
  EXPECT_EQ(world.frames.Fault(), "");
}

TEST(LiveFrames, LostCameraIsAFaultAndIsOpenedAgain) {
  World world;
  world.Turn(1);
  world.crank.is_there = false;
  ASSERT_TRUE(World::Until([&] {
    return world.frames.Fault().find("cannot open") != std::string::npos;
  }));
  EXPECT_TRUE(world.frames.Take(kNow));  // The last one is still there.
  world.crank.is_there = true;
  world.Turn(1);
  EXPECT_EQ(world.frames.Fault(), "");
  EXPECT_EQ(world.crank.num_opened, 2);
  EXPECT_EQ(NumberOf(world.frames.Take(kNow)->image), 1);
}

TEST(LiveFrames, CameraThatSaysNothingIsAFault) {
  World world;
  EXPECT_FALSE(world.frames.Take(kNow));
  EXPECT_FALSE(world.frames.Take(kNow + Duration(2'000'000)));
  EXPECT_EQ(world.frames.Fault(), "");
  EXPECT_FALSE(world.frames.Take(kNow + Duration(2'000'001)));
  EXPECT_EQ(world.frames.Fault(), "/dev/video7: gives no images");
  world.Turn(1);
  EXPECT_TRUE(world.frames.Take(kNow + Duration(3'000'000)));
  EXPECT_EQ(world.frames.Fault(), "");
}

TEST(LiveFrames, EndsWhileItWaitsToRetry) {
  const LiveFramesOptions options{"/dev/video7", 3600.0, 2.0};
  std::atomic<bool> was_tried{false};
  const LiveFrames frames(
      options,
      [&](std::string* error) -> std::unique_ptr<CameraDevice> {
        *error = "none";
        was_tried = true;
        return nullptr;
      },
      [] { return Time(); });
  ASSERT_TRUE(World::Until([&] { return was_tried.load(); }));
}

}  // namespace
}  // namespace waymark
