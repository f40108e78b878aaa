// Parser of .lcm definitions.
#include "processes/support/message_schema.h"
#include "tests/fuzz/fuzz_target.h"

namespace waymark::fuzz {

void RunOne(Bytes data) {
  TakesOrRefuses([&] {
    const SchemaSet set({{"fuzz.lcm", std::string(Text(data))}});
    for (const MessageSchema* type : set.types()) {
      const auto same = set.FindByFingerprint(Fingerprint(*type));
      bool found = false;
      for (const MessageSchema* other : same) found |= other == type;
      Expect(found, "a type is found by its fingerprint");
      Expect(set.FindByName(type->name) == type, "and by its name");
    }
  });
}

std::vector<std::string> Seeds() {
  std::vector<std::string> seeds = {
      "package a.b; struct c_t { int64_t utime; c_t next; }",
      "struct c_t { const int32_t A = 1, B = -0x2; double x[3][n]; int n; }",
      "package p; /* text */ struct q_t { int8_t n; string s[n][2]; byte b; }",
      "package p; struct a_t { b_t b; } struct b_t { boolean x; float y; }",
  };
  for (const auto& source : BuiltInSchemaSources()) {
    seeds.push_back(source.text);
  }
  return seeds;
}

}  // namespace waymark::fuzz
