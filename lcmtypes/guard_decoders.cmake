# cmake -DHEADER=<generated header> -P guard_decoders.cmake
#
# lcm-gen 1.3.1 takes memory for whatever length a message states, before it
# looks whether so much data follows: a packet of 30 bytes can ask for 100 GB,
# and a negative length throws. Here each length is bounded by the bytes that
# are left, so that decode() returns -1 instead, as it does for a text without
# its terminating zero, whose last byte would be lost. Numbers start at zero, so that
# a forgotten field never puts chance bytes on the wire.
file(READ ${HEADER} _text)
string(REGEX REPLACE
  "if\\(([A-Za-z_0-9]+) > maxlen - pos\\) return -1;"
  "if(\\1 < 1 || \\1 > maxlen - pos ||\n       ((const uint8_t*)buf)[offset + pos + \\1 - 1] != 0) return -1;"
  _text "${_text}")
string(REGEX REPLACE
  "( +)(this->[A-Za-z_0-9]+(\\[a[0-9]+\\])*)\\.resize\\(([^()]+)\\);"
  "\\1if(!::waymark_lcmtypes::LengthFits(\\2, \\4, maxlen - pos)) return -1;\n\\1\\2.resize(\\4);"
  _text "${_text}")
string(REGEX REPLACE
  "(\n        (double|float|u?int[0-9]+_t) +[A-Za-z_0-9]+(\\[[0-9]+\\])*);"
  "\\1 = {};" _text "${_text}")
string(REGEX REPLACE "#include <lcm/lcm_coretypes.h>"
  "#include <lcm/lcm_coretypes.h>\n#include <waymark_decode_guard.hpp>"
  _text "${_text}")
if(NOT _text MATCHES "waymark_decode_guard.hpp")
  message(FATAL_ERROR "${HEADER}: not as lcm-gen 1.3.1 writes it")
endif()
file(WRITE ${HEADER} "${_text}")
