#include "drivers/video/video_file.h"

#include "estimation/base/input_error.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/test_video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

std::string ErrorOf(const std::string& path) {
  try {
    const VideoFile video(path, 0.0);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(VideoFile, GivesEveryFrameAtItsTimeAndAgain) {
  const TemporaryDirectory directory;
  const std::string path = directory / "a.avi";
  WriteNumberedVideo(path, 12, 20.0);
  VideoFile video(path, 0.0);
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < 12; ++i) {
      ASSERT_EQ(video.NextTime(), Duration(i * 50'000));
      EXPECT_EQ(video.NextTime(), Duration(i * 50'000));
      std::string error;
      const auto image = video.Read(&error);
      ASSERT_TRUE(image) << error;
      EXPECT_EQ(NumberOf(*image), i);
    }
    EXPECT_FALSE(video.NextTime());
    video.Rewind();
  }
}

TEST(VideoFile, AnotherRateReplacesItsOwn) {
  const TemporaryDirectory directory;
  WriteNumberedVideo(directory / "a.avi", 3, 20.0);
  VideoFile video(directory / "a.avi", 5.0);
  std::string error;
  (void)video.Read(&error);
  EXPECT_EQ(video.NextTime(), Duration(200'000));
}

TEST(VideoFile, WhatIsNoVideoIsOneLine) {
  const TemporaryDirectory directory;
  EXPECT_THAT(ErrorOf(directory / "none.avi"),
              HasSubstr("none.avi: no such folder, pattern or video file"));
  for (const std::string& text :
       {std::string(), std::string("hello"), std::string(5000, 'x')}) {
    WriteBytes(
        directory / "text.avi",
        {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    EXPECT_THAT(ErrorOf(directory / "text.avi"),
                HasSubstr("text.avi: is no video that can be decoded"));
  }
}

TEST(VideoFile, CutShortItEndsEarly) {
  const TemporaryDirectory directory;
  WriteNumberedVideo(directory / "a.avi", 12, 20.0);
  std::vector<std::uint8_t> bytes = ReadBytes(directory / "a.avi");
  bytes.resize(bytes.size() / 2);
  WriteBytes(directory / "b.avi", bytes);
  int num = 0;
  try {
    VideoFile video(directory / "b.avi", 20.0);
    std::string error;
    while (video.NextTime()) num += video.Read(&error) ? 1 : 0;
  } catch (const InputError&) {
    num = 0;
  }
  EXPECT_LT(num, 12);
}

}  // namespace
}  // namespace waymark
