// Images: messages of others, files of a folder, and their times.
#include "drivers/video/image_sequence.h"
#include "processes/convert/image_convert.h"
#include "processes/support/decode.h"
#include "tests/fuzz/fuzz_target.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace waymark::fuzz {
namespace {

void CheckMessage(const image_t& message) {
  std::string reason;
  for (const ImageColor color :
       {ImageColor::kAsSent, ImageColor::kGray, ImageColor::kBgr}) {
    const auto image = ImageFromMessage(message, color, &reason);
    Expect(image || !reason.empty(), "a refusal says why");
    if (!image) continue;
    Expect(image->cols == message.width && image->rows == message.height,
           "an image has the size that its message states");
    Expect(image->depth() == CV_8U, "of 8 bits");
    Expect(color != ImageColor::kGray || image->channels() == 1, "gray");
    Expect(color != ImageColor::kBgr || image->channels() == 3, "colour");
  }
  reason.clear();
  Expect(TagsFromMessage(message, &reason) || !reason.empty(),
         "a refusal of tags says why");
}

// The same bytes as the JPEG of a message that is sound otherwise: fuzzers do
// not find their way through a checksum of lengths.
void CheckJpeg(Bytes data) {
  image_t message;
  message.utime = 1;
  message.width = 16;
  message.height = 8;
  message.pixelformat = image_t::PIXEL_FORMAT_MJPEG;
  message.data.assign(data.begin(), data.end());
  message.size = static_cast<std::int32_t>(data.size());
  CheckMessage(message);
}

void CheckFolder(Bytes image, Bytes times) {
  const std::string path = WriteScratch("image.png", image);
  const std::string times_path = WriteScratch("times.txt", times);
  TakesOrRefuses([&] {
    ImageSequence sequence(ScratchFolder() + "/*.png", times_path, 0.0);
    std::optional<Duration> last;
    while (const auto time = sequence.NextTime()) {
      Expect(!last || *time >= *last, "times increase");
      last = time;
      std::string error;
      const auto read = sequence.Read(&error);
      Expect(read || error.find('\n') == std::string::npos, "one line");
      Expect(!read || !read->empty(), "an image has pixels");
    }
  });
  RemoveScratch("times.txt");
  RemoveScratch("image.png");
}

image_t Sample(ImageFormat format) {
  ImageEncoderOptions options;
  options.format = format;
  std::string reason;
  const cv::Mat image(8, 16, CV_8UC3, cv::Scalar(10, 100, 200));
  return *ImageEncoder(options).Encode(
      image, {TimeFromMicroseconds(7), 3, HeadAngles{0.1, 0.2}}, &reason);
}

std::string Encoded(const image_t& message) {
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace

void RunOne(Bytes data) {
  if (const auto message = DecodeMessage<image_t>(data)) CheckMessage(*message);
  CheckJpeg(data);
  // A file has bytes of any value, its times are text: the last line.
  std::size_t split = data.size();
  while (split > 0 && data[split - 1] != 0xFE) --split;
  CheckFolder(data.first(split), data.subspan(split));
}

std::vector<std::string> Seeds() {
  const image_t jpeg = Sample(ImageFormat::kJpeg);
  std::vector<std::string> seeds{Encoded(jpeg),
                                 Encoded(Sample(ImageFormat::kRaw)),
                                 {jpeg.data.begin(), jpeg.data.end()}};
  std::vector<std::uint8_t> png;
  cv::imencode(".png", cv::Mat(8, 16, CV_8UC1, cv::Scalar(9)), png);
  seeds.push_back(std::string(png.begin(), png.end()) +
                  "\xFE"
                  "1.5 image.png");
  seeds.push_back(
      "\xFE"
      "# time\n1700000000.25\n");
  return seeds;
}

}  // namespace waymark::fuzz
