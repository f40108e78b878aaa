// A serial port as raw bytes that never block.
#pragma once

#include "drivers/wheels/create_protocol.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace waymark {

// Eight data bits, no parity, one stop bit, no flow control. The device is
// this process's alone while it is open. Where anything fails, also because
// the cable was pulled, the port closes itself and error() says in one line
// which device, what, and why.
class SerialPort {
 public:
  // Throws std::invalid_argument where no port has that speed.
  SerialPort(std::string device, int baud);
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  // Opens it anew and drops what had arrived. False: error() says why.
  bool Open();
  void Close();

  // What has arrived, at most 4096 bytes; nullopt where the port is closed, or
  // closes now because the device is gone.
  [[nodiscard]] std::optional<Bytes> Read();
  // Hands the bytes to the system. Where it has no room, none or part of them
  // is taken: the rest of a command begun goes out first next time, and until
  // then what comes is dropped. False: the port is closed.
  bool Write(std::span<const std::uint8_t> bytes);

  [[nodiscard]] bool is_open() const { return fd_ >= 0; }
  [[nodiscard]] int fd() const { return fd_; }
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  // Closes, and sets error() from errno; false.
  bool Fail(const char* what);
  [[nodiscard]] bool Configure();
  // Of `bytes`, how many were taken; nullopt: the port is closed.
  [[nodiscard]] std::optional<std::size_t> WriteSome(
      std::span<const std::uint8_t> bytes);

  std::string device_;
  unsigned speed_;
  int fd_ = -1;
  Bytes unsent_;
  std::string error_;
};

}  // namespace waymark
