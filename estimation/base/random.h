// Deterministic random numbers: the same seed gives the same numbers with any
// standard library (std::normal_distribution does not promise that).
#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

namespace waymark {

// The seed of one of many random sources that share a seed: sources of other
// names keep their numbers when one is added or draws more often.
constexpr std::uint64_t SeedFor(std::uint64_t seed, std::string_view name) {
  // FNV-1a of the name, started from the seed; the last mix (of SplitMix64)
  // parts seeds and names that differ in few bits.
  std::uint64_t hash = 0xCBF29CE484222325ull ^ (seed * 0x9E3779B97F4A7C15ull);
  for (const char c : name) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3ull;
  }
  hash = (hash ^ (hash >> 30)) * 0xBF58476D1CE4E5B9ull;
  hash = (hash ^ (hash >> 27)) * 0x94D049BB133111EBull;
  return hash ^ (hash >> 31);
}

// SplitMix64 generator with uniform and normal draws. Period 2^64, passes
// BigCrush; not for cryptography.
//
// [1] G. Steele, D. Lea, C. Flood. Fast splittable pseudorandom number
//     generators. OOPSLA 2014.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t Bits() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }
  // In [0, 1).
  double Uniform() { return static_cast<double>(Bits() >> 11) * 0x1.0p-53; }
  double Uniform(double low, double high) {
    return low + (high - low) * Uniform();
  }
  // In [0, n), n > 0.
  std::uint64_t Index(std::uint64_t n) { return Bits() % n; }
  // Standard normal by Box-Muller; both draws are used.
  double Normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    // 1 - Uniform() is in (0, 1], so the logarithm is finite.
    const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
    const double angle = 2.0 * 3.14159265358979323846 * Uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }
  double Normal(double sigma) { return sigma * Normal(); }

 private:
  std::uint64_t state_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace waymark
