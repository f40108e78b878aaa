// What corridor trackers of others say, as a measurement, as an answer, and
// drawn into an image.
#include "logs/report/corridor_picture.h"
#include "processes/convert/corridor_convert.h"
#include "processes/support/decode.h"
#include "tests/fuzz/fuzz_target.h"

#include <opencv2/core.hpp>

#include <cmath>

namespace waymark::fuzz {
namespace {

void CheckFix(const corridor_pose_t& message) {
  std::string reason;
  const auto fix = CorridorFixFromMessage(message, &reason);
  Expect(fix || !reason.empty(), "a refusal says why");
  if (!fix) return;
  Expect(fix->value.allFinite() && fix->covariance.allFinite(),
         "a measurement is finite");
}

// Looking ahead, a little down, through no lens and through one.
void Draw(const CorridorAnswer& answer) {
  CorridorScene scene;
  Eigen::Matrix3d ahead;
  ahead << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  scene.X_RC.linear() = ahead;
  scene.X_RC.translation() << 0.1, 0.0, 0.7;
  scene.corridor = answer.corridor;
  const cv::Mat image(24, 32, CV_8UC1, cv::Scalar(90));
  for (const LensDistortion& lens :
       {LensDistortion{}, LensDistortion{-0.3, 0.1}}) {
    scene.camera = PerspectiveCamera(Intrinsics{20.0, 20.0, 15.5, 11.5}, lens);
    const cv::Mat3b drawn = DrawCorridor(image, answer.estimate, scene);
    Expect(drawn.size() == image.size(), "drawn at the image's size");
  }
}

void CheckAnswer(const corridor_pose_t& message) {
  std::string reason;
  const auto answer = CorridorAnswerFromMessage(message, &reason);
  Expect(answer || !reason.empty(), "a refusal says why");
  if (!answer) return;
  const CorridorEstimate& estimate = answer->estimate;
  Expect(estimate.covariance.allFinite(), "errors are finite");
  Expect(estimate.p_regular >= 0.0 && estimate.p_regular <= 1.0,
         "a probability");
  Expect(!estimate.heading || std::isfinite(*estimate.heading), "a heading");
  Expect(!estimate.y || std::isfinite(*estimate.y), "a position");
  Expect(!estimate.vanishing_point || estimate.vanishing_point->allFinite(),
         "a vanishing point");
  Expect(std::isfinite(answer->X_RS.x) && std::isfinite(answer->X_RS.y) &&
             std::isfinite(answer->X_RS.heading),
         "a mounting");
  Draw(*answer);
  const auto again = CorridorAnswerFromMessage(ToMessage(*answer), &reason);
  Expect(again.has_value(), "what was taken is taken again");
  Expect(again->estimate.status == estimate.status &&
             again->estimate.y == estimate.y &&
             again->corridor.has_value() == answer->corridor.has_value(),
         "and says the same");
}

std::string Encoded(const corridor_pose_t& message) {
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

CorridorAnswer Sample() {
  CorridorAnswer answer;
  answer.time = TimeFromMicroseconds(7);
  answer.source = "front";
  answer.X_RS = {0.1, 0.0, 0.02};
  answer.corridor = CorridorGeometry{};
  answer.corridor->width = 2.0;
  answer.corridor->height = 2.5;
  answer.corridor->skirting_height = 0.08;
  answer.corridor->skirting_depth = 0.01;
  CorridorEstimate& estimate = answer.estimate;
  estimate.status = CorridorStatus::kAccepted;
  estimate.y = 0.1;
  estimate.heading = -0.2;
  estimate.covariance << 1e-4, 1e-6, 1e-6, 1e-5;
  estimate.p_regular = 0.99;
  estimate.vanishing_point = Eigen::Vector2d(14.0, 9.0);
  CorridorLine line;
  line.line.a = {2.0, 20.0};
  line.line.b = {12.0, 11.0};
  line.edge = CorridorEdge::kFloorLeft;
  line.is_used = true;
  estimate.lines.push_back(line);
  line.edge = CorridorEdge::kNone;
  line.line.a = {30.0, 2.0};
  estimate.lines.push_back(line);
  return answer;
}

}  // namespace

void RunOne(Bytes data) {
  const auto message = DecodeMessage<corridor_pose_t>(data);
  if (!message) return;
  CheckFix(*message);
  CheckAnswer(*message);
}

std::vector<std::string> Seeds() {
  CorridorAnswer blind;
  blind.time = TimeFromMicroseconds(9);
  blind.estimate.reason = "no lines in the image";
  return {Encoded(ToMessage(Sample())), Encoded(ToMessage(blind))};
}

}  // namespace waymark::fuzz
