#include "logs/log_tool/picture_export.h"

#include "estimation/base/input_error.h"
#include "processes/convert/image_convert.h"
#include "processes/support/decode.h"
#include "processes/support/log_file.h"
#include "processes/support/progress.h"

#include <waymark/image_t.hpp>

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

namespace waymark {
namespace {

class PictureExporter {
 public:
  PictureExporter(std::string folder, const PictureOptions& options)
      : folder_(std::move(folder)), options_(options) {}

  void Add(const LogEvent& event) {
    if (!options_.channel.empty() && event.channel != options_.channel) return;
    // Whatever the channel is called: the fingerprint says what it is.
    const auto message = DecodeMessage<image_t>(event.data);
    if (!message) return;
    PictureReport::Channel& channel = channels_[event.channel];
    channel.name = event.channel;
    if (num_files_ >= options_.max_files) {
      ++report_.num_left_out;
      return;
    }
    std::string reason;
    const auto file = ImageFileFromMessage(*message, &reason);
    if (!file) {
      if (channel.num_bad++ == 0) channel.reason = reason;
      return;
    }
    if (num_files_ == 0) MakeFolder();
    Write(event.channel, message->utime, *file);
    ++channel.num_files;
    ++num_files_;
  }

  PictureReport Finish(const std::string& log) {
    if (channels_.empty()) {
      throw InputError(log + ": has no images" +
                       (options_.channel.empty() ? std::string()
                                                 : " on " + options_.channel));
    }
    for (auto& [name, channel] : channels_) {
      report_.channels.push_back(std::move(channel));
    }
    return std::move(report_);
  }

 private:
  void MakeFolder() const {
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (!std::filesystem::is_directory(folder_)) {
      throw InputError(folder_ + ": cannot be made a folder: " +
                       (error ? error.message() : "something else is there"));
    }
  }

  void Write(const std::string& channel,
             std::int64_t utime,
             const ImageFile& file) {
    // No folder of a channel's own choice.
    std::string stem = channel + "_" + std::to_string(utime);
    std::replace(stem.begin(), stem.end(), '/', '_');
    const int number = ++num_of_name_[stem + file.extension];
    if (number > 1) stem += "_" + std::to_string(number);
    OutputFile output(
        (std::filesystem::path(folder_) / (stem + file.extension)).string(),
        options_.if_exists);
    output.Write(
        {reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size()});
    output.Close();
  }

  std::string folder_;
  PictureOptions options_;
  PictureReport report_;
  std::map<std::string, PictureReport::Channel> channels_;
  std::map<std::string, int> num_of_name_;
  std::int64_t num_files_ = 0;
};

}  // namespace

PictureReport ExportPictures(const std::string& log,
                             const std::string& folder,
                             const PictureOptions& options) {
  LogReader reader(log);
  Progress progress("exporting " + log, reader.report().num_file_bytes);
  PictureExporter exporter(folder, options);
  while (const auto event = reader.Next()) {
    progress.Show(reader.offset());
    exporter.Add(*event);
  }
  return exporter.Finish(log);
}

}  // namespace waymark
