#include "tests/fuzz/fuzz_target.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace waymark::fuzz {

void Expect(bool condition, std::string_view what) {
  if (condition) return;
  std::fprintf(stderr,
               "property does not hold: %.*s\n",
               static_cast<int>(what.size()),
               what.data());
  std::abort();
}

bool TakesOrRefuses(const std::function<void()>& decode) {
  try {
    decode();
    return true;
  } catch (const InputError& error) {
    const std::string_view text = error.what();
    Expect(!text.empty(), "an error says what is wrong");
    Expect(text.find('\n') == std::string_view::npos,
           "an error is one line: " + std::string(text));
    return false;
  }
}

std::string_view Text(Bytes data) {
  return {reinterpret_cast<const char*>(data.data()), data.size()};
}

Bytes AsBytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::vector<Bytes> Split(Bytes data, std::size_t max_parts) {
  std::vector<Bytes> parts;
  std::size_t begin = 0;
  while (parts.size() + 1 < max_parts) {
    std::size_t end = begin;
    while (end < data.size() && data[end] != 0xFF) ++end;
    if (end == data.size()) break;
    parts.push_back(data.subspan(begin, end - begin));
    begin = end + 1;
  }
  parts.push_back(data.subspan(begin));
  parts.resize(max_parts);
  return parts;
}

std::vector<std::uint8_t> WithFingerprint(std::uint64_t fingerprint,
                                          Bytes body) {
  std::vector<std::uint8_t> data;
  for (int shift = 56; shift >= 0; shift -= 8) {
    data.push_back(static_cast<std::uint8_t>(fingerprint >> shift));
  }
  data.insert(data.end(), body.begin(), body.end());
  return data;
}

MemoryFile::MemoryFile(Bytes content)
    : descriptor_(memfd_create("fuzz", 0)),
      path_("/proc/self/fd/" + std::to_string(descriptor_)) {
  Expect(descriptor_ >= 0, "memfd_create");
  std::size_t done = 0;
  while (done < content.size()) {
    const ssize_t n =
        write(descriptor_, content.data() + done, content.size() - done);
    Expect(n > 0, "write to memory");
    done += static_cast<std::size_t>(n);
  }
}

MemoryFile::~MemoryFile() {
  close(descriptor_);
}

namespace {

class Scratch {
 public:
  Scratch() {
    std::error_code error;
    const bool in_memory = std::filesystem::is_directory("/dev/shm", error);
    folder_ = std::string(in_memory ? "/dev/shm" : "/tmp") + "/waymark_fuzz_" +
              std::to_string(getpid());
    std::filesystem::create_directories(folder_);
  }
  ~Scratch() {
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  [[nodiscard]] const std::string& folder() const { return folder_; }

 private:
  std::string folder_;
};

}  // namespace

const std::string& ScratchFolder() {
  static const Scratch kScratch;
  return kScratch.folder();
}

std::string WriteScratch(const std::string& name, Bytes content) {
  std::string path = ScratchFolder() + "/" + name;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(content.data()),
             static_cast<std::streamsize>(content.size()));
  Expect(file.good(), "write a scratch file");
  return path;
}

void RemoveScratch(const std::string& name) {
  std::error_code error;
  std::filesystem::remove(ScratchFolder() + "/" + name, error);
}

}  // namespace waymark::fuzz
