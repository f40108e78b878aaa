// Used by the generated message headers: bounds a length that came from
// outside before memory is taken for it.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace waymark_lcmtypes {

template <typename T>
struct MinEncodedSize {
  // A message without content: its empty strings and absent arrays.
  static int Of() { return T()._getEncodedSizeNoHash(); }
};
template <>
struct MinEncodedSize<std::string> {
  // Length and terminating zero.
  static int Of() { return 5; }
};
template <typename T>
struct MinEncodedSize<std::vector<T>> {
  static int Of() { return 1; }
};

template <typename T>
int MinBytesPerElement(const std::vector<T>&) {
  if constexpr (std::is_arithmetic_v<T>) {
    return static_cast<int>(sizeof(T));
  } else {
    return MinEncodedSize<T>::Of();
  }
}

// True if `length` elements of the array may follow in `num_bytes_left`.
template <typename T>
bool LengthFits(const std::vector<T>& array,
                std::int64_t length,
                int num_bytes_left) {
  return length >= 0 && length * MinBytesPerElement(array) <= num_bytes_left;
}

}  // namespace waymark_lcmtypes
