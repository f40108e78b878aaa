// Attributes of functions that are compiled for some processors only, and of
// those that are compiled into them. Internal to the lines.
//
// Such a function has a portable twin with the same results; which ones this
// processor has is asked at run time.
#pragma once

#define WAYMARK_INLINE inline __attribute__((always_inline))

#if defined(__x86_64__)
#define WAYMARK_POPCNT __attribute__((target("popcnt")))
#define WAYMARK_AVX2 __attribute__((target("avx2")))
#define WAYMARK_AVX512 __attribute__((target("avx512f")))
#define WAYMARK_AVX512BW __attribute__((target("avx512bw")))
#define WAYMARK_AVX512_POPCNT __attribute__((target("avx512f,avx512vpopcntdq")))
#define WAYMARK_AVX512_COMPRESS \
  __attribute__((target("avx512f,avx512bw,avx512vbmi,avx512vbmi2")))
#endif
