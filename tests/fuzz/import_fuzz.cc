// Readers of recordings by others. The first byte chooses the format; files
// of one recording are separated by the byte 0xFF.
#include "logs/import/brenner_lego_robot4.h"
#include "logs/import/censi_joint_calibration.h"
#include "logs/import/import_formats.h"
#include "logs/import/lcm_maebot_logs.h"
#include "logs/import/optiodom_diffdrive.h"
#include "logs/import/tuc_labyrinth_diffdrive.h"
#include "logs/import/write_imported_log.h"
#include "tests/fuzz/fuzz_target.h"

#include <cmath>

namespace waymark::fuzz {
namespace {

// What was read can be written, and reads back whole.
void CheckLog(const Recording& recording) {
  const std::string path = ScratchFolder() + "/imported.log";
  for (const auto use : {ReferenceUse::kRunning, ReferenceUse::kCalibration}) {
    ReferenceSplitOptions options;
    options.use = use;
    const ImportSummary summary =
        WriteImportedLog(recording, options, path, IfExists::kReplace);
    LogReader reader(path);
    while (reader.Next()) {
    }
    Expect(reader.report().is_sound(), "a sound log");
    Expect(reader.report().num_events == summary.num_events, "all events");
  }
}

void CheckRecording(const Recording& recording) {
  Time before{};
  bool first = true;
  for (const EncoderReading& reading : recording.encoders) {
    Expect(first || reading.time > before, "encoder times increase");
    before = reading.time;
    first = false;
  }
  for (const RelativeMotion& motion : recording.motions) {
    Expect(motion.from < motion.time, "a motion takes time");
  }
  Expect(recording.reference.sigma.allFinite(), "finite");
  (void)PathLength(recording.reference);
  (void)WheelPathLength(recording);
  CheckLog(recording);
}

void Brenner(const std::vector<Bytes>& files) {
  WriteScratch("robot4_motors.txt", files[0]);
  WriteScratch("robot4_reference.txt", files[1]);
  if (files[2].empty()) {
    RemoveScratch("robot4_scan.txt");
  } else {
    WriteScratch("robot4_scan.txt", files[2]);
  }
  TakesOrRefuses(
      [] { CheckRecording(ReadBrennerLegoRobot4(ScratchFolder())); });
}

void Optiodom(const std::vector<Bytes>& files) {
  const std::string run = WriteScratch("square_run-01.csv", files[0]);
  if (files[1].empty()) {
    RemoveScratch("square_metadata.csv");
  } else {
    WriteScratch("square_metadata.csv", files[1]);
  }
  TakesOrRefuses([&] { CheckRecording(ReadOptiodomRun(run)); });
}

void Censi(const std::vector<Bytes>& files) {
  const std::string path = WriteScratch("lstraight_0.tuple", files[0]);
  TakesOrRefuses([&] { CheckRecording(ReadCensiTuples(path)); });
}

void CensiResults(const std::vector<Bytes>& files) {
  const MemoryFile file(files[0]);
  TakesOrRefuses([&] {
    const CensiResult result = ReadCensiResult(file.path());
    Expect(result.covariance.allFinite(), "finite");
  });
}

void Tuc(const std::vector<Bytes>& files) {
  WriteScratch("run_Input.txt", files[0]);
  WriteScratch("run_GT.txt", files[1]);
  TakesOrRefuses([] { CheckRecording(ReadTucLabyrinth(ScratchFolder())); });
}

void Maebot(Bytes log) {
  const MemoryFile file(log);
  TakesOrRefuses([&] { CheckRecording(ReadMaebotLog(file.path())); });
}

// A log of two events: encoders, then the given message.
std::string MaebotLog(const std::string& message) {
  const auto number = [](std::uint64_t value, int num_bytes) {
    std::string bytes;
    for (int i = num_bytes - 1; i >= 0; --i) {
      bytes += static_cast<char>(value >> (8 * i) & 0xff);
    }
    return bytes;
  };
  const std::string encoders = number(0x7d090bfb221d74f9, 8) +
                               number(1'447'367'745'684'375, 8) +
                               number(344092, 4) + number(475427, 4);
  std::string log;
  std::uint64_t count = 0;
  for (const std::string& data : {encoders, message}) {
    log += number(0xEDA1DA01, 4) + number(count, 8) +
           number(1'477'530'571'543'258 + 20'000 * count, 8) + number(1, 4) +
           number(data.size(), 4) + "E" + data;
    ++count;
  }
  return log;
}

}  // namespace

void RunOne(Bytes data) {
  if (data.empty()) return;
  const std::vector<Bytes> files = Split(data.subspan(1), 3);
  const std::string any = WriteScratch("any", files[0]);
  TakesOrRefuses([&] { (void)DetectImportFormat(any); });
  switch (data[0] % 6) {
    case 0:
      return Brenner(files);
    case 1:
      return Optiodom(files);
    case 2:
      return Censi(files);
    case 3:
      return CensiResults(files);
    case 4:
      return Tuc(files);
    default:
      return Maebot(data.subspan(1));
  }
}

std::vector<std::string> Seeds() {
  const std::string motors =
      "M 204 20795 20795 3000 0 16067 16066 3000 0 0 0 6000 0\n"
      "M 524 20800 20794 3000 0 16070 16066 3000 0 0 0 6000 0\n"
      "M 735 20810 20795 3000 0 16081 16066 3000 0 0 0 6000 0\n";
  const std::string reference = "P 315 1000 2000\nP 540 1010 2000\n";
  std::string scan = "S 315 660";
  for (int i = 0; i < 660; ++i) scan += " " + std::to_string(100 + i);
  const std::string run =
      "0.00,0.0,0.0,0.0,0,0\n0.05,0.01,0.0,0.0,10,-9\n"
      "0.10,0.02,0.0,0.01,11,-10\n";
  const std::string metadata =
      "type,diff\nngear,43.7\nencRes,64\nLi,0.2\nDi,0.084,0.084\n";
  const std::string tuples =
      "{\"T\": 0.2, \"phi_l\": 1.5, \"phi_r\": 1.4, \"sm\": [0.01, 0, 1e-3]}\n"
      "{\"T\": 0.2, \"phi_l\": -1, \"phi_r\": 1, \"sm\": [0, 0, 0.1]}\n";
  std::string result =
      "{\"l_diam\": 0.04, \"r_diam\": 0.04, \"axle\": 0.09, \"l_x\": 0, "
      "\"l_y\": 0, \"l_theta\": 0.1, \"covariance\": [";
  for (int i = 0; i < 6; ++i) {
    result += i == 0 ? "[1,0,0,0,0,0]" : ",[0,0,1,0,0,0]";
  }
  result += "]}";
  const std::string input =
      "range2 0.1 2.9 0.01 -0.02 -0.01 105 0\n"
      "odom2diff 0.1 0 0 0 0.0785 0.0001 0.0001 0.0001\n"
      "odom2diff 0.2 0.3 0.2 0 0.0785 0.0001 0.0001 0.0001\n";
  const std::string points =
      "point2 0.1 1.65 2.2 0 0 0 0\npoint2 0.2 1.66 2.2 0 0 0 0\n";
  const std::string pose =
      std::string("\x1f\x31\x7a\xf1\x24\x62\x76\xac") +
      std::string("\0\x05\x24\x60\x20\x60\x20\x60", 8) +
      std::string("\x3f\x80\0\0\x3f\x80\0\0\x3f\0\0\0", 12);
  const std::string laser =
      std::string("\x89\xdc\x5b\x87\x9a\x50\x56\xcf") +
      std::string("\0\x05\x24\x60\x20\x60\x20\x60\0\0\0\x02", 12) +
      std::string(40, '\x3f');
  return {std::string(1, '\0') + motors + "\xff" + reference + "\xff" + scan,
          std::string(1, '\0') + motors + "\xff" + reference,
          "\x01" + run,
          "\x01" + run + "\xff" + metadata,
          "\x02" + tuples,
          "\x03" + result,
          "\x04" + input + "\xff" + points,
          "\x05" + MaebotLog(pose),
          "\x05" + MaebotLog(laser)};
}

}  // namespace waymark::fuzz
