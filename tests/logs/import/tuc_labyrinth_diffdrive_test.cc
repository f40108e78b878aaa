#include "logs/import/tuc_labyrinth_diffdrive.h"

#include "tests/logs/import/import_test_tools.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

using testing::Contains;
using testing::EndsWith;
using testing::HasSubstr;

// Velocities of the left and right wheel, in that order, and half the base.
std::string OdometryLine(double seconds, double left, double right) {
  return Format("odom2diff %.15g %.17g %.17g 0 0.0785 0.0001 0.0001 0.0001\n",
                seconds,
                left,
                right);
}

std::string PointLine(double seconds, double x, double y) {
  return Format("point2 %.15g %.15g %.15g 0 0 0 0 \n", seconds, x, y);
}

class TucTest : public testing::Test {
 protected:
  void Write(const std::string& input, const std::string& reference) {
    WriteText(folder_ / "run_Input.txt", input);
    WriteText(folder_ / "run_GT.txt", reference);
  }
  std::string Error() {
    return InputErrorOf([&] { (void)ReadTucLabyrinth(folder_ / ""); });
  }
  TemporaryDirectory folder_;
};

TEST_F(TucTest, DriveComesBack) {
  const WheelParameters wheels{1e-5, 1e-5, 0.157};
  const auto drive = NoiselessDrive(wheels, 8.0, 60.0);
  std::string input;
  std::string reference;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    const SimulatedReading& now = drive[i];
    const SimulatedReading& before = drive[i == 0 ? 0 : i - 1];
    const double seconds = Seconds(now.time - drive[0].time) + 0.1;
    const double step = i == 0 ? 1.0 : Seconds(now.time - before.time);
    input += "range2 0 1 0.01 0 0 105 0 \n";
    input += OdometryLine(seconds,
                          (now.left_ticks - before.left_ticks) * 1e-5 / step,
                          (now.right_ticks - before.right_ticks) * 1e-5 / step);
    reference += PointLine(seconds, now.X_WR.x, now.X_WR.y);
  }
  Write(input, reference);
  const Recording recording = ReadTucLabyrinth(folder_ / "");
  ASSERT_EQ(recording.encoders.size(), drive.size());
  EXPECT_EQ(Microseconds(recording.encoders[0].time), 1'000'100'000);
  EXPECT_TRUE(recording.has_virtual_ticks);
  EXPECT_FALSE(recording.start);
  EXPECT_DOUBLE_EQ(recording.nominal.parameters.wheel_base, 0.157);
  EXPECT_THAT(recording.notes, Contains(HasSubstr("481 ranges")));
  // Virtual ticks are 1 um: after 500 turns that are wrong by up to 1 um / 157
  // mm at random, metres of path are wrong by some 10 um. Swapped wheels would
  // be off by metres.
  EXPECT_LT(DeadReckoningRmse(recording,
                              recording.nominal.parameters,
                              recording.encoders[0].time,
                              drive[0].X_WR),
            1e-4);
}

TEST_F(TucTest, BadInputNamesFileAndLine) {
  const std::string odometry = OdometryLine(0.1, 0.2, 0.3);
  const std::string point = PointLine(0.1, 1.0, 2.0);
  EXPECT_THAT(Error(), EndsWith("0 files *_Input.txt, 1 needed"));
  Write(odometry + "odom3 1\n", point);
  EXPECT_THAT(Error(),
              EndsWith("run_Input.txt:2: column 1: \"odom2diff\" or "
                       "\"range2\" needed"));
  Write(odometry + "odom2diff 0.2 1 1\n", point);
  EXPECT_THAT(Error(), EndsWith("run_Input.txt:2: 4 columns, 9 needed"));
  Write(odometry + odometry, point);
  EXPECT_THAT(Error(), EndsWith(":2: column 2: time does not increase"));
  Write("odom2diff 0.1 nan 0 0 0.0785 1 1 1\n", point);
  EXPECT_THAT(Error(), EndsWith(":1: column 3: \"nan\" is not finite"));
  Write("odom2diff 0.1 1e9 0 0 0.0785 1 1 1\n", point);
  EXPECT_THAT(Error(), EndsWith(":1: column 3: is beyond 100 m/s"));
  Write("odom2diff 0.1 1 0 0 -1 1 1 1\n", point);
  EXPECT_THAT(Error(), HasSubstr(":1: column 6: the wheels' distance"));
  Write(odometry + "odom2diff 0.2 1 0 0 0.08 1 1 1\n", point);
  EXPECT_THAT(Error(), HasSubstr(":2: column 6: the wheels' distance"));
  Write("range2 0 1 0.01 0 0 105 0 \n", point);
  EXPECT_THAT(Error(), EndsWith("run_Input.txt: has no records odom2diff"));
  Write(odometry, point + point);
  EXPECT_THAT(Error(),
              EndsWith("run_GT.txt:2: column 2: time does not increase"));
  Write(odometry, "gt2 1\n");
  EXPECT_THAT(Error(), EndsWith("run_GT.txt:1: column 1: \"point2\" needed"));
  std::filesystem::remove(folder_ / "run_GT.txt");
  EXPECT_THAT(
      Error(),
      EndsWith("run_GT.txt: cannot be opened: No such file or directory"));
}

}  // namespace
}  // namespace waymark
