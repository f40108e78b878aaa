// What a fuzz target defines, and helpers for those that read files.
//
// The same source is built twice: by clang with libFuzzer (preset asan,
// run.sh), and by the ordinary compiler with corpus_main.cc, which runs the
// seeds and thousands of fixed mutations of them in CTest.
#pragma once

#include "estimation/base/input_error.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace waymark::fuzz {

using Bytes = std::span<const std::uint8_t>;

// Runs the decoder once. Anything may come in. A wrong answer is reported by
// Expect(), a memory error by the sanitizers, an exception by leaving.
void RunOne(Bytes data);

// Some valid inputs, and whatever else is a good start.
std::vector<std::string> Seeds();

// Ends the program with `what` where a property does not hold.
void Expect(bool condition, std::string_view what);

// Runs `decode`, which may refuse its input by InputError with a message of
// one line. Returns whether it took it.
bool TakesOrRefuses(const std::function<void()>& decode);

std::string_view Text(Bytes data);
Bytes AsBytes(std::string_view text);

// At most `max_parts` parts, separated by the byte 0xFF (which is in no UTF-8
// text); always that many, the missing ones empty.
std::vector<Bytes> Split(Bytes data, std::size_t max_parts);

// A message as LCM sends it: its fingerprint (big endian), then `body`.
std::vector<std::uint8_t> WithFingerprint(std::uint64_t fingerprint,
                                          Bytes body);

// A file in memory with the given content.
class MemoryFile {
 public:
  explicit MemoryFile(Bytes content);
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  int descriptor_;
  std::string path_;
};

// A folder of this process, removed at its end.
const std::string& ScratchFolder();
// Writes (replaces) a file of that folder; returns its path.
std::string WriteScratch(const std::string& name, Bytes content);
void RemoveScratch(const std::string& name);

}  // namespace waymark::fuzz
